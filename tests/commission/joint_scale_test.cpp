#include "tactus/commission/joint_scale.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/random.h"

namespace tactus {
namespace {

struct DrawnMarks {
  JointScale truth;
  double q_error = 0.0;
  std::vector<Mark> marks;
};

DrawnMarks drawMarks(test::Random& random) {
  DrawnMarks drawn;
  drawn.truth = {random.chance(0.5) ? 1 : -1, random.logUniform(1e3, 1e8),
                 random.uniform(-10.0, 10.0), 0.0};
  drawn.q_error = random.logUniform(1e-5, 1e-2);
  const double range = random.logUniform(0.01, 3.0), middle = random.uniform(-2.0, 2.0);
  for (int i = random.integer(2, 9); i > 0; --i) {
    const double q = middle + random.uniform(-0.5, 0.5) * range;
    drawn.marks.push_back(
        {std::round(drawn.truth.counts(q)), q + random.uniform(-drawn.q_error, drawn.q_error)});
  }
  drawn.q_error += 1.0 / drawn.truth.counts_per_unit;  // a count is no finer
  return drawn;
}

/// Whatever was drawn: what is told is true, within what is told.
TEST(JointScale, TruthIsWithinTheUncertainty) {
  test::Random random(21);
  int told = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const DrawnMarks drawn = drawMarks(random);
    const double fewest = fewestCountsPerUnit(drawn.marks, drawn.q_error);
    EXPECT_LE(fewest, drawn.truth.counts_per_unit * (1.0 + 1e-9));
    EXPECT_GE(mostCountsPerUnit(drawn.marks, drawn.q_error),
              drawn.truth.counts_per_unit * (1.0 - 1e-9));
    EXPECT_LE(largestMisfit(drawn.marks), 2.0 * drawn.q_error);
    const auto scale = fitScale(drawn.marks, drawn.q_error);
    if (!scale) continue;
    ++told;
    EXPECT_EQ(scale->sign, drawn.truth.sign);
    EXPECT_LE(std::abs(scale->counts_per_unit / drawn.truth.counts_per_unit - 1.0),
              scale->uncertainty + 1e-7);
    double mean = 0.0;
    for (const Mark& mark : drawn.marks)
      mean += mark.counts / static_cast<double>(drawn.marks.size());
    EXPECT_NEAR(scale->position(mean), drawn.truth.position(mean), drawn.q_error);
  }
  EXPECT_GT(told, 1000);
}

TEST(JointScale, TellsNothingOfPlacesTooCloseTogether) {
  EXPECT_FALSE(fitScale({}, 0.01));
  const std::vector<Mark> one = {{5.0, 0.1}}, same = {{5.0, 0.1}, {5.0, 0.3}},
                          close = {{0.0, 0.1}, {1000.0, 0.13}},
                          apart = {{0.0, 0.1}, {1000.0, 0.15}};
  EXPECT_FALSE(fitScale(one, 0.01));
  EXPECT_FALSE(fitScale(same, 0.01));
  EXPECT_FALSE(fitScale(close, 0.01));
  ASSERT_TRUE(fitScale(apart, 0.01));
  EXPECT_NEAR(fitScale(apart, 0.01)->counts_per_unit, 20000.0, 1e-6);
  EXPECT_NEAR(fitScale(apart, 0.01)->uncertainty, 0.4, 1e-9);
}

TEST(JointScale, OneWrongMarkIsSeen) {
  std::vector<Mark> marks = {{0.0, 0.0}, {1000.0, 0.1}, {2000.0, 0.2}};
  EXPECT_NEAR(largestMisfit(marks), 0.0, 1e-12);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    std::vector<Mark> wrong = marks;
    wrong[i].q += 0.09;
    EXPECT_GT(largestMisfit(wrong), 0.029) << i;
  }
}

TEST(JointScale, CountsThatAreKnownLeaveTheOffset) {
  const std::vector<Mark> marks = {{-2000.0, 0.31}, {-4000.0, 0.49}};
  const JointScale scale = fitOffset(marks, -1, 10000.0);
  EXPECT_NEAR(scale.offset, 0.1, 1e-12);
  EXPECT_NEAR(scale.position(-3000.0), 0.4, 1e-12);
  EXPECT_NEAR(scale.counts(0.4), -3000.0, 1e-9);
}

}  // namespace
}  // namespace tactus
