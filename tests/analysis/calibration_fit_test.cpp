#include "tactus/analysis/calibration_fit.h"

#include <gtest/gtest.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "support/hidden_calibration.h"

namespace tactus {
namespace {

constexpr CalibratedModule kCalibrated{100000.0, 0.38, 0.06};
using test::hiddenCalibration;
using test::HiddenRows;

/// The channels that a calibration of so many rows reads as a wrench, by an oracle of its own: the
/// smallest ones.
ChannelVector channelsOf(const HiddenRows& C, int rows, const Wrench5& wrench) {
  return Eigen::MatrixXd(C.topRows(rows))
      .completeOrthogonalDecomposition()
      .solve(wrench.head(rows));
}

struct Session {
  int rows = 4;
  double counts_noise = 0.0;  ///< of a mean
  double force_error = 0.0;   ///< relative, of force, direction in rad, and of place by the length
};

/// Pushes along +-y and +-z, at three places each, as docs/robot.md says.
std::vector<KnownPush> pushesOf(test::Random& random, const HiddenRows& C, const Session& session) {
  std::vector<KnownPush> pushes;
  for (const double x_m : {0.04, 0.19, 0.34}) {
    for (int direction = 0; direction < 4; ++direction) {
      KnownPush push;
      const double force_N = (direction % 2 == 0 ? 1.0 : -1.0) * random.uniform(3.0, 12.0);
      (direction < 2 ? push.force_y_N : push.force_z_N) = force_N;
      push.position_m = x_m;
      if (session.rows == 5) push.moment_x_Nm = random.uniform(-0.5, 0.5);
      KnownPush real = push;
      const auto off = [&] { return session.force_error * random.uniform(-1.0, 1.0); };
      const double factor = 1.0 + off(), angle = off();
      real.force_y_N =
          factor * (push.force_y_N * std::cos(angle) - push.force_z_N * std::sin(angle));
      real.force_z_N =
          factor * (push.force_z_N * std::cos(angle) + push.force_y_N * std::sin(angle));
      real.position_m += 0.38 * off();
      push.counts = 1e5 * channelsOf(C, session.rows, wrenchOf(real));
      push.counts += session.counts_noise * random.vector<ChannelVector>(8, -1.7, 1.7);
      pushes.push_back(push);
    }
  }
  return pushes;
}

/// Of loads that nobody pushed with, by their size.
double largestError(test::Random& random, const HiddenRows& C, int rows,
                    const CalibrationFit& fit) {
  double largest = 0.0;
  for (int i = 0; i < 50; ++i) {
    KnownPush load;
    const double angle = random.uniform(-3.14, 3.14);
    load.force_y_N = std::cos(angle);
    load.force_z_N = std::sin(angle);
    load.position_m = random.uniform(0.0, 0.38);
    if (rows == 5) load.moment_x_Nm = random.uniform(-0.03, 0.03);
    const Wrench5 truth = wrenchOf(load);
    const Wrench5 scale{{1.0, 1.0, 1.0 / 0.19, 1.0 / 0.19, rows == 5 ? 1.0 / 0.06 : 0.0}};
    const Wrench5 found = fit.calibration * channelsOf(C, rows, truth);
    largest = std::max(largest, scale.cwiseProduct(found - truth).norm());
  }
  return largest;
}

TEST(CalibrationFit, OfExactPushesItIsTheHiddenOne) {
  test::Random random(21);
  for (int i = 0; i < 200; ++i) {
    const Session session{.rows = random.chance(0.5) ? 5 : 4};
    const HiddenRows C = hiddenCalibration(random);
    const CalibrationFit fit =
        fitCalibration(pushesOf(random, C, session), kCalibrated, ChannelVector::Zero());
    ASSERT_EQ(fit.problem, CalibrationProblem::kNone);
    EXPECT_EQ(fit.rows, session.rows);
    EXPECT_LT((fit.calibration - C).topRows(session.rows).cwiseAbs().maxCoeff(), 1e-9);
    EXPECT_TRUE(session.rows == 5 || fit.calibration.row(4).isZero());
    for (const PushResidual& residual : fit.residuals) {
      EXPECT_LT(residual.force_N, 1e-8);
      EXPECT_LT(std::abs(residual.position_m), 1e-8);
    }
    EXPECT_LT(fit.pushes_condition, session.rows == 5 ? 12.0 : 4.0);
  }
}

TEST(CalibrationFit, ErrorsOfChannelsAndOfHandsStayAsSmallAsTheyWere) {
  test::Random random(22);
  for (int i = 0; i < 200; ++i) {
    const Session session{.rows = random.chance(0.3) ? 5 : 4,
                          .counts_noise = random.logUniform(1.0, 300.0),
                          .force_error = random.uniform(0.0, 0.02)};
    const HiddenRows C = hiddenCalibration(random);
    const CalibrationFit fit =
        fitCalibration(pushesOf(random, C, session), kCalibrated, ChannelVector::Zero());
    ASSERT_EQ(fit.problem, CalibrationProblem::kNone);
    const double noise = 1e-5 * session.counts_noise;  // of a channel, of the 3 N at least
    EXPECT_LT(largestError(random, C, session.rows, fit), 5.0 * session.force_error + 20.0 * noise);
  }
}

enum class WrongEntry { kSign, kHalf, kTwice, kPlace, kAxis };

KnownPush wronglyEntered(KnownPush push, WrongEntry how) {
  switch (how) {
    case WrongEntry::kSign:
      push.force_y_N = -push.force_y_N;
      push.force_z_N = -push.force_z_N;
      return push;
    case WrongEntry::kHalf:
    case WrongEntry::kTwice: {
      const double factor = how == WrongEntry::kHalf ? 0.5 : 2.0;
      push.force_y_N *= factor;
      push.force_z_N *= factor;
      return push;
    }
    case WrongEntry::kPlace:
      push.position_m += push.position_m < 0.19 ? 0.15 : -0.15;
      return push;
    case WrongEntry::kAxis:
      std::swap(push.force_y_N, push.force_z_N);
      return push;
  }
  return push;
}

TEST(CalibrationFit, FindsAWrongEntry) {
  test::Random random(23);
  for (int i = 0; i < 500; ++i) {
    const HiddenRows C = hiddenCalibration(random);
    std::vector<KnownPush> pushes =
        pushesOf(random, C, {.counts_noise = 20.0, .force_error = 0.02});
    const CalibrationFit good = fitCalibration(pushes, kCalibrated, ChannelVector::Zero());
    for (const auto& left_out : good.left_out) EXPECT_LT(left_out->share, kMaxLeftOutShare);
    const int wrong = random.index(12);
    KnownPush& entry = pushes[static_cast<std::size_t>(wrong)];
    entry = wronglyEntered(entry, static_cast<WrongEntry>(random.index(5)));
    const CalibrationFit fit = fitCalibration(pushes, kCalibrated, ChannelVector::Zero());
    ASSERT_EQ(fit.problem, CalibrationProblem::kNone);
    EXPECT_EQ(fit.worst, wrong) << i;
    EXPECT_EQ(wrongPush(fit), wrong);
    EXPECT_EQ(wrongPush(good), -1);
    EXPECT_GT(fit.left_out[static_cast<std::size_t>(wrong)]->share, kMaxLeftOutShare);
  }
}

TEST(CalibrationFit, TwoWrongEntriesDoNotHideEachOther) {
  test::Random random(29);
  int found = 0;
  for (int i = 0; i < 500; ++i) {
    const HiddenRows C = hiddenCalibration(random);
    std::vector<KnownPush> pushes =
        pushesOf(random, C, {.counts_noise = 20.0, .force_error = 0.02});
    const int one = random.index(12), other = (one + random.integer(1, 11)) % 12;
    for (const int wrong : {one, other}) {
      KnownPush& entry = pushes[static_cast<std::size_t>(wrong)];
      entry = wronglyEntered(entry, static_cast<WrongEntry>(random.index(5)));
    }
    const CalibrationFit fit = fitCalibration(pushes, kCalibrated, ChannelVector::Zero());
    const int named = wrongPush(fit);
    EXPECT_NE(named, -1) << i;
    found += named == one || named == other;
  }
  EXPECT_GT(found, 450);
}

TEST(CalibrationFit, WhereTwoPushesContradictEachOtherAloneBothAreNamed) {
  test::Random random(24);
  const HiddenRows C = hiddenCalibration(random);
  std::vector<KnownPush> pushes = pushesOf(random, C, {.counts_noise = 5.0});
  // +-y and +-z at both ends: each push has one that says the same.
  pushes.erase(pushes.begin() + 4, pushes.begin() + 8);
  pushes[0] = wronglyEntered(pushes[0], WrongEntry::kTwice);
  const CalibrationFit fit = fitCalibration(pushes, kCalibrated, ChannelVector::Zero());
  EXPECT_TRUE((fit.worst == 0 && fit.or_worst == 1) || (fit.worst == 1 && fit.or_worst == 0));
}

TEST(CalibrationFit, RefusesPushesThatDoNotTellEachRow) {
  test::Random random(25);
  const HiddenRows C = hiddenCalibration(random);
  const std::vector<KnownPush> all = pushesOf(random, C, {.counts_noise = 5.0});
  const auto problemOf = [&](const std::vector<int>& chosen, int* row) {
    std::vector<KnownPush> pushes;
    for (const int i : chosen) pushes.push_back(all[static_cast<std::size_t>(i)]);
    const CalibrationFit fit = fitCalibration(pushes, kCalibrated, ChannelVector::Zero());
    *row = fit.weakest_row;
    EXPECT_TRUE(fit.problem == CalibrationProblem::kNone || fit.calibration.isZero());
    return fit.problem;
  };
  int row = 0;
  EXPECT_EQ(problemOf({}, &row), CalibrationProblem::kTooFew);
  EXPECT_EQ(problemOf({0, 2, 8}, &row), CalibrationProblem::kTooFew);
  EXPECT_EQ(problemOf({0, 1, 4, 5, 8, 9}, &row), CalibrationProblem::kPushesAlike);
  EXPECT_EQ(row, 1) << "F_z: nothing along z";
  EXPECT_EQ(problemOf({2, 3, 6, 7, 10, 11}, &row), CalibrationProblem::kPushesAlike);
  EXPECT_EQ(row, 0) << "F_y: nothing along y";
  for (const int first : {0, 4, 8}) {
    const std::vector<int> at_one_place = {first, first + 1, first + 2, first + 3};
    EXPECT_EQ(problemOf(at_one_place, &row), CalibrationProblem::kPushesAlike) << first;
    EXPECT_TRUE(row == 2 || row == 3) << "a moment, also beyond the middle: " << row;
  }
  EXPECT_EQ(problemOf({0, 4, 8, 10, 11}, &row), CalibrationProblem::kPushesAlike);
  EXPECT_EQ(row, 2) << "M_y: along z at the far end alone";
  EXPECT_EQ(problemOf({0, 2, 8, 10}, &row), CalibrationProblem::kNone);
  EXPECT_EQ(problemOf({0, 2, 8, 11}, &row), CalibrationProblem::kNone);
}

TEST(CalibrationFit, RefusesChannelsThatDoNotTellEachRow) {
  test::Random random(26);
  for (int i = 0; i < 50; ++i) {
    const HiddenRows C = hiddenCalibration(random);
    std::vector<KnownPush> pushes = pushesOf(random, C, {});
    // Cells that all see the sum of y and z alone, but for noise.
    for (KnownPush& push : pushes) {
      KnownPush seen = push;
      seen.force_y_N = seen.force_z_N = 0.5 * (push.force_y_N + push.force_z_N);
      push.counts =
          1e5 * channelsOf(C, 4, wrenchOf(seen)) + random.vector<ChannelVector>(8, -20.0, 20.0);
    }
    EXPECT_EQ(fitCalibration(pushes, kCalibrated, ChannelVector::Zero()).problem,
              CalibrationProblem::kChannelsAlike);
  }
}

TEST(CalibrationFit, AFewestPushesLeaveNothingToCheckThem) {
  test::Random random(27);
  const HiddenRows C = hiddenCalibration(random);
  std::vector<KnownPush> pushes = pushesOf(random, C, {});
  pushes = {pushes[0], pushes[2], pushes[8], pushes[10]};
  const CalibrationFit fit = fitCalibration(pushes, kCalibrated, ChannelVector::Zero());
  EXPECT_EQ(fit.problem, CalibrationProblem::kNone);
  EXPECT_EQ(fit.worst, -1);
  for (const auto& left_out : fit.left_out) EXPECT_FALSE(left_out);
  EXPECT_EQ(uncheckedPushes(pushes, kCalibrated), 4);
}

TEST(CalibrationFit, PushesTellBeforehandWhichNothingWillCheck) {
  test::Random random(30);
  const HiddenRows C = hiddenCalibration(random);
  for (int i = 0; i < 100; ++i) {
    std::vector<KnownPush> pushes;
    for (const KnownPush& push : pushesOf(random, C, {}))
      if (random.chance(0.6)) pushes.push_back(push);
    if (random.chance(0.3) && !pushes.empty()) pushes[0].moment_x_Nm = 0.2;
    const CalibrationFit fit = fitCalibration(pushes, kCalibrated, ChannelVector::Zero());
    if (fit.problem != CalibrationProblem::kNone) continue;
    const auto absent = std::ranges::count_if(fit.left_out, [](const auto& one) { return !one; });
    EXPECT_EQ(uncheckedPushes(pushes, kCalibrated), absent);
  }
}

TEST(CalibrationFit, NoiseOfARowIsWhatTheChannelsMakeOfIt) {
  test::Random random(28);
  const HiddenRows C = hiddenCalibration(random);
  const ChannelVector sigma = random.vector<ChannelVector>(8, 10.0, 500.0);
  const CalibrationFit fit = fitCalibration(pushesOf(random, C, {.rows = 5}), kCalibrated, sigma);
  Wrench5 squares = Wrench5::Zero();
  constexpr int kDraws = 4000;
  for (int i = 0; i < kDraws; ++i) {
    const ChannelVector noise =
        std::sqrt(3.0) * sigma.cwiseProduct(random.vector<ChannelVector>(8, -1.0, 1.0));
    squares += Wrench5(fit.calibration * noise * 1e-5).cwiseAbs2() / kDraws;
  }
  for (int row = 0; row < 5; ++row) {
    const double drawn = std::sqrt(squares[row]);
    EXPECT_NEAR(fit.noise[row], drawn, 0.06 * drawn);
  }
}

}  // namespace
}  // namespace tactus
