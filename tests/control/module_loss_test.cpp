#include "tactus/control/module_loss.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "support/controller_run.h"
#include "support/period.h"

/// A controller whose tactile modules fall silent, lie and come back by chance, against what may be
/// said of it by the samples alone.
namespace tactus {
namespace {

using test::kPeriod_s;

constexpr int kModules = 3;
constexpr double kShare = 0.3;

ControllerConfig skinController(test::Random& random) {
  ControllerConfig config = test::fullController(random, 7, Variant::kNone);
  config.force_control.reset();
  for (int i = 1; i < kModules; ++i) {
    config.tactile_modules.push_back(config.tactile_modules.front());
    config.tactile_modules.back().link = test::randomFrame(random, i + 1);
  }
  config.module_loss = ModuleLossConfig{kShare};
  return config;
}

enum class Trouble { kNone, kSilent, kNoNumber, kExcess };

/// A module by chance: mostly quiet, now and then pushed, now and then in trouble.
class ChanceModule {
 public:
  explicit ChanceModule(test::Random& random) : random_(random) {}

  TactileSample next() {
    if (cycle_++ % 4 != 0) return sample_;
    if (--samples_left_ < 0) change();
    if (trouble_ == Trouble::kSilent) return sample_;
    const std::uint32_t sequence = sample_.sequence + 1;
    sample_ = test::touchAt(0.2, push_N_, 0.4, sequence);
    if (trouble_ == Trouble::kNoNumber)
      sample_.force_z_N = std::numeric_limits<double>::quiet_NaN();
    if (trouble_ == Trouble::kExcess) sample_ = test::touchAt(0.2, 500.0, 0.4, sequence);
    return sample_;
  }

  Trouble trouble() const { return trouble_; }

 private:
  void change() {
    samples_left_ = random_.integer(1, 120);
    push_N_ = random_.chance(0.3) ? random_.logUniform(0.05, 20.0) : 0.0;
    trouble_ = Trouble::kNone;
    if (random_.chance(0.15)) trouble_ = Trouble::kSilent;
    if (random_.chance(0.1)) trouble_ = Trouble::kNoNumber;
    if (random_.chance(0.03)) trouble_ = Trouble::kExcess;
  }

  test::Random& random_;
  int cycle_ = 0, samples_left_ = 25;  // none of the first
  double push_N_ = 0.0;
  Trouble trouble_ = Trouble::kNone;
  TactileSample sample_;
};

/// What of a module's samples says whether it may be lost: told anew from them.
struct Oracle {
  std::uint32_t sequence = 0;
  double age_s = 0.0, of_late_N = 0.0;
  bool is_number = true, is_excess = false, is_lost = false;

  void see(const TactileSample& sample, const TactileModuleConfig& module) {
    age_s += kPeriod_s;
    if (sample.sequence == sequence) return;
    sequence = sample.sequence;
    const double fades_s = std::max(kPushFades_s, kPushFadesPeriods / module.filter_cutoff_hz);
    of_late_N *= std::max(0.0, 1.0 - age_s / fades_s);
    age_s = 0.0;
    const double force_N = std::hypot(sample.force_y_N, sample.force_z_N);
    is_number = std::isfinite(force_N);
    is_excess = is_number && force_N > module.max_force_N;
    if (is_number && !is_excess) of_late_N = std::max(of_late_N, force_N);
  }

