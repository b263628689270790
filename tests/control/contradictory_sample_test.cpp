#include <gtest/gtest.h>

#include <cmath>

#include "support/period.h"
#include "support/random.h"
#include "support/tactile_samples.h"
#include "tactus/control/tactile_reading.h"

/// Samples whose force and moment fit no push on the cover, and samples that jump.
namespace tactus {
namespace {

TactileModuleConfig contradictedModule() {
  TactileModuleConfig module;
  module.length_m = 0.38;
  module.max_force_N = 100.0;
  return module;
}

Fault readOnce(const TactileSample& sample, TactileReading& reading) {
  return readSample(contradictedModule(), sample, test::kPeriod_s, reading);
}

TEST(ContradictorySample, IsNoneThatAPushOnTheCoverMakes) {
  test::Random random(31);
  TactileReading reading;
  for (std::uint32_t i = 1; i < 20'000; ++i) {
    const double x_m = random.uniform(0.0, 0.38);
    const double force_N = random.logUniform(1e-3, 99.9);
    ASSERT_EQ(readOnce(test::touchAt(x_m, force_N, random.uniform(-3.0, 3.0), i), reading),
              Fault::kNone);
  }
}

/// Of two pushes from opposite sides the sum seems to lie off the cover.
TEST(ContradictorySample, IsNoneOfTwoPushesOfWhichOneIsTwiceTheOther) {
  test::Random random(32);
  TactileReading reading;
  int off_cover = 0;
  for (std::uint32_t i = 1; i < 20'000; ++i) {
    const double angle = random.uniform(-3.0, 3.0);
    const double force_N = random.uniform(1.0, 90.0);
    const TactileSample a = test::touchAt(random.uniform(0.0, 0.38), force_N, angle, i);
    const TactileSample b =
        test::touchAt(random.uniform(0.0, 0.38), -random.uniform(0.0, 0.5) * force_N, angle, i);
    const TactileSample both{a.force_y_N + b.force_y_N, a.force_z_N + b.force_z_N,
                             a.moment_y_Nm + b.moment_y_Nm, a.moment_z_Nm + b.moment_z_Nm, i};
    off_cover += offCover_m(both, contradictedModule()) > 0.0 ? 1 : 0;
    ASSERT_EQ(readOnce(both, reading), Fault::kNone);
  }
  EXPECT_GT(off_cover, 1000) << "this test is blind";
}

TEST(ContradictorySample, IsAFaultThatSaysHowFarOffThePushWouldBe) {
  test::Random random(33);
  for (std::uint32_t i = 1; i < 5000; ++i) {
    TactileReading reading;
    ASSERT_EQ(readOnce(test::touchAt(0.2, 0.0, 0.0, 1), reading), Fault::kNone);
    const double off_m = random.uniform(0.39, 20.0);
    const double x_m = random.chance(0.5) ? 0.38 + off_m : -off_m;
    const double force_N = random.uniform(10.1, 99.9);
    const TactileSample sample = test::touchAt(x_m, force_N, random.uniform(-3.0, 3.0), 2);
    ASSERT_EQ(readOnce(sample, reading), Fault::kTactileInvalid);
    ASSERT_EQ(std::string(reading.detail.unit), "m");
    ASSERT_NEAR(reading.detail.value, off_m, 1e-9);
    ASSERT_EQ(reading.detail.limit, 0.38);
    ASSERT_FALSE(reading.has_excess) << "it tells nothing of a push";
    ASSERT_EQ(reading.contact.force_N, 0.0) << "and nothing is believed of it";
  }
}

TEST(ContradictorySample, MayLieAsFarOffAsTheCoverIsLong) {
  TactileModuleConfig module = contradictedModule();
  module.length_m = 0.5;
  TactileReading reading;
  // Of 16 N at 1 m, and at -0.5 m.
  for (const double moment_Nm : {16.0, -8.0}) {
    const TactileSample sample{16.0, 0.0, 0.0, moment_Nm, reading.sequence + 1};
    EXPECT_EQ(readSample(module, sample, test::kPeriod_s, reading), Fault::kNone);
    TactileSample beyond = sample;
    ++beyond.sequence;
    beyond.moment_z_Nm *= 1.001;
    EXPECT_EQ(readSample(module, beyond, test::kPeriod_s, reading), Fault::kTactileInvalid);
  }
}

TEST(ContradictorySample, IsNoneOfAForceThatIsNoise) {
  TactileReading reading;
  EXPECT_EQ(readOnce(test::touchAt(5.0, 9.9, 0.3, 1), reading), Fault::kNone);
  EXPECT_LE(reading.contact.position_m, 0.38) << "but the place stays on the cover";
}

/// A blow jumps, too: what is within the range is a push, what is beyond it a fault, which
/// retreats.
TEST(JumpingSample, IsAPushOrAFaultByItsSizeAlone) {
  TactileReading reading;
  EXPECT_EQ(readOnce(test::touchAt(0.1, 0.0, 0.0, 1), reading), Fault::kNone);
  EXPECT_EQ(readOnce(test::touchAt(0.1, 99.0, 0.0, 2), reading), Fault::kNone);
  EXPECT_NEAR(reading.contact.force_N, 99.0, 1e-9);
  EXPECT_EQ(readOnce(test::touchAt(0.35, 99.0, 3.0, 3), reading), Fault::kNone);
  EXPECT_NEAR(reading.contact.position_m, 0.35, 1e-9);
  EXPECT_EQ(readOnce(test::touchAt(0.35, 101.0, 3.0, 4), reading), Fault::kTactileInvalid);
  EXPECT_TRUE(reading.has_excess);
  EXPECT_EQ(std::string(reading.detail.unit), "N");
}

}  // namespace
}  // namespace tactus
