#include "soak/latencies.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

namespace tactus::soak {
namespace {

constexpr double kShortest_ns = 3000.0;
constexpr double kRatio = 1.5;
constexpr double kHistogramWidth = 1.0 / 16.0;  ///< of a bucket

/// A quantile may be told up to a bucket's width too long.
bool isTold(std::int64_t told_ns, std::int64_t drawn_ns, bool is_exact) {
  const double width = is_exact ? 0.0 : kHistogramWidth;
  return told_ns >= drawn_ns &&
         static_cast<double>(told_ns) <= (1.0 + width) * static_cast<double>(drawn_ns);
}

}  // namespace

std::int64_t DrawnTimes::value_ns(int number) {
  return std::llround(kShortest_ns * std::pow(kRatio, number));
}

void DrawnTimes::add(const DrawnTimes& other) {
  std::ranges::transform(counts_, other.counts_, counts_.begin(), std::plus<>());
}

std::uint64_t DrawnTimes::count() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

std::int64_t DrawnTimes::quantile_ns(double share) const {
  const double rank = std::max(1.0, std::ceil(share * static_cast<double>(count())));
  std::uint64_t seen = 0;
  for (int i = 0; i < kValues; ++i) {
    seen += counts_[i];
    if (static_cast<double>(seen) >= rank) return value_ns(i);
  }
  return 0;
}

std::vector<std::string> DrawnTimes::compare(const std::string& name, const Json& times) const {
  std::vector<std::string> wrong;
  const auto compare = [&](const char* key, double share, bool is_exact) {
    const auto told_ns = times.at(key).get<std::int64_t>();
    const std::int64_t drawn_ns = quantile_ns(share);
    if (isTold(told_ns, drawn_ns, is_exact)) return;
    wrong.push_back(fmt::format("{}: {} is {}, {} was drawn", name, key, told_ns, drawn_ns));
  };
  compare("min", 0.0, true);
  compare("median", 0.5, false);
  compare("p99", 0.99, false);
  compare("max", 1.0, true);
  return wrong;
}

std::vector<std::string> DrawnTimes::compare(const std::string& name,
                                             const Histogram& histogram) const {
  const Json times = {{"min", histogram.min_ns()},
                      {"median", histogram.percentile_ns(50)},
                      {"p99", histogram.percentile_ns(99)},
                      {"max", histogram.max_ns()}};
  std::vector<std::string> wrong = compare(name, times);
  std::uint64_t sum = 0;
  histogram.forEachBucket([&sum](std::int64_t, std::uint64_t in_it) { sum += in_it; });
  if (sum != count() || histogram.count() != count())
    wrong.push_back(fmt::format("{}: {} counted, {} in buckets, {} drawn", name, histogram.count(),
                                sum, count()));
  return wrong;
}

Latencies::Times Latencies::draw() { return {next(0), next(1), next(2), next(3)}; }

std::int64_t Latencies::next(int series) {
  static const auto values_ns = [] {
    std::array<std::int64_t, DrawnTimes::kValues> values{};
    for (int i = 0; i < DrawnTimes::kValues; ++i) values[i] = DrawnTimes::value_ns(i);
    return values;
  }();
  const int number = std::min(std::countl_zero(engine_()), DrawnTimes::kValues - 1);
  drawn_[series].add(number);
  return values_ns[number];
}

}  // namespace tactus::soak
