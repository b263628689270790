#include <gtest/gtest.h>

#include <cstring>
#include <utility>

#include "support/troubled_commission.h"

/// What goes wrong while a joint is commissioned: it has a name, and the arm ends at rest without
/// power.
namespace tactus {
namespace {

using test::CommissionRig;
using test::HiddenJoint;
using test::Random;
using test::TroubledRig;

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

/// Two drives with one node id obey the same frames.
TEST(CommissionTrouble, DrivesThatWouldMoveTogether) {
  for (const int joint : {0, 1, 2}) {
    SCOPED_TRACE(joint);
    std::vector<HiddenJoint> arm = test::turnedArm();
    arm[2].node_id = arm[1].node_id;
    CommissionRig rig(arm, test::configWithLines(), 1);
    ASSERT_TRUE(rig.scan());
    ASSERT_EQ(rig.cycle->nodes().size(), 2u);
    EXPECT_FALSE(rig.cycle->nodes()[0].has_twin);
    EXPECT_TRUE(rig.cycle->nodes()[1].has_twin);
    EXPECT_TRUE(rig.commission(joint));
    const JointTrouble& trouble = rig.cycle->joint()->trouble();
    EXPECT_EQ(trouble.kind, JointTroubleKind::kTwoDevices);
    EXPECT_EQ(trouble.node_id, 2);
    EXPECT_EQ(rig.most_powered, 0);
  }
}

/// One that was switched on after the scan; its answers come a cycle after the other's.
TEST(CommissionTrouble, DriveThatGetsATwinLater) {
  TroubledRig rig;
  rig.on_frame = [&rig](int bus, CanFrame& frame) {
    if (frame.id == 0x582) rig.own_answers.emplace_back(bus, frame);
    return true;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kTwoDevices);
  EXPECT_EQ(trouble.node_id, 2);
  EXPECT_EQ(rig.most_powered, 0);
}

/// A sender repeats a frame of whose end it is not sure.
TEST(CommissionTrouble, NoneWhereOneAnswerCameTwice) {
  TroubledRig rig;
  int repeated = 0;
  rig.on_frame = [&](int bus, CanFrame& frame) {
    if (frame.id == 0x582 && ++repeated == 1) rig.own_answers.emplace_back(bus, frame);
    return true;
  };
  EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
}

TEST(CommissionTrouble, AnotherDriveThatHasPower) {
  TroubledRig rig;
  rig.on_frame = [](int, CanFrame& frame) {
    if (frame.id == 0x583 && test::sdoIndex(frame) == 0x6041) frame.data[4] = 0x27;
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
    const bool is_place = frame.id == 0x582 && test::sdoIndex(frame) == 0x6064;
    if (!is_place || rig.most_powered == 0) return true;
    frame.data[6] = static_cast<std::uint8_t>(frame.data[6] + 1);  // 65536 counts
    return true;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kMovedBetween);
  EXPECT_NEAR(trouble.value, 65536.0, 1.0);
}

/// The counts that the drive tells, moved by what nobody commanded.
struct MovedRig : TroubledRig {
  explicit MovedRig(double brake_switching_s = 0.1) {
    config.hardware.gpio->brake_switching_s = brake_switching_s;
    restart();
    EXPECT_TRUE(scan());
    on_frame = [this](int, CanFrame& frame) {
      const bool is_read = frame.id == 0x582 && test::sdoIndex(frame) == 0x6064;
      if (!is_read && frame.id != 0x182) return true;
      std::uint8_t* const at = frame.data.data() + (is_read ? 4 : 2);
      std::int32_t counts = 0;
      std::memcpy(&counts, at, 4);
      counts += static_cast<std::int32_t>(moved_rad * truth[test::kTroubledJoint].counts_per_unit);
      std::memcpy(at, &counts, 4);
      return true;
    };
  }