  bool isGood(const TactileModuleConfig& module) const {
    return is_number && !is_excess && age_s <= module.max_sample_age_s;
  }
};

TEST(ModuleLoss, IsBorneExactlyWhereNothingPushesAndAnotherIsGood) {
  int lost_runs = 0, faults = 0, cycles_lost = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    test::Random random(seed);
    const ControllerConfig config = skinController(random);
    const Controller controller(config);
    const Gains& gains = controller.initialGains();
    ControllerState state = controller.initialState();
    ControllerOutput output;
    std::vector<ChanceModule> modules(kModules, ChanceModule(random));
    std::array<Oracle, kModules> oracle;
    bool was_lost = false;
    for (int cycle = 0; cycle < 4000 && output.fault == Fault::kNone; ++cycle) {
      RobotInput input{state.q_desired, {}};
      for (int i = 0; i < kModules; ++i) {
        input.tactile[i] = modules[i].next();
        oracle[i].see(input.tactile[i], config.tactile_modules[i]);
      }
      std::uint64_t expected = 0;
      bool is_fault = false;
      const bool is_any_good = std::ranges::any_of(
          oracle, [&](const Oracle& o) { return o.isGood(config.tactile_modules[0]); });
      for (int i = 0; i < kModules; ++i) {
        Oracle& o = oracle[i];
        if (o.isGood(config.tactile_modules[i])) {
          o.is_lost = false;
          continue;
        }
        const bool is_calm = o.is_lost || o.of_late_N <= gains.force.transition.release_force_N;
        o.is_lost = is_any_good && is_calm && !o.is_excess;
        if (o.is_lost) o.of_late_N = 0.0;
        is_fault = is_fault || !o.is_lost;
        if (o.is_lost) expected |= std::uint64_t{1} << i;
      }
      controller.update(input, gains, cycle * kPeriod_s, kPeriod_s, state, output);
      ASSERT_EQ(output.fault != Fault::kNone, is_fault) << "seed " << seed << " cycle " << cycle;
      ASSERT_TRUE(output.velocity.allFinite());
      if (is_fault) {
        ++faults;
        break;
      }
      ASSERT_EQ(output.modules_lost, expected) << "seed " << seed << " cycle " << cycle;
      for (int i = 0; i < kModules; ++i)
        if (oracle[i].is_lost) {
          ASSERT_EQ(output.sensed[i].force_N, 0.0);
        }
      was_lost = was_lost || expected != 0;
      cycles_lost += expected != 0 ? 1 : 0;
      const double largest =
          output.velocity.cwiseAbs().cwiseQuotient(config.limits.max_velocity).maxCoeff();
      ASSERT_LE(largest, output.speed_share * (1.0 + 1e-12));
      ASSERT_GE(output.speed_share, kShare);
    }
    lost_runs += was_lost ? 1 : 0;
  }
  EXPECT_GT(lost_runs, 20) << "this test is blind";
  EXPECT_GT(faults, 20) << "this test is blind";
  EXPECT_GT(cycles_lost, 2000);
}

/// What was sensed at last is no sample of the next cycle, too: laws would learn from it.
TEST(ModuleLoss, LeavesNothingThatWasSensed) {
  TactileReading reading;
  reading.contact.force_N = reading.hardest.force_N = 3.0;
  reading.contact.interval_s = kPeriod_s;
  lose(reading);
  EXPECT_TRUE(reading.is_lost);
  EXPECT_EQ(reading.contact.force_N, 0.0);
  EXPECT_EQ(reading.hardest.force_N, 0.0);
  EXPECT_FALSE(reading.contact.isNew());
  EXPECT_EQ(reading.unproven_s, kModuleProof_s);
}

/// Missed cycles are of the time in which the arm slows down, but make it no faster.
TEST(ModuleLoss, CountsMissedCycles) {
  test::Random random(78);
  const Controller controller(skinController(random));
  ControllerState state = controller.initialState();
  state.modules[1].unproven_s = kModuleProof_s;
  controller.coast(50, kPeriod_s, state);
  EXPECT_NEAR(state.speed_share, 1.0 - 50 * kPeriod_s / kSpeedShareRise_s, 1e-12);
  controller.coast(1000, kPeriod_s, state);
  EXPECT_EQ(state.speed_share, kShare);
  state.modules[1].unproven_s = 0.0;
  controller.coast(50, kPeriod_s, state);
  EXPECT_EQ(state.speed_share, kShare);
}

/// Everything of the task's own is slowed alike: the arm goes the same way, later.
TEST(ModuleLoss, LeavesTheWayAsItIs) {
  test::Random random(77);
  ControllerConfig config = skinController(random);
  config.limits.max_velocity.setConstant(1e3);
  config.limits.max_acceleration.setConstant(1e6);
  config.limits.upper.setConstant(1e3);
  config.limits.lower.setConstant(-1e3);
  config.has_joint_limit_avoidance = false;
  config.gains.task.wait_beyond_m = kNoLimit;
  const Controller controller(config);
  const auto end = [&](bool is_lost, double duration_s) {
    ControllerState state = controller.initialState();
    ControllerOutput output;
    RobotInput input{state.q_desired, {}};
    // All of it at the share, from the start on.
    if (is_lost) state.speed_share = kShare;
    for (int i = 0; i * kPeriod_s < duration_s; ++i) {
      for (int module = 0; module < kModules; ++module) {
        const bool is_silent = is_lost && module == 1;
        input.tactile[module].sequence = is_silent ? 0 : static_cast<std::uint32_t>(i + 1);
        if (is_silent) state.modules[module].age_s = 1.0;
      }
      controller.update(input, controller.initialGains(), i * kPeriod_s, kPeriod_s, state, output);
    }
    EXPECT_EQ(output.fault, Fault::kNone);
    EXPECT_NEAR(output.path_time_s, is_lost ? kShare * duration_s : duration_s, 0.01);
    return std::pair(JointVector(state.q_desired), TaskVector(output.w_d_dot));
  };
  const auto [fast, fast_speed] = end(false, 3.0);
  const auto [slow, slow_speed] = end(true, 3.0 / kShare);
  EXPECT_GT((fast - config.q_start).norm(), 0.05) << "an arm that does not move goes no way";
  EXPECT_LT((slow - fast).norm(), 5e-3);
  EXPECT_GT(fast_speed.norm(), 1e-2);
  EXPECT_LT((slow_speed - kShare * fast_speed).norm(), 1e-2 * fast_speed.norm());
}

TEST(ModuleLoss, EndsASecondAfterTheModuleIsBack) {
  TactileReading reading;
  lose(reading);
  EXPECT_TRUE(reading.is_lost);
  double speed_share = kShare;
  int cycles = 0;
  while (reading.unproven_s > 0.0 && cycles < 5000) {
    prove(kPeriod_s, reading);
    speed_share = nextSpeedShare(kShare, {&reading, 1}, kPeriod_s, speed_share);
    ++cycles;
  }
  EXPECT_NEAR(cycles * kPeriod_s, kModuleProof_s, 2 * kPeriod_s);
  EXPECT_LE(speed_share, kShare + kPeriod_s / kSpeedShareRise_s * 1.001);
  for (int i = 0; i < 200; ++i)
    speed_share = nextSpeedShare(kShare, {&reading, 1}, kPeriod_s, speed_share);
  EXPECT_EQ(speed_share, 1.0);
}

TEST(GoodModule, IsThereInTimeAndBelieved) {
  TactileModuleConfig module;
  module.max_sample_age_s = 0.02;
  TactileReading reading;
  reading.age_s = 0.02;
  EXPECT_TRUE(isGood(reading, module)) << "as old as it may be";
  reading.age_s = 0.021;
  EXPECT_FALSE(isGood(reading, module));
  reading.age_s = 0.0;
  reading.is_lost = true;
  EXPECT_FALSE(isGood(reading, module));
  reading.is_lost = false;
  reading.fault = Fault::kTactileInvalid;
  EXPECT_FALSE(isGood(reading, module));
}

TEST(ModuleLoss, IsBorneUpToAPushThatIsReleased) {
  TactileReading reading;
  reading.hardest.force_N = 0.3;
  EXPECT_TRUE(mayBeLost(reading, 0.3));
  reading.contact.force_N = 0.31;
  EXPECT_FALSE(mayBeLost(reading, 0.3));
  reading.is_lost = true;
  EXPECT_TRUE(mayBeLost(reading, 0.3)) << "what is lost stays so";
  reading.has_excess = true;
  EXPECT_TRUE(mayBeLost(reading, 0.3)) << "an excess of before the newest sample";
  reading.fault = Fault::kTactileInvalid;
  EXPECT_FALSE(mayBeLost(reading, 0.3)) << "it tells of a push";
}

}  // namespace
}  // namespace tactus
