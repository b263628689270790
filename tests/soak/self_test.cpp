#include "soak/self_test.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <vector>

#include "soak/growth.h"
#include "soak/latencies.h"

namespace tactus::soak {
namespace {

int failures = 0;

void expect(bool is_so, const char* what) {
  if (is_so) return;
  ++failures;
  fmt::print("self-test: {}\n", what);
}

/// Rises at first, as a process that starts, and by `late` in the last two thirds.
std::vector<Reading> readings(double late) {
  std::vector<Reading> all;
  for (int i = 0; i <= 300; ++i) {
    const double noise = i % 2 == 0 ? 0.1 : -0.1;
    all.push_back({60.0 * i, i < 100 ? 1.0 * i : 100.0 + late * (i - 100) / 200.0 + noise});
  }
  return all;
}

void testGrowth() {
  expect(std::abs(growth(readings(0.0))) < 0.1, "what is flat does not grow");
  expect(std::abs(growth(readings(5.0)) - 5.0) < 0.1, "growth is that of the line");
  expect(growth({}) == 0.0, "nothing does not grow");
}

void testTimes() {
  Latencies latencies(1);
  Histogram histogram;
  for (int i = 0; i < 100'000; ++i) histogram.add(latencies.draw()[1]);
  const DrawnTimes& drawn = latencies.drawn()[1];
  expect(drawn.count() == 100'000, "every draw counts");
  expect(drawn.compare("", histogram).empty(), "the histogram agrees");
  histogram.add(DrawnTimes::value_ns(0));
  expect(!drawn.compare("", histogram).empty(), "one too many is seen");
  const auto longest_ns = drawn.quantile_ns(1.0);
  Json times = {
      {"min", 3000}, {"median", 3000}, {"p99", drawn.quantile_ns(0.99)}, {"max", longest_ns}};
  expect(drawn.compare("", times).empty(), "the summary agrees");
  times["max"] = longest_ns - 1;
  expect(drawn.compare("", times).size() == 1, "a shorter maximum is seen");
  times["max"] = longest_ns;
  times["p99"] = drawn.quantile_ns(0.999);
  expect(drawn.compare("", times).size() == 1, "another quantile is seen");
}

}  // namespace

int selfTest() {
  testGrowth();
  testTimes();
  return failures == 0 ? 0 : 1;
}

}  // namespace tactus::soak
