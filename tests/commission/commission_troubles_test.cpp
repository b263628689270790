#include <gtest/gtest.h>

#include <functional>

#include "support/commission_arms.h"

/// What goes wrong while a joint is commissioned: it has a name, the arm ends at rest without
/// power, and a run that is begun anew finds what an undisturbed one finds.
namespace tactus {
namespace {

using test::CommissionRig;
using test::HiddenJoint;
using test::Random;
using Phase = CommissionCycle::Phase;

constexpr int kJoint = 1;

std::vector<HiddenJoint> turnedArm() {
  std::vector<HiddenJoint> arm = test::plainArm(3);
  arm[1].sign = -1;
  arm[1].counts_per_unit = 4e5;
  arm[1].offset = 1.2;
  arm[1].start = 0.1;
  return arm;
}

CommissionConfig configWithLines() {
  CommissionConfig config = test::commissionConfig(test::plainArm(3));
  GpioConfig gpio;
  gpio.e_stop = gpio.enable = gpio.brake = GpioLineConfig{};
  config.hardware.gpio = gpio;
  return config;
}

struct TroubledRig : CommissionRig {
  explicit TroubledRig(std::uint64_t seed = 1)
      : CommissionRig(turnedArm(), configWithLines(), seed) {
    jogs = false;
    EXPECT_TRUE(scan());
    on_cycle = [this] { watch(); };
  }

  /// In every cycle, whatever happens.
  void watch() {
    const bool is_open = cycle->lines().release_brake;
    const PowerState state = drive(kJoint).powerState();
    const bool has_torque = state == PowerState::kOperationEnabled ||
                            state == PowerState::kQuickStopActive ||
                            state == PowerState::kFaultReactionActive;
    // A cycle and a half for the frames to have told.
    open_without_torque = is_open && !has_torque ? open_without_torque + 1 : 0;
    most_open_without_torque = std::max(most_open_without_torque, open_without_torque);
    if (drive(kJoint).velocity() != 0.0 && has_torque && !is_open && !may_brake) ++moved_on_brake;
  }

  JointTrouble trouble() {
    EXPECT_TRUE(commission(kJoint));
    cycles(1500);
    EXPECT_TRUE(isAllOffAndAtRest());
    EXPECT_FALSE(cycle->lines().release_brake);
    return cycle->joint()->trouble();
  }

