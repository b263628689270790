#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <type_traits>

namespace tactus {

/// Ring between one producer thread and one consumer thread. Both sides are wait-free: no lock, no
/// allocation, no system call, a bounded number of instructions. Full: the new element is dropped
/// and counted, for the loop must not wait for its log.
template <typename T>
class SpscQueue {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  /// Touches all its memory. Throws std::invalid_argument unless capacity is a power of two.
  explicit SpscQueue(std::size_t capacity)
      : elements_(std::make_unique<T[]>(checked(capacity))), mask_(capacity - 1) {}

  /// By the producer: the place of the next element, to be filled and handed over by commit(); it
  /// holds an older one. nullptr: full, and the element is dropped.
  T* reserve() noexcept {
    const std::size_t tail = producer_.own.load(std::memory_order_relaxed);
    if (tail - producer_.seen > mask_) {
      producer_.seen = consumer_.own.load(std::memory_order_acquire);
      if (tail - producer_.seen > mask_) {
        dropped_.store(dropped_.load(std::memory_order_relaxed) + 1, std::memory_order_relaxed);
        return nullptr;
      }
    }
    return &elements_[tail & mask_];
  }
  void commit() noexcept {
    producer_.own.store(producer_.own.load(std::memory_order_relaxed) + 1,
                        std::memory_order_release);
  }
  /// Both at once, of a copy. False: dropped.
  bool push(const T& element) noexcept {
    T* const place = reserve();
    if (!place) return false;
    *place = element;
    commit();
    return true;
  }

  /// By the producer: so many can be pushed now.
  bool hasRoom(std::size_t count) noexcept {
    producer_.seen = consumer_.own.load(std::memory_order_acquire);
    const std::size_t used = producer_.own.load(std::memory_order_relaxed) - producer_.seen;
    return count <= capacity() - used;
  }

  /// By the consumer: the oldest element, its own until release(). nullptr: empty.
  T* front() noexcept {
    const std::size_t head = consumer_.own.load(std::memory_order_relaxed);
    if (head == consumer_.seen) {
      consumer_.seen = producer_.own.load(std::memory_order_acquire);
      if (head == consumer_.seen) return nullptr;
    }
    return &elements_[head & mask_];
  }
  void release() noexcept {
    consumer_.own.store(consumer_.own.load(std::memory_order_relaxed) + 1,
                        std::memory_order_release);
  }
  /// Both at once, into a copy. False: empty, and the element is left as it was.
  bool pop(T& element) noexcept {
    const T* const place = front();
    if (!place) return false;
    element = *place;
    release();
    return true;
  }

  std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }
  std::size_t capacity() const noexcept { return mask_ + 1; }

 private:
  static std::size_t checked(std::size_t capacity) {
    if (!std::has_single_bit(capacity)) {
      throw std::invalid_argument("capacity of a queue has to be a power of two");
    }
    return capacity;
  }

  static constexpr std::size_t kCacheLine = 64;

  /// What one side writes, on a cache line of its own. Counts run on for ever and wrap.
  struct alignas(kCacheLine) Side {
    std::atomic<std::size_t> own{0};
    std::size_t seen = 0;  ///< the other side's count when last read, to leave its line alone
  };

  const std::unique_ptr<T[]> elements_;
  const std::size_t mask_;
  Side producer_;
  std::atomic<std::uint64_t> dropped_{0};
  Side consumer_;
};

}  // namespace tactus