  double moved_rad = 0.0;
};

/// The drive holds it, but with an encoder of the wrong sense not where it is.
TEST(CommissionTrouble, JointThatRunsAwayAsItsBrakeOpens) {
  for (const double speed_rad_per_s : {0.1, 0.5, -3.0}) {
    for (const double switching_s : {0.05, 0.5}) {
      SCOPED_TRACE(switching_s * speed_rad_per_s);
      MovedRig rig(switching_s);
      rig.on_cycle = [&] {
        rig.watch();
        const bool has_power =
            rig.drive(test::kTroubledJoint).powerState() == PowerState::kOperationEnabled;
        if (rig.cycle->lines().release_brake && has_power &&
            rig.drive(test::kTroubledJoint).velocity() == 0.0)
          rig.moved_rad += speed_rad_per_s * CommissionRig::kPeriod_s;
      };
      const JointTrouble trouble = rig.trouble();
      if (std::abs(speed_rad_per_s) * switching_s < 0.01) {
        EXPECT_LT(std::abs(rig.moved_rad), 0.1);
        continue;
      }
      EXPECT_EQ(trouble.kind, JointTroubleKind::kStroke);
      EXPECT_EQ(trouble.stroke.end, StrokeEnd::kMovedAway);
      EXPECT_GT(trouble.stroke.detail.value, 0.0);
      EXPECT_LT(std::abs(rig.moved_rad), 0.02 + 0.05 * std::abs(speed_rad_per_s));
    }
  }
}

/// Its way was as long as to the end that was told.
TEST(CommissionTrouble, JointThatIsPushedWhileTheEnableLineIsWaitedFor) {
  MovedRig rig;
  rig.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked == Asked::kReady) rig.input.lines.enable = false;
    return std::nullopt;
  };
  int waits = 0;
  rig.on_cycle = [&] {
    rig.watch();
    if (!rig.cycle->isWaitingForEnable()) return;
    if (++waits <= 90) rig.moved_rad += 0.001;
    rig.input.lines.enable = waits > 200;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kStroke);
  EXPECT_EQ(trouble.stroke.end, StrokeEnd::kMovedAway);
  EXPECT_EQ(rig.worst_travel, 0.0);
  EXPECT_EQ(rig.most_powered, 0);
}

TEST(CommissionTrouble, NodeThatIsNotThere) {
  std::vector<HiddenJoint> truth = test::turnedArm();
  truth[test::kTroubledJoint].is_absent = true;
  CommissionRig rig(truth, test::configWithLines(), 1);
  rig.jogs = false;
  ASSERT_TRUE(rig.scan());
  ASSERT_TRUE(rig.commission(test::kTroubledJoint));
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
    return Answer{Answer::Kind::kNumber, -mirrored.measured(test::kTroubledJoint)};
  };
  EXPECT_EQ(mirrored.trouble().kind, JointTroubleKind::kSignsDisagree);
  TroubledRig still;
  still.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked != Asked::kPlace) return std::nullopt;
    return Answer{Answer::Kind::kNumber, 0.7};
  };
  EXPECT_EQ(still.trouble().kind, JointTroubleKind::kStillOpen);
  TroubledRig refuses;
  refuses.on_question = [](const Question&) { return Answer{Answer::Kind::kNo}; };
  EXPECT_EQ(refuses.trouble().kind, JointTroubleKind::kStopped);
  EXPECT_EQ(refuses.most_powered, 0);
}

TEST(CommissionTrouble, OneWrongNumberDoesNotMakeAMotionLong) {
  for (int trial = 0; trial < 24; ++trial) {
    const double wrong = std::vector{-1.0, 0.15, 0.5, 30.0}[static_cast<std::size_t>(trial % 4)];
    const int which = 1 + trial / 4 % 3;
    TroubledRig rig(1, trial < 12 ? 4e5 : 1.05e5);  // hardly more than the file allows
    int places = 0;
    rig.on_question = [&](const Question& question) -> std::optional<Answer> {
      if (question.asked != Asked::kPlace || ++places != which) return std::nullopt;
      return Answer{Answer::Kind::kNumber, rig.measured(test::kTroubledJoint) + wrong};
    };
    const JointTroubleKind kind = rig.trouble().kind;
    EXPECT_TRUE(kind == JointTroubleKind::kCannotTell || kind == JointTroubleKind::kFewerCounts)
        << wrong;
    EXPECT_LE(rig.worst_travel, 1.0 + 1e-3) << wrong;
    EXPECT_LE(rig.worst_speed, 1.0 + 1e-3) << wrong;
  }
}