  int open_without_torque = 0, most_open_without_torque = 0, moved_on_brake = 0;
  bool may_brake = false;
};

std::uint16_t sdoIndex(const CanFrame& frame) {
  return static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
}

CanFrame sdoAnswer(int node_id, const CanFrame& request, std::uint8_t command, std::uint32_t data) {
  CanFrame answer = request;
  answer.id = 0x580u + static_cast<unsigned>(node_id);
  answer.data[0] = command;
  for (unsigned i = 0; i < 4; ++i) answer.data[4 + i] = static_cast<std::uint8_t>(data >> 8 * i);
  return answer;
}

TEST(CommissionTrouble, NoneMovesTheJointAndUsesTheBrake) {
  TroubledRig rig;
  EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
  test::expectFound(rig, rig.cycle->joint()->findings());
  EXPECT_LE(rig.most_open_without_torque, 2);
  EXPECT_EQ(rig.moved_on_brake, 0);
}

TEST(CommissionTrouble, JointThatIsStuck) {
  TroubledRig rig;
  rig.on_send = [](int, CanFrame& frame) {
    if (frame.id == 0x202) std::fill_n(frame.data.begin() + 2, 4, std::uint8_t{0});
    return true;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kStroke);
  EXPECT_EQ(trouble.stroke.end, StrokeEnd::kFault);
  EXPECT_EQ(trouble.stroke.fault, Fault::kFollowingError);
  EXPECT_EQ(rig.worst_travel, 0.0);
}

TEST(CommissionTrouble, CountsThatRunAgainstTheCommand) {
  TroubledRig rig;
  rig.on_send = [](int, CanFrame& frame) {
    if (frame.id != 0x202) return true;
    std::int32_t counts = 0;
    std::memcpy(&counts, frame.data.data() + 2, 4);
    counts = -counts;
    std::memcpy(frame.data.data() + 2, &counts, 4);
    return true;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kStroke);
  EXPECT_EQ(trouble.stroke.end, StrokeEnd::kWrongWay);
  EXPECT_LT(rig.worst_travel, 0.1);
}

TEST(CommissionTrouble, DriveThatRefusesItsSetUp) {
  TroubledRig rig;
  rig.on_send = [&rig](int bus, CanFrame& frame) {
    if (frame.id != 0x602 || sdoIndex(frame) != 0x6060) return true;
    rig.own_answers.emplace_back(bus, sdoAnswer(2, frame, 0x80, 0x06090030));
    return false;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kStroke);
  EXPECT_EQ(trouble.stroke.fault, Fault::kDriveSetupRefused);
  EXPECT_EQ(trouble.stroke.drive.setup_failure.index, 0x6060);
  EXPECT_EQ(trouble.stroke.drive.setup_failure.abort_code, 0x06090030u);
  EXPECT_EQ(rig.most_powered, 0);
}

TEST(CommissionTrouble, AnotherDriveThatHasPower) {
  TroubledRig rig;
  rig.on_frame = [](int, CanFrame& frame) {
    if (frame.id == 0x583 && sdoIndex(frame) == 0x6041) frame.data[4] = 0x27;
    return true;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kOtherHasPower);
  EXPECT_EQ(trouble.node_id, 3);
  EXPECT_EQ(rig.most_powered, 0);
}

TEST(CommissionTrouble, AnotherDriveThatSaysNothingAnyMore) {
  TroubledRig rig;
  rig.on_frame = [](int, CanFrame& frame) { return frame.id != 0x581; };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kOtherSilent);
  EXPECT_EQ(trouble.node_id, 1);
  EXPECT_EQ(rig.most_powered, 0);
}

/// A joint without a brake, when its drive lets go.
TEST(CommissionTrouble, JointThatSinks) {
  TroubledRig rig;
  rig.on_frame = [&rig](int, CanFrame& frame) {
    const bool is_place = frame.id == 0x582 && sdoIndex(frame) == 0x6064;
    if (!is_place || rig.most_powered == 0) return true;
    frame.data[6] = static_cast<std::uint8_t>(frame.data[6] + 1);  // 65536 counts
    return true;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kMovedBetween);
  EXPECT_NEAR(trouble.value, 65536.0, 1.0);
}

TEST(CommissionTrouble, NodeThatIsNotThere) {
  std::vector<HiddenJoint> truth = turnedArm();
  truth[kJoint].is_absent = true;
  CommissionRig rig(truth, configWithLines(), 1);
  rig.jogs = false;
  ASSERT_TRUE(rig.scan());
  ASSERT_TRUE(rig.commission(kJoint));
  EXPECT_EQ(rig.cycle->joint()->trouble().kind, JointTroubleKind::kNoNode);
  for (const int joint : {0, 2}) {  // what was seen on the way is known
    ASSERT_TRUE(rig.commission(joint));
    EXPECT_EQ(rig.cycle->joint()->trouble().kind, JointTroubleKind::kNone);
    test::expectFound(rig, rig.cycle->joint()->findings());
  }
}

TEST(CommissionTrouble, EngineerWhoContradictsHimself) {
  TroubledRig mirrored;
  mirrored.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked != Asked::kPlace) return std::nullopt;
    return Answer{Answer::Kind::kNumber, -mirrored.measured(kJoint)};
  };
  EXPECT_EQ(mirrored.trouble().kind, JointTroubleKind::kSignsDisagree);
  TroubledRig still;
  still.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked != Asked::kPlace) return std::nullopt;
    return Answer{Answer::Kind::kNumber, 0.7};
  };
  EXPECT_EQ(still.trouble().kind, JointTroubleKind::kCannotTell);
  TroubledRig refuses;
  refuses.on_question = [](const Question&) { return Answer{Answer::Kind::kNo}; };
  EXPECT_EQ(refuses.trouble().kind, JointTroubleKind::kStopped);
  EXPECT_EQ(refuses.most_powered, 0);
}

