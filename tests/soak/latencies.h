#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "tactus/math/histogram.h"
#include "tactus/scene/json.h"

namespace tactus::soak {

/// How often each of a few durations was drawn. They are far apart, so that it is exact.
class DrawnTimes {
 public:
  static constexpr int kValues = 40;
  static std::int64_t value_ns(int number);  ///< half as long again as the one before

  void add(int number) { ++counts_[number]; }
  void add(const DrawnTimes& other);
  std::uint64_t count() const;
  std::int64_t quantile_ns(double share) const;  ///< 0: the shortest

  /// Lines that say where `min`, `median`, `p99` and `max` of a summary are not what was drawn.
  std::vector<std::string> compare(const std::string& name, const Json& times) const;
  /// And a histogram, counts included.
  std::vector<std::string> compare(const std::string& name, const Histogram& histogram) const;

 private:
  std::array<std::uint64_t, kValues> counts_{};
};

/// Times of a loop by chance: half are of some us, one in a billion of half a second.
class Latencies {
 public:
  explicit Latencies(std::uint64_t seed) : engine_(seed) {}

  using Times = std::array<std::int64_t, 4>;
  static constexpr std::array<const char*, 4> kNames = {"wake_latency_ns", "read_ns", "control_ns",
                                                        "write_ns"};

  Times draw();
  const std::array<DrawnTimes, 4>& drawn() const { return drawn_; }

 private:
  std::int64_t next(int series);

  std::mt19937_64 engine_;
  std::array<DrawnTimes, 4> drawn_;
};

}  // namespace tactus::soak
