#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "tactus/supervisor/gain_change.h"

/// By which figures new gains are judged: where each limit lies, and what it was before.
namespace tactus {
namespace {

constexpr double kWatchPeriod_s = 0.001;

/// An arm whose contact is lost without what counts as a swing.
Gains watchedGains() {
  Gains gains;
  gains.force.contact_threshold_N = 1.2;
  gains.force.activation_force_N = 6.0;
  gains.force.transition.release_force_N = 1.15;
  return gains;
}

struct GainWatch {
  GainChange change{watchedGains(), kWatchPeriod_s};
  std::uint32_t number = 0;

  using Seen = std::function<GainWatchInput(double t_s)>;
  void pass(double duration_s, const Seen& seen) {
    const auto cycles = std::lround(duration_s / kWatchPeriod_s);
    for (long i = 0; i < cycles; ++i) change.update(seen(kWatchPeriod_s * static_cast<double>(i)));
  }
  void order(double T_s = 0.05) {
    GainOrder order{.number = ++number, .gains = change.kept()};
    order.gains.force.time_constant_s = T_s;
    change.order(order);
  }
  GainTrouble trouble() const { return change.report().trouble; }
  double limit() const { return change.report().limit; }
  double figure() const { return change.report().figure; }
};

GainWatchInput pressed(double /*t_s*/) { return {.force_N = 5.0}; }
GainWatchInput untouched(double /*t_s*/) { return {}; }

/// Contact is lost so often, a little below what holds it.
GainWatch::Seen losing(double per_s) {
  return [=](double t_s) {
    return GainWatchInput{.force_N = std::fmod(t_s * per_s, 1.0) < 0.5 ? 1.3 : 1.1};
  };
}

/// At a limit of speed for a share of the time.
GainWatch::Seen atLimit(double share, double force_N = 5.0) {
  return [=](double t_s) {
    return GainWatchInput{.force_N = force_N, .is_at_limit = std::fmod(t_s, 0.02) < 0.02 * share};
  };
}

GainWatch::Seen toAndFro(double swing_N) {
  return [=](double t_s) {
    return GainWatchInput{.force_N = std::fmod(t_s, 0.2) < 0.1 ? 5.0 : 5.0 + swing_N};
  };
}

GainTrouble troubleAfter(const GainWatch::Seen& before, const GainWatch::Seen& with) {
  GainWatch watch;
  watch.pass(8.0, before);
  watch.order();
  watch.pass(12.0, with);
  return watch.trouble();
}

TEST(GainWatch, LossesCountFromFourASecond) {
  EXPECT_EQ(troubleAfter(pressed, losing(3.0)), GainTrouble::kNone);
  EXPECT_EQ(troubleAfter(pressed, losing(4.5)), GainTrouble::kLosses);
  GainWatch watch;
  watch.order();
  watch.pass(3.0, losing(10.0));
  EXPECT_EQ(watch.limit(), 4.0);
  EXPECT_NEAR(watch.figure(), 4.5, 0.5) << "losses a second";
}

TEST(GainWatch, LimitsOfSpeedCountFromHalfOfTheTime) {
  EXPECT_EQ(troubleAfter(pressed, atLimit(0.4)), GainTrouble::kNone);
  EXPECT_EQ(troubleAfter(pressed, atLimit(0.6)), GainTrouble::kAtLimits);
  EXPECT_EQ(troubleAfter(pressed, atLimit(1.0, 0.5)), GainTrouble::kNone)
      << "on its way, without contact";
  GainWatch watch;
  watch.order();
  watch.pass(2.0, atLimit(1.0));
  EXPECT_EQ(watch.limit(), 0.5);
  EXPECT_NEAR(watch.figure(), 0.5, 0.01);
}

/// A share of 1 is seen as 1 - exp(-t / 1 s).
TEST(GainWatch, JudgesByTheLastSecond) {
  GainWatch watch;
  watch.pass(2.0, pressed);
  watch.order();
  double seen_s = 0.0;
  for (; seen_s < 3.0 && watch.trouble() == GainTrouble::kNone; seen_s += kWatchPeriod_s)
    watch.pass(kWatchPeriod_s, atLimit(1.0));
  EXPECT_EQ(watch.trouble(), GainTrouble::kAtLimits);
  EXPECT_NEAR(seen_s, std::log(2.0), 0.005);
}

/// Of the larger of both forces, of the gains that are kept.
TEST(GainWatch, SwingsCountFromATenthOfTheForce) {
  EXPECT_EQ(troubleAfter(pressed, toAndFro(0.59)), GainTrouble::kNone);
  EXPECT_EQ(troubleAfter(pressed, toAndFro(0.61)), GainTrouble::kSwings);
  GainWatch watch;
  watch.order();
  watch.pass(2.0, toAndFro(1.0));
  EXPECT_DOUBLE_EQ(watch.limit(), 0.6);
  EXPECT_NEAR(watch.figure(), 1.0, 1e-9);
}

TEST(GainWatch, NothingIsJudgedThatWasThereToThreeQuarters) {
  EXPECT_EQ(troubleAfter(toAndFro(1.0), toAndFro(1.28)), GainTrouble::kNone);
  EXPECT_EQ(troubleAfter(toAndFro(1.0), toAndFro(1.35)), GainTrouble::kSwings);
  EXPECT_EQ(troubleAfter(losing(8.0), losing(9.5)), GainTrouble::kNone);
  EXPECT_EQ(troubleAfter(losing(8.0), losing(13.0)), GainTrouble::kLosses);
  EXPECT_EQ(troubleAfter(atLimit(0.6), atLimit(0.75)), GainTrouble::kNone);
  EXPECT_EQ(troubleAfter(atLimit(0.6), atLimit(0.9)), GainTrouble::kAtLimits);
}

/// What was long before says nothing of the gains that are.
TEST(GainWatch, RemembersTenSeconds) {
  for (const auto& seen : {toAndFro(1.0), losing(8.0), atLimit(0.7)}) {
    for (const bool is_long_ago : {false, true}) {
      GainWatch watch;
      watch.pass(8.0, seen);
      watch.pass(is_long_ago ? 4.2 : 2.0, pressed);  // less than 10 ln 1.3 and a second of both
      watch.order();
      watch.pass(12.0, seen);
      EXPECT_EQ(watch.trouble() == GainTrouble::kNone, !is_long_ago);
    }
  }
}

/// How the arm did with gains that were tried says nothing of those that are kept.
TEST(GainWatch, KeepsToWhatWasBeforeTheOrder) {
  GainWatch watch;
  watch.pass(2.0, pressed);
  watch.order();
  watch.pass(0.4, toAndFro(0.55));
  watch.pass(2.0, toAndFro(5.0));
  EXPECT_EQ(watch.trouble(), GainTrouble::kSwings);
}

TEST(GainWatch, GoesBackInATenthOfASecond) {
  GainWatch watch;
  watch.order(0.2);
  watch.pass(2.0, pressed);
  watch.change.update({.force_N = 5.0, .has_fault = true});
  EXPECT_EQ(watch.trouble(), GainTrouble::kFault);
  EXPECT_EQ(watch.figure(), 1.0) << "one fault, where none is borne";
  EXPECT_EQ(watch.limit(), 0.0);
  watch.pass(0.095, pressed);
  EXPECT_EQ(watch.change.report().state, GainState::kGoingBack);
  EXPECT_NE(watch.change.gains().force.time_constant_s, 0.1);
  watch.pass(0.006, pressed);
  EXPECT_EQ(watch.change.report().state, GainState::kKept);
  EXPECT_EQ(watch.change.gains().force.time_constant_s, 0.1);
}

/// Where nothing went wrong there is no hurry; the way is as long as the one there.
TEST(GainWatch, GoesBackGentlyWhereItsTimeIsOver) {
  GainWatch watch;
  GainOrder passing{.number = 1, .gains = watch.change.kept(), .for_s = 2.0};
  passing.gains.force.time_constant_s = 0.2;
  watch.change.order(passing);
  watch.pass(1.003 + 2.0, pressed);
  EXPECT_EQ(watch.trouble(), GainTrouble::kTimeIsOver);
  EXPECT_NEAR(watch.figure(), 2.0, 2e-3);
  EXPECT_EQ(watch.limit(), 2.0);
  watch.pass(0.98, pressed);
  EXPECT_EQ(watch.change.report().state, GainState::kGoingBack);
  watch.pass(0.03, pressed);
  EXPECT_EQ(watch.change.report().state, GainState::kKept);
}

/// Just at a limit nothing is worse.
TEST(GainWatch, AFigureThatIsItsLimitIsBorne) {
  Gains gains = watchedGains();
  gains.force.activation_force_N = 5.0;  // half a newton
  GainWatch watch;
  watch.change = GainChange(gains, kWatchPeriod_s);
  watch.order();
  watch.pass(5.0, toAndFro(0.5));
  EXPECT_EQ(watch.trouble(), GainTrouble::kNone);
}

/// With a period whose sums have no rounding.
TEST(GainWatch, KeepsToItsTimes) {
  constexpr double kTick = 1.0 / 1024.0;
  GainOrder order{.number = 1, .gains = watchedGains(), .for_s = 2.0};
  for (const bool is_for_a_while : {true, false}) {
    GainChange change(watchedGains(), kTick);
    if (!is_for_a_while) order.for_s = kNoLimit;
    change.order(order);
    while (change.report().state != GainState::kOnTrial) change.update({.force_N = 5.0});
    const int ticks = is_for_a_while ? 2048 : 4096;
    for (int i = 0; i < ticks - 1; ++i) change.update({.force_N = 5.0});
    EXPECT_EQ(change.report().state, GainState::kOnTrial);
    change.update({.force_N = 5.0});
    EXPECT_EQ(change.report().state, is_for_a_while ? GainState::kGoingBack : GainState::kKept);
    EXPECT_EQ(change.report().figure, is_for_a_while ? 2.0 : 0.0);
  }
}

/// What was watched of the gains before is no trial of those that come after them.
TEST(GainWatch, EachTrialIsWhole) {
  GainWatch watch;
  for (int i = 0; i < 2; ++i) {
    watch.order(0.05);
    watch.pass(0.6 + 3.8, pressed);
    EXPECT_EQ(watch.change.report().state, GainState::kOnTrial) << i;
    watch.pass(0.3, pressed);
    EXPECT_EQ(watch.change.report().state, GainState::kKept) << i;
  }
}

/// Slow gains take longer to show what they do.
TEST(GainWatch, ATrialLastsTenTimeConstantsOfContact) {
  GainWatch watch;
  watch.order(1.0);
  watch.pass(5.0 + 9.9, pressed);
  watch.pass(20.0, untouched);
  EXPECT_EQ(watch.change.report().state, GainState::kOnTrial);
  watch.pass(0.2, pressed);
  EXPECT_EQ(watch.change.report().state, GainState::kKept);
}

/// Above the threshold it begins; at the release force it is over, and never above the threshold.
TEST(GainWatch, KnowsContactByBothForces) {
  const auto begins = [](double before_N, double force_N, double release_N) {
    Gains gains = watchedGains();
    gains.force.transition.release_force_N = release_N;
    GainChange change(gains, kWatchPeriod_s);
    change.update({.force_N = before_N});
    GainOrder order{.number = 1, .gains = gains, .waits_for_free = true};
    change.order(order);
    int cycles_left = static_cast<int>(std::lround(0.6 / kWatchPeriod_s));
    do change.update({.force_N = force_N});
    while (--cycles_left > 0 && change.report().state == GainState::kWaiting);
    return change.report().state == GainState::kRamping;
  };
  EXPECT_TRUE(begins(0.0, 1.2, 1.15)) << "at the threshold there is none";
  EXPECT_FALSE(begins(0.0, 1.21, 1.15));
  EXPECT_FALSE(begins(5.0, 1.16, 1.15));
  EXPECT_TRUE(begins(5.0, 1.15, 1.15));
  EXPECT_FALSE(begins(5.0, 1.21, 3.0));
  EXPECT_TRUE(begins(5.0, 1.2, 3.0));
}

/// For whoever takes the gains over in the cycles in which they change.
TEST(GainWatch, TellsWhenGainsChange) {
  GainWatch watch;
  Gains taken = watch.change.gains();
  watch.order(0.2);
  bool was_changing = false;
  for (int i = 0; i < 9000; ++i) {
    watch.change.update({.force_N = 5.0, .has_fault = i == 3000});
    if (watch.change.isChanging()) taken = watch.change.gains();
    ASSERT_TRUE(isSame(taken, watch.change.gains())) << i;
    was_changing |= watch.change.isChanging();
  }
  EXPECT_TRUE(was_changing);
  EXPECT_FALSE(watch.change.isChanging());
}

TEST(GainWatch, AnArmThatHoldsTriesNothing) {
  GainWatch arm;
  arm.order();
  arm.pass(30.0, [](double) { return GainWatchInput{.force_N = 5.0, .is_running = false}; });
  EXPECT_EQ(arm.change.report().state, GainState::kOnTrial);
  arm.pass(4.1, pressed);
  EXPECT_EQ(arm.change.report().state, GainState::kKept);
  EXPECT_EQ(arm.change.report().kept_number, 1U);
}

}  // namespace
}  // namespace tactus