TEST(CommissionTrouble, OneWrongNumberDoesNotMakeAMotionLong) {
  for (int trial = 0; trial < 12; ++trial) {
    const double wrong = std::vector{-1.0, 0.15, 0.5, 30.0}[static_cast<std::size_t>(trial % 4)];
    const int which = 1 + trial / 4;
    TroubledRig rig;
    int places = 0;
    rig.on_question = [&](const Question& question) -> std::optional<Answer> {
      if (question.asked != Asked::kPlace || ++places != which) return std::nullopt;
      return Answer{Answer::Kind::kNumber, rig.measured(kJoint) + wrong};
    };
    EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kCannotTell) << wrong;
    EXPECT_LE(rig.worst_travel, 1.0 + 1e-3) << wrong;
    EXPECT_LE(rig.worst_speed, 1.0 + 1e-3) << wrong;
  }
}

TEST(CommissionTrouble, DrivesOwnCountsAreTakenWhereMarksConfirmThem) {
  constexpr double kTurn = 6.283185307179586;
  for (const bool is_right : {true, false}) {
    TroubledRig rig;
    const auto per_turn = static_cast<std::uint32_t>(std::lround(4e5 * kTurn * (is_right ? 1 : 3)));
    rig.on_send = [&](int bus, CanFrame& frame) {
      const std::uint16_t index = frame.id == 0x602 ? sdoIndex(frame) : std::uint16_t{0};
      if (index != 0x608F && index != 0x6091) return true;
      const bool is_counts = index == 0x608F && frame.data[3] == 1;
      rig.own_answers.emplace_back(bus, sdoAnswer(2, frame, 0x43, is_counts ? per_turn : 1));
      return false;
    };
    rig.restart();
    ASSERT_TRUE(rig.scan());
    EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
    const JointFindings& found = rig.cycle->joint()->findings();
    EXPECT_NEAR(found.drive_counts_per_unit.value_or(0.0), per_turn / kTurn, 1e-6);
    EXPECT_EQ(found.source, is_right ? ScaleSource::kDrive : ScaleSource::kMeasured);
    EXPECT_NEAR(found.scale.counts_per_unit, 4e5, is_right ? 1.0 : 4e4);
    test::expectFound(rig, found);
  }
}

TEST(CommissionTrouble, EnableLineIsWaitedFor) {
  TroubledRig rig;
  rig.input.lines.enable = false;
  rig.cycle->begin(kJoint);
  ASSERT_TRUE(rig.cycle->answer({Answer::Kind::kYes}));
  rig.cycles(3000);
  EXPECT_TRUE(rig.cycle->isWaitingForEnable());
  EXPECT_EQ(rig.most_powered, 0);
  rig.input.lines.enable = true;
  rig.cycles(500);
  EXPECT_FALSE(rig.cycle->isWaitingForEnable());
  EXPECT_EQ(rig.most_powered, 1);
}

TEST(CommissionTrouble, LateCyclesDoNoHarm) {
  TroubledRig rig;
  Random chance(5);
  rig.on_cycle = [&] {
    if (chance.chance(0.02)) rig.input.missed_cycles = chance.integer(1, 3);
  };
  EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
  test::expectFound(rig, rig.cycle->joint()->findings());
  EXPECT_LE(rig.worst_travel, 1.01);
  EXPECT_LE(rig.worst_speed, 1.0 + 1e-3);
}

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
  Random chance(seed);
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
  const bool has_ended = rig.commission(kJoint, 120'000);
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
  ASSERT_TRUE(rig.commission(kJoint));
  EXPECT_EQ(rig.cycle->joint()->trouble().kind, JointTroubleKind::kNone);
  test::expectFound(rig, rig.cycle->joint()->findings());
}

TEST(CommissionTrouble, WhateverInterruptsItEndsAtRestAndIsResumed) {
  for (const Interruption& interruption : interruptions())
    for (std::uint64_t seed = 1; seed <= 4; ++seed) interrupt(interruption, seed);
}

}  // namespace
}  // namespace tactus
