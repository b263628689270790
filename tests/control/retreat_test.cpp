#include "tactus/control/retreat.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/period.h"
#include "support/random.h"

/// The way out alone, of a carriage that does at once what is asked of it.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kThreshold_N = 1.2;
constexpr double kMaxAge_s = 0.02;

class Carriage {
 public:
  Carriage(const RetreatStart& start, bool has_push = true) {
    state.has_push = has_push;
    state.row[0] = 1.0;
    velocity_ = JointVector::Zero(1);
    if (has_push) startRetreat(start, state);
  }

  void step(const RetreatReading& reading) {
    const double speed = retreatSpeed(reading, kThreshold_N, kPeriod_s, state);
    EXPECT_GE(speed, 0.0);
    EXPECT_LE(speed, 1.0);
    if (state.has_push) {
      EXPECT_LE(speed, velocity_[0] + 2.0 * kPeriod_s + 1e-12);
    }
    velocity_[0] = speed;
    goAway(velocity_, kPeriod_s, state);
  }
  /// Until it is over; how many cycles that took.
  template <typename Reading>
  int run(const Reading& reading) {
    int cycles = 0;
    for (; !state.is_over && cycles < 10'000; ++cycles) step(reading(cycles));
    return cycles;
  }

  RetreatState state;

 private:
  JointVector velocity_;
};

RetreatReading felt(double force_N) { return {true, true, 0.0, kMaxAge_s, force_N}; }
RetreatReading silence() { return {false, true, 1.0, kMaxAge_s, 0.0}; }

TEST(RetreatWay, EndsWhereALinearContactIsLeft) {
  test::Random random(901);
  for (int i = 0; i < 500; ++i) {
    const double force_N = random.uniform(5.0, 700.0);
    const double stiffness = std::max(60.0, force_N / random.logUniform(1e-4, 0.5));
    Carriage carriage({force_N, 1000.0, 0.0, 0.0});
    const auto now_N = [&] { return std::max(0.0, force_N - stiffness * carriage.state.way); };
    const int cycles = carriage.run([&](int) { return felt(now_N()); });
    EXPECT_LE(now_N(), kThreshold_N) << force_N << " N, " << stiffness << " N/m";
    EXPECT_LE(cycles, 1200) << force_N << " N, " << stiffness << " N/m";
    EXPECT_LE(carriage.state.way, force_N / stiffness + 1.001 * kPeriod_s);
  }
}

TEST(RetreatWay, OfASensorThatAnswersNothingIsShort) {
  test::Random random(902);
  for (const double noise_N : {0.0, 0.05}) {
    Carriage carriage({150.0, 1000.0, 0.0, 0.0});
    carriage.run([&](int) { return felt(150.0 + noise_N * random.uniform(-3.0, 3.0)); });
    EXPECT_NEAR(carriage.state.way, 0.03, 0.0005);
  }
}

/// Now and then a reading must not begin it anew.
TEST(RetreatWay, OfASensorThatComesAndGoesIsShort) {
  for (const int period : {2, 5, 30, 100}) {
    Carriage carriage({150.0, 1000.0, 0.0, 0.0});
    carriage.run([&](int cycle) {
      RetreatReading reading = felt(150.0);
      reading.is_readable = cycle % period == 0;
      return reading;
    });
    EXPECT_LE(carriage.state.way, 0.13) << period;
    EXPECT_LE(carriage.state.time_s, kMaxRetreat_s + 2.0 * kPeriod_s) << period;
  }
}

TEST(RetreatWay, WithoutReadingsFollowsFromWhatWasKnown) {
  test::Random random(903);
  for (int i = 0; i < 500; ++i) {
    const RetreatStart start{random.uniform(1.2, 200.0), random.logUniform(100.0, 1e6),
                             random.uniform(-0.3, 0.3), random.uniform(0.02, 0.1)};
    Carriage carriage(start);
    const int cycles = carriage.run([](int) { return silence(); });
    const double known_m = start.force_N / start.stiffness_N_per_m +
                           std::abs(start.speed_m_per_s) * start.untold_s + 0.02;
    EXPECT_NEAR(carriage.state.way, std::min(0.1, known_m), 1e-4);
    EXPECT_LE(cycles, 700);
  }
}

/// It could stand by the end of its way at 2 m/s^2.
TEST(RetreatWay, WithoutReadingsSlowsDownToItsEnd) {
  Carriage carriage({50.0, 1000.0, 0.0, 0.0});
  double fastest = 0.0;
  while (!carriage.state.is_over) {
    const double left_m = std::max(0.0, carriage.state.way_to - carriage.state.way);
    carriage.step(silence());
    fastest = std::max(fastest, carriage.state.speed);
    ASSERT_LE(carriage.state.speed, std::sqrt(2.0 * 2.0 * left_m) + 1e-12);
  }
  EXPECT_EQ(fastest, 0.25);
}

/// Where samples end, the rest of the way is that of the last one felt.
TEST(RetreatWay, GoesOnByTheLastSampleOnceTheModuleIsSilent) {
  Carriage carriage({90.0, 1000.0, 0.0, 0.0});
  for (int i = 0; i < 60; ++i) carriage.step(felt(90.0 - i));
  const double felt_m = carriage.state.way - kPeriod_s * carriage.state.speed;
  carriage.run([](int) { return silence(); });
  EXPECT_NEAR(carriage.state.way, felt_m + 31.0 / 1000.0 + 0.02, 5e-4);
}

/// 30 mm of way without an answer count from where a contact was felt first, or again.
TEST(RetreatWay, OfASensorThatAnswersNothingIsShortFromWhereItFelt) {
  for (const RetreatReading& first : {silence(), felt(kThreshold_N)}) {
    Carriage carriage({50.0, 1000.0, 0.0, 0.0});
    if (first.is_new)
      while (carriage.state.way < 0.02) carriage.step(felt(150.0));
    for (int i = 0; i < 100; ++i) carriage.step(first);
    const double felt_m = carriage.state.way;
    ASSERT_GT(felt_m, 0.009);
    carriage.run([](int) { return felt(200.0); });
    EXPECT_NEAR(carriage.state.way, felt_m + 0.03, 0.0005);
  }
}

TEST(RetreatWay, GoesOnByFeelingOnceTheModuleIsBack) {
  Carriage carriage({50.0, 1e6, 0.0, 0.0});
  const auto now_N = [&] { return std::max(0.0, 50.0 - 1000.0 * carriage.state.way); };
  carriage.run([&](int cycle) { return cycle < 40 ? silence() : felt(now_N()); });
  EXPECT_LE(now_N(), kThreshold_N);
}

TEST(RetreatWay, EndsInTimeWhereTheArmCannotMove) {
  Carriage carriage({150.0, 1000.0, 0.0, 0.0});
  carriage.state.row.setZero();
  carriage.run([](int) { return felt(150.0); });
  EXPECT_NEAR(carriage.state.time_s, kMaxRetreat_s, 2.0 * kPeriod_s);
  RetreatState exact;
  for (int i = 1; i <= 4; ++i) {
    retreatSpeed(felt(150.0), kThreshold_N, 0.5, exact);
    EXPECT_EQ(exact.is_over, i == 4) << "beyond 1.5 s";
  }
}

TEST(RetreatWay, BackIsAsLongAsItIsTold) {
  Carriage carriage({}, false);
  carriage.state.way = 0.3;  // of another one
  startWayBack(0.05, carriage.state);
  const int cycles = carriage.run([](int) { return silence(); });
  EXPECT_NEAR(cycles * kPeriod_s, 0.05, 2.0 * kPeriod_s);
  Carriage stays({}, false);
  startWayBack(0.0, stays.state);
  stays.run([](int) { return silence(); });
  EXPECT_EQ(stays.state.way, 0.0);
}

TEST(RetreatWay, GivesWayToWhatComesAfterIt) {
  for (const double obstacle_m_per_s : {0.02, 0.1, 0.2}) {
    Carriage carriage({50.0, 1e6, 0.0, 0.0});
    const auto now_N = [&] {
      const double place_m = obstacle_m_per_s * carriage.state.time_s;
      return std::max(0.0, 50.0 + 5000.0 * (place_m - carriage.state.way));
    };
    double largest_N = 0.0;
    carriage.run([&](int cycle) {
      if (cycle > 400) largest_N = std::max(largest_N, now_N());
      return felt(now_N());
    });
    const double ramp_m = obstacle_m_per_s * obstacle_m_per_s / (2.0 * 2.0);
    EXPECT_LE(largest_N, kThreshold_N + 5000.0 * 1.05 * ramp_m + 1.0) << obstacle_m_per_s;
    EXPECT_NEAR(carriage.state.time_s, kMaxRetreat_s, 2.0 * kPeriod_s) << obstacle_m_per_s;
  }
}

/// An obstacle that comes on may be there again.
TEST(RetreatWay, EndsOnceNothingPressedForAFifthOfASecond) {
  Carriage carriage({50.0, 1000.0, 0.0, 0.0});
  for (int i = 0; i < 50; ++i) carriage.step(felt(50.0 - 0.5 * i));
  for (int i = 0; i < 199; ++i) carriage.step(felt(kThreshold_N));
  EXPECT_FALSE(carriage.state.is_over);
  for (int i = 0; i < 3; ++i) carriage.step(felt(kThreshold_N));
  EXPECT_TRUE(carriage.state.is_over);
  RetreatState exact;
  for (int i = 1; i <= 3; ++i) {
    retreatSpeed(felt(0.0), kThreshold_N, 0.1, exact);
    EXPECT_EQ(exact.is_over, i == 3) << "beyond 0.2 s";
  }
}

TEST(RetreatWay, GoesOnFromWhereTheForceFellByANewton) {
  for (const double later_N : {149.01, 149.0}) {
    const bool answers = later_N == 149.0;
    Carriage carriage({150.0, 1000.0, 0.0, 0.0});
    carriage.run([&](int) { return felt(carriage.state.way < 0.02 ? 150.0 : later_N); });
    EXPECT_NEAR(carriage.state.way, answers ? 0.05 : 0.03, 0.0015);
  }
}

TEST(RetreatWay, IsAQuarterAsFastWhereNothingIsFelt) {
  for (const bool is_felt : {false, true}) {
    Carriage carriage({200.0, 100.0, 0.0, 0.0});
    double fastest = 0.0;
    carriage.run([&](int cycle) {
      fastest = std::max(fastest, carriage.state.speed);
      return is_felt ? felt(2000.0 - 1.5 * cycle) : silence();
    });
    EXPECT_EQ(fastest, is_felt ? 1.0 : 0.25);
  }
}

/// A sample counts for as long as it may be old, to the end; one that cannot be read for nothing.
TEST(RetreatWay, FeelsAsLongAsItsSampleMayBeOld) {
  Carriage carriage({50.0, 1000.0, 0.0, 0.0});
  carriage.step(felt(50.0));
  EXPECT_TRUE(carriage.state.is_felt);
  carriage.step({false, true, kMaxAge_s, kMaxAge_s, 0.0});
  EXPECT_TRUE(carriage.state.is_felt);
  EXPECT_FALSE(carriage.state.is_free) << "no sample has said so";
  carriage.step({false, true, 1.01 * kMaxAge_s, kMaxAge_s, 0.0});
  EXPECT_FALSE(carriage.state.is_felt);
  carriage.step(felt(50.0));
  EXPECT_TRUE(carriage.state.is_felt);
  carriage.step({true, false, 0.0, kMaxAge_s, 0.0});
  EXPECT_FALSE(carriage.state.is_felt);
  EXPECT_FALSE(carriage.state.is_free) << "nor has one that cannot be read";
}

TEST(RetreatWay, ThatIsOverStaysSo) {
  Carriage carriage({50.0, 1000.0, 0.0, 0.0});
  for (int i = 0; i < 250; ++i) carriage.step(felt(0.5));
  EXPECT_TRUE(carriage.state.is_over);
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(retreatSpeed(felt(90.0), 1.2, kPeriod_s, carriage.state), 0.0);
}

}  // namespace
}  // namespace tactus
