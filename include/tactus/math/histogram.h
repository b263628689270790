#pragma once

#include <array>
#include <bit>
#include <cstdint>

namespace tactus {

/// Counts durations in buckets whose width is at most 1/16 of their value; exact below 32 ns.
/// One thread; read it when the loop has ended.
class Histogram {
 public:
  /// A few instructions, no branch on the value but for the sign; below 0 counts as 0.
  void add(std::int64_t value_ns) noexcept {
    const std::int64_t value = value_ns < 0 ? 0 : value_ns;
    ++counts_[bucket(static_cast<std::uint64_t>(value))];
    ++count_;
    if (value < min_ns_) min_ns_ = value;
    if (value > max_ns_) max_ns_ = value;
  }

  std::uint64_t count() const noexcept { return count_; }
  std::int64_t min_ns() const noexcept { return count_ == 0 ? 0 : min_ns_; }  ///< exact; 0 if empty
  std::int64_t max_ns() const noexcept { return max_ns_; }                    ///< exact; 0 if empty

  /// The smallest value that at least `percent` (0 to 100) of all values do not exceed, or up to
  /// 1/16 more, never more than max_ns(). 0 if empty.
  std::int64_t percentile_ns(double percent) const noexcept;

  /// Calls see(highest_ns, count) for each bucket that is not empty, the lowest first.
  template <typename See>
  void forEachBucket(See see) const {
    for (int i = 0; i < kBuckets; ++i)
      if (counts_[i] > 0) see(highestIn_ns(i), counts_[i]);
  }

 private:
  static constexpr int kSubBits = 4;  ///< 16 buckets an octave
  static constexpr int kBuckets = (63 - kSubBits) * (1 << kSubBits) + (1 << kSubBits);

  /// The leading bits of a value behind the number of bits that were cut off.
  static int bucket(std::uint64_t value) noexcept {
    const int width = static_cast<int>(std::bit_width(value | (1u << kSubBits)));
    const int cut = width - 1 - kSubBits;
    return (cut << kSubBits) + static_cast<int>(value >> cut);
  }
  static std::int64_t highestIn_ns(int bucket) noexcept;

  std::array<std::uint64_t, kBuckets> counts_{};
  std::uint64_t count_ = 0;
  std::int64_t min_ns_ = INT64_MAX;
  std::int64_t max_ns_ = 0;
};

}  // namespace tactus