TEST(CommissionTrouble, SignIsJudgedBeforeAnyJog) {
  TroubledRig rig;
  rig.jogs = true;
  int jogs = 0;
  rig.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked == Asked::kJog) ++jogs;
    if (question.asked != Asked::kPlace) return std::nullopt;
    return Answer{Answer::Kind::kNumber, -rig.measured(test::kTroubledJoint)};
  };
  EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kSignsDisagree);
  EXPECT_EQ(jogs, 0);
}

TEST(CommissionTrouble, PlaceAtAnEndThatIsMistypedIsAskedAgain) {
  for (const double factor : {-1.0, 0.0, 100.0}) {
    TroubledRig rig;
    rig.jogs = true;
    int refused = 0;
    double lowest = 0.0, highest = 0.0;
    rig.on_cycle = [&] {
      lowest = std::min(lowest, rig.position(test::kTroubledJoint));
      highest = std::max(highest, rig.position(test::kTroubledJoint));
    };
    rig.on_question = [&](const Question& question) -> std::optional<Answer> {
      if (question.asked != Asked::kEndPlace) return std::nullopt;
      refused += question.is_refused ? 1 : 0;
      if (question.is_refused) return std::nullopt;
      return Answer{Answer::Kind::kNumber, factor * rig.measured(test::kTroubledJoint)};
    };
    EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
    EXPECT_EQ(refused, 2);
    test::expectFound(rig, rig.cycle->joint()->findings());
    EXPECT_GE(lowest, rig.truth[test::kTroubledJoint].lower);
    EXPECT_LE(highest, rig.truth[test::kTroubledJoint].upper);
  }
}

TEST(CommissionTrouble, JointDoesNotPassAnEndThatWasTold) {
  using Kind = Answer::Kind;
  TroubledRig rig;
  const std::vector<std::pair<Kind, bool>> said = {
      {Kind::kPlus, false},  {Kind::kUpper, false}, {Kind::kPlus, true},  {Kind::kLower, true},
      {Kind::kMinus, false}, {Kind::kPlus, false},  {Kind::kPlus, true},  {Kind::kMinus, false},
      {Kind::kMinus, false}, {Kind::kLower, false}, {Kind::kMinus, true}, {Kind::kUpper, true},
      {Kind::kPlus, false},  {Kind::kMinus, false}, {Kind::kDone, false}};
  std::size_t next = 0;
  bool was_refused = false;
  double lower = -10.0, upper = 10.0;
  const auto q = [&] { return rig.position(test::kTroubledJoint); };
  rig.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked == Asked::kEndPlace) return Answer{Kind::kUnknown};
    if (question.asked != Asked::kJog) return std::nullopt;
    EXPECT_EQ(question.is_refused, was_refused) << next;
    const auto [kind, is_refused] = said.at(next++);
    was_refused = is_refused;
    if (kind == Kind::kUpper && !is_refused) upper = q();
    if (kind == Kind::kLower && !is_refused) lower = q();
    return Answer{kind};
  };
  rig.on_cycle = [&] {
    EXPECT_LT(q(), upper + 1e-3);
    EXPECT_GT(q(), lower - 1e-3);
  };
  EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
  EXPECT_EQ(next, said.size());
}

/// A wave without ends that are known goes back where the last motion came from.
TEST(CommissionTrouble, WaveGoesAwayFromTheLastMotion) {
  for (const Answer::Kind way : {Answer::Kind::kPlus, Answer::Kind::kMinus}) {
    TroubledRig rig;
    bool has_jogged = false, is_done = false;
    double farthest = 0.0;
    const double sense = way == Answer::Kind::kPlus ? 1.0 : -1.0;
    const auto q = [&] { return sense * rig.position(test::kTroubledJoint); };
    rig.on_question = [&](const Question& question) -> std::optional<Answer> {
      if (question.asked != Asked::kJog) return std::nullopt;
      if (std::exchange(has_jogged, true)) {
        is_done = true;
        farthest = q();
        return Answer{Answer::Kind::kDone};
      }
      return Answer{way};
    };
    rig.on_cycle = [&] {
      if (is_done) {
        EXPECT_LT(q(), farthest + 1e-3);
      }
    };
    EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
    EXPECT_TRUE(is_done);
  }
}

