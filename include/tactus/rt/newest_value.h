#pragma once

#include <array>
#include <atomic>
#include <type_traits>

namespace tactus {

/// Hands the newest value of one thread to another one. Both sides are wait-free: no lock, no
/// allocation, no system call, a bounded number of instructions. A value that is not taken before
/// the next one comes is lost.
template <typename T>
class NewestValue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// By the producer.
  void put(const T& value) noexcept {
    places_[own_of_producer_] = value;
    own_of_producer_ =
        between_.exchange(own_of_producer_ | kIsNew, std::memory_order_acq_rel) & kPlace;
  }

  /// By the consumer: false if there is none since the last, and `value` is left as it was.
  bool take(T& value) noexcept {
    if ((between_.load(std::memory_order_relaxed) & kIsNew) == 0) return false;
    own_of_consumer_ = between_.exchange(own_of_consumer_, std::memory_order_acq_rel) & kPlace;
    value = places_[own_of_consumer_];
    return true;
  }

 private:
  static constexpr unsigned kPlace = 3, kIsNew = 4;

  std::array<T, 3> places_{};
  std::atomic<unsigned> between_{0};  ///< the place that neither has, and whether it is new
  unsigned own_of_producer_ = 1;
  unsigned own_of_consumer_ = 2;
};

}  // namespace tactus
