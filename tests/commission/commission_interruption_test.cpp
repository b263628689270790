#include <gtest/gtest.h>

#include <functional>

#include "support/troubled_commission.h"

/// Whatever interrupts the commissioning of a joint, whenever: the arm ends at rest without power,
/// and a run that is begun anew finds what an undisturbed one finds.
namespace tactus {
namespace {

using test::TroubledRig;
using Phase = CommissionCycle::Phase;

struct Interruption {
  const char* name;
  std::function<void(TroubledRig&)> strike, repair;
  bool has_to_end = true;  ///< while the joint moves
  double overshoot = 0.0;  ///< of the travel
};

Trouble plantTrouble(Trouble::Kind kind, double duration_s) {
  Trouble trouble;
  trouble.kind = kind;
  trouble.until_s = duration_s;
  trouble.id = kind == Trouble::Kind::kPowerCut ? 0 : 2;
  return trouble;
}

const std::vector<Interruption>& interruptions() {
  const auto nothing = [](TroubledRig&) {};
  const auto play = [](Trouble::Kind kind) {
    return [kind](TroubledRig& rig) { rig.plant.play({plantTrouble(kind, 2.0)}, rig.t_ns); };
  };
  static const std::vector<Interruption> kAll = {
      {"Ctrl-C", [](TroubledRig& rig) { rig.input.stop_requested = true; },
       [](TroubledRig& rig) { rig.input.stop_requested = false; }},
      {"e-stop", [](TroubledRig& rig) { rig.input.lines.emergency_stop = true; },
       [](TroubledRig& rig) { rig.input.lines.emergency_stop = false; }},
      {"enable off", [](TroubledRig& rig) { rig.input.lines.enable = false; },
       [](TroubledRig& rig) { rig.input.lines.enable = true; }, false},
      {"lines lost", [](TroubledRig& rig) { rig.input.lines.is_valid = false; },
       [](TroubledRig& rig) { rig.input.lines.is_valid = true; }},
      {"bus-off", [](TroubledRig& rig) { rig.input.bus_faults[0] = Fault::kBusOff; },
       [](TroubledRig& rig) { rig.input.bus_faults[0] = Fault::kNone; }},
      {"power cut", play(Trouble::Kind::kPowerCut), nothing},
      {"drive fault", play(Trouble::Kind::kDriveFault), nothing, false},
      {"drive that ignores all", play(Trouble::Kind::kIgnoreCommands), nothing, false, 0.6},
      {"frozen feedback", play(Trouble::Kind::kFreezeFeedback), nothing, false, 0.3},
      {"nonsense", play(Trouble::Kind::kNonsenseStatus), nothing, false},
      {"boot-up", play(Trouble::Kind::kBootUp), nothing, false},
      {"feedback lost",
       [](TroubledRig& rig) {
         rig.on_frame = [](int, CanFrame& frame) { return frame.id != 0x182; };
       },
       [](TroubledRig& rig) { rig.on_frame = nullptr; }},
      {"heartbeat lost",
       [](TroubledRig& rig) {
         rig.on_frame = [](int, CanFrame& frame) { return frame.id != 0x702; };
       },
       [](TroubledRig& rig) { rig.on_frame = nullptr; }},
      {"commands lost",
       [](TroubledRig& rig) { rig.on_send = [](int, CanFrame&) { return false; }; },
       [](TroubledRig& rig) { rig.on_send = nullptr; }},
      {"a long pause", [](TroubledRig& rig) { rig.input.missed_cycles = 200; }, nothing, false,
       0.2},
  };
  return kAll;
}

/// At random moments, as many in each phase.
void interrupt(const Interruption& interruption, std::uint64_t seed) {
  SCOPED_TRACE(testing::Message() << interruption.name << " " << seed);
  TroubledRig rig(seed);
  rig.may_brake = true;
  test::Random chance(seed);
  int changes_left = chance.integer(0, 24);
  int cycles_left = chance.integer(0, 400);
  Phase phase = Phase::kIdle;
  bool has_struck = false, was_moving = false;
  rig.on_cycle = [&] {
    rig.watch();
    if (rig.cycle->phase() != phase) --changes_left;
    phase = rig.cycle->phase();
    if (has_struck || changes_left > 0 || --cycles_left > 0) return;
    has_struck = true;
    was_moving = phase == Phase::kMoving;
    interruption.strike(rig);
  };
  const bool has_ended = rig.commission(test::kTroubledJoint, 120'000);
  // Without its enable line it waits for ever, until somebody stops it.
  rig.input.stop_requested = true;
  rig.cycles(has_ended ? 1 : 3000);
  rig.input.stop_requested = false;
  EXPECT_EQ(rig.cycle->phase(), Phase::kIdle);
  if (has_struck && was_moving && interruption.has_to_end) {
    EXPECT_NE(rig.cycle->joint()->trouble().kind, JointTroubleKind::kNone);
  }
  rig.cycles(2500);
  EXPECT_TRUE(rig.isAllOffAndAtRest());
  EXPECT_FALSE(rig.cycle->lines().release_brake);
  EXPECT_LE(rig.worst_speed, 1.0 + 1e-3);
  EXPECT_LE(rig.worst_travel, 1.0 + interruption.overshoot + 1e-2);
  EXPECT_LE(rig.most_powered, 1);
  interruption.repair(rig);
  rig.on_cycle = nullptr;
  rig.restart();
  ASSERT_TRUE(rig.scan());
  ASSERT_TRUE(rig.commission(test::kTroubledJoint));
  EXPECT_EQ(rig.cycle->joint()->trouble().kind, JointTroubleKind::kNone);
  test::expectFound(rig, rig.cycle->joint()->findings());
}

TEST(CommissionInterruption, WhateverInterruptsItEndsAtRestAndIsResumed) {
#ifdef TACTUS_SANITIZED
  constexpr std::uint64_t kSeeds = 1;  // which take ten times as long
#else
  constexpr std::uint64_t kSeeds = 4;
#endif
  for (const Interruption& interruption : interruptions())
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) interrupt(interruption, seed);
}

/// What the drive says is of before the last command: it is not off because it was.
TEST(CommissionInterruption, StopInAnyCycleOfSwitchingOnLeavesNoPower) {
  constexpr std::uint16_t kShutdown = 0x06;  // the first control word towards power
  for (int cycles_after = 0; cycles_after < 12; ++cycles_after) {
    SCOPED_TRACE(cycles_after);
    TroubledRig rig;
    int cycles = -1, cycles_with_torque = 0;
    rig.on_send = [&](int, CanFrame& frame) {
      if (frame.id == 0x202 && frame.data[0] == kShutdown && cycles < 0) cycles = 0;
      return true;
    };
    rig.on_cycle = [&] {
      rig.watch();
      if (cycles >= 0) rig.input.stop_requested = cycles++ == cycles_after;
      const bool is_stopping = cycles > cycles_after && cycles < 100;
      const PowerState state = rig.drive(test::kTroubledJoint).powerState();
      if (is_stopping && state == PowerState::kOperationEnabled) ++cycles_with_torque;
    };
    rig.commission(test::kTroubledJoint, 3000);
    EXPECT_GT(cycles, cycles_after);
    if (cycles_after < 3) {
      EXPECT_EQ(cycles_with_torque, 0) << "of a start cut short";
    }
    rig.cycles(4000);
    EXPECT_TRUE(rig.isAllOffAndAtRest());
    EXPECT_TRUE(rig.cycle->question()) << "as after any motion that was stopped";
  }
}

}  // namespace
}  // namespace tactus
