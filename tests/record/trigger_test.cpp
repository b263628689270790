#include "tactus/record/trigger.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "support/random.h"

namespace tactus {
namespace {

constexpr double kStep_s = 0.001;

std::vector<int> firesOf(const TriggerLevel& config, const std::vector<double>& values) {
  Trigger trigger(config);
  std::vector<int> fired;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (trigger.update(kStep_s * static_cast<double>(i), values[i]))
      fired.push_back(static_cast<int>(i));
  return fired;
}

bool meets(Comparison comparison, double value, double level) {
  if (comparison == Comparison::kAbove) return value > level;
  if (comparison == Comparison::kAtLeast) return value >= level;
  return comparison == Comparison::kBelow ? value < level : value <= level;
}

/// By its definition, looking back over the whole signal at each value: it begins to hold here, and
/// since it last began to hold there was a value beyond the hysteresis.
std::vector<int> oracle(const TriggerLevel& config, const std::vector<double>& values) {
  const bool is_rising =
      config.comparison == Comparison::kAbove || config.comparison == Comparison::kAtLeast;
  const double arming = config.level + (is_rising ? -1.0 : 1.0) * config.hysteresis;
  std::vector<int> fired;
  for (int i = 0; i < static_cast<int>(values.size()); ++i) {
    if (!meets(config.comparison, values[i], config.level)) continue;
    bool is_armed = false;
    for (int k = i - 1; k >= 0 && !is_armed; --k) {
      if (meets(config.comparison, values[k], config.level)) break;  // it holds already
      is_armed = !std::isnan(values[k]) && !meets(config.comparison, values[k], arming);
    }
    const bool is_held_off =
        !fired.empty() && kStep_s * i < kStep_s * fired.back() + config.holdoff_s;
    if (is_armed && !is_held_off) fired.push_back(i);
  }
  return fired;
}

TEST(Trigger, FiresWhereTheOracleDoes) {
  test::Random random(7);
  int all = 0;
  for (int run = 0; run < 2000; ++run) {
    const TriggerLevel config{static_cast<Comparison>(random.index(4)),
                              static_cast<double>(random.integer(-3, 3)),
                              static_cast<double>(random.integer(0, 3)),
                              random.chance(0.5) ? 0.0 : kStep_s * random.integer(0, 40)};
    std::vector<double> values;
    double value = 0.0;
    for (int i = 0; i < 200; ++i) {
      value += random.integer(-2, 2);  // whole numbers: the level is met exactly, too
      if (random.chance(0.1)) value = config.level;
      values.push_back(random.chance(0.03) ? std::nan("") : value);
    }
    const std::vector<int> expected = oracle(config, values);
    ASSERT_EQ(firesOf(config, values), expected) << run;
    all += static_cast<int>(expected.size());
  }
  EXPECT_GT(all, 5000);
}

TEST(Trigger, DoesNotFireAtAFirstValueThatHolds) {
  EXPECT_TRUE(firesOf({Comparison::kAbove, 1.0}, {2.0, 3.0, 2.0}).empty());
}

TEST(Trigger, FiresOnceWhileASignalSwingsWithinTheHysteresis) {
  std::vector<double> values{0.0};
  for (int i = 0; i < 100; ++i) values.push_back(i % 2 == 0 ? 1.3 : 0.9);
  EXPECT_EQ(firesOf({Comparison::kAbove, 1.2, 0.5}, values), std::vector<int>{1});
  EXPECT_EQ(firesOf({Comparison::kAbove, 1.2, 0.0}, values).size(), 50u);
}

TEST(Trigger, IsHeldOff) {
  std::vector<double> values;
  for (int i = 0; i < 100; ++i) values.push_back(i % 10 == 5 ? 2.0 : 0.0);
  EXPECT_EQ(firesOf({Comparison::kAbove, 1.0, 0.0, 0.035}, values), (std::vector<int>{5, 45, 85}));
}

}  // namespace
}  // namespace tactus