/// With one end told, too: the other one may be where it was jogged to.
TEST(CommissionTrouble, WaveGoesAwayFromTheLastMotionWhereOneEndWasTold) {
  for (const bool is_upper : {true, false}) {
    SCOPED_TRACE(is_upper);
    TroubledRig rig;
    int jogs = 0;
    double farthest = 0.0, end = 0.0, least = 1e9;
    const double away = is_upper ? -1.0 : 1.0;
    const auto q = [&] { return away * rig.position(test::kTroubledJoint); };
    rig.on_question = [&](const Question& question) -> std::optional<Answer> {
      if (question.asked == Asked::kEndPlace) return Answer{Answer::Kind::kUnknown};
      if (question.asked != Asked::kJog) return std::nullopt;
      switch (++jogs) {
        case 1:
          end = q();
          return Answer{is_upper ? Answer::Kind::kUpper : Answer::Kind::kLower};
        case 2:
          return Answer{is_upper ? Answer::Kind::kMinus : Answer::Kind::kPlus};
        default:
          farthest = q();
          return Answer{Answer::Kind::kDone};
      }
    };
    rig.on_cycle = [&] {
      if (jogs < 3) return;
      EXPECT_LT(q(), farthest + 1e-3);
      least = std::min(least, q());
    };
    EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kNone);
    EXPECT_EQ(jogs, 3);
    EXPECT_GT(least, end - 1e-3);
    EXPECT_LT(least, farthest - 0.01) << "it waved";
  }
}

/// Whoever stops a jog may have seen something in the way.
TEST(CommissionTrouble, NoWaveWhereAJogWasStoppedNearTheEnd) {
  TroubledRig rig;
  int jogs = 0;
  bool was_refused = false, was_stopped = false;
  double begin = 0.0, farthest = 0.0;
  const auto q = [&] { return rig.position(test::kTroubledJoint); };
  rig.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked == Asked::kEndPlace) return Answer{Answer::Kind::kUnknown};
    if (question.asked != Asked::kJog) return std::nullopt;
    was_refused = was_refused || question.is_refused;
    switch (++jogs) {
      case 1:
        return Answer{Answer::Kind::kUpper};
      case 2:
        begin = q();
        return Answer{Answer::Kind::kMinus};
      case 3:
        farthest = q();
        return Answer{Answer::Kind::kDone};
      default:
        rig.input.stop_requested = true;  // enough
        return Answer{Answer::Kind::kDone};
    }
  };
  rig.on_cycle = [&] {
    const bool is_enough = jogs == 2 && !was_stopped && q() < begin - 0.01;
    was_stopped = was_stopped || is_enough;
    if (jogs < 4) rig.input.stop_requested = is_enough;
    if (jogs >= 3) {
      EXPECT_GT(q(), farthest - 1e-3);
    }
  };
  EXPECT_EQ(rig.trouble().kind, JointTroubleKind::kStopped);
  EXPECT_TRUE(was_stopped);
  EXPECT_TRUE(was_refused);
}

TEST(CommissionTrouble, FewerCountsThanTheFileAllowsEndTheJoint) {
  TroubledRig rig(1, 2e4);  // a fifth of what the file allows
  int places = 0;
  rig.on_question = [&](const Question& question) -> std::optional<Answer> {
    if (question.asked == Asked::kPlace) ++places;
    return std::nullopt;
  };
  const JointTrouble trouble = rig.trouble();
  EXPECT_EQ(trouble.kind, JointTroubleKind::kFewerCounts);
  EXPECT_LT(trouble.value, 2.2e4);
  EXPECT_EQ(trouble.limit, 1e5);
  EXPECT_EQ(places, 2);
}

TEST(CommissionTrouble, EnableLineIsWaitedFor) {
  TroubledRig rig;
  rig.input.lines.enable = false;
  rig.cycle->begin(test::kTroubledJoint);
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

}  // namespace
}  // namespace tactus
