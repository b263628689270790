#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>
#include <utility>

#include "support/commission_folder.h"
#include "support/commission_rig.h"
#include "tactus/cli/commission_file.h"
#include "tactus/cli/commission_run.h"
#include "tactus/scene/exit_code.h"

/// The whole of `tactus commission` but sockets and terminal: what is asked and typed, and what the
/// files then say.
namespace tactus {
namespace {

using test::CommissionFolder;

constexpr int kLift = 0, kShoulder = 1, kRoll = 2;

/// In the file both are the other way round, and shoulder and roll turn and count otherwise.
std::vector<test::HiddenJoint> trueArm() {
  std::vector<test::HiddenJoint> arm(3);
  arm[kLift] = {.is_prismatic = true,
                .bus = 0,
                .node_id = 2,
                .sign = 1,
                .counts_per_unit = 1e7,
                .offset = 0.25,
                .start = 0.1,
                .lower = 0.0,
                .upper = 0.2};
  arm[kShoulder] = {.is_prismatic = false,
                    .bus = 0,
                    .node_id = 1,
                    .sign = -1,
                    .counts_per_unit = 4.2e6,
                    .offset = 0.7,
                    .start = 0.2,
                    .lower = -0.2,
                    .upper = 0.6};
  arm[kRoll] = {.is_prismatic = false,
                .bus = 1,
                .node_id = 9,
                .sign = 1,
                .counts_per_unit = 2e6,
                .offset = -1.1,
                .start = 0.3,
                .lower = -0.1,
                .upper = 0.7};
  return arm;
}

/// An engineer who reads and types, at an arm in virtual time.
class VirtualDesk final : public CommissionDesk {
 public:
  explicit VirtualDesk(const Scene& scene, const std::vector<test::HiddenJoint>& arm = trueArm())
      : rig(arm, commissionConfig(scene, {}), 3), scene_(scene) {}

  test::CommissionRig rig;
  std::string said;
  std::function<void()> on_write;
  std::string typed_ahead;  ///< a line that nobody has asked for yet
  bool is_gone = false;     ///< types nothing else, and then goes away
  std::optional<std::pair<int, Fault>> bus_fault;
  bool stops_after_writing = false;
  int no_to_writing = 0;        ///< the how manieth question to write is answered by no, from 1
  const char* goes_on = "end";  ///< where a joint is not finished
  int cycles_to_stop = 0;       ///< of motion, until a line is typed
  /// In this cycle after each answer, while drives are asked whether they are off.
  int reading_cycle_typed = 0;
  std::string typed_while_reading;

  /// As another program that is started at the same arm.
  void restart(const Scene& scene) {
    rig.config = commissionConfig(scene, {});
    rig.restart();
    said.clear();
    stops_after_writing = false;
    is_stopped_ = false;
  }

  void end() { is_stopped_ = true; }

  void runCycle() override {
    rig.step();
    rig.input.stop_requested = false;
    reading_cycles_ = cycle().phase() == CommissionCycle::Phase::kReading ? reading_cycles_ + 1 : 0;
    if (++cycles_ > 3'000'000) is_stopped_ = true;
  }
  CommissionCycle& cycle() override { return *rig.cycle; }
  void stopMotion() override { rig.input.stop_requested = true; }
  std::optional<std::pair<int, Fault>> takeBusFault() override { return bus_fault; }
  void say(const std::string& text) override { said += text; }
  bool isStopped() const override { return is_stopped_; }
  void forgetTyped() override { typed_ahead.clear(); }

  std::optional<std::string> takeLine() override {
    if (!typed_ahead.empty()) return std::exchange(typed_ahead, "");
    if (is_gone) {
      is_stopped_ = true;
      return std::nullopt;
    }
    if (const Question* const question = cycle().question()) {
      rig.noteQuestion();
      return typed(*question);
    }
    if (reading_cycles_ > 0 && reading_cycles_ == reading_cycle_typed) return typed_while_reading;
    if (cycle().phase() == CommissionCycle::Phase::kMoving && --cycles_to_stop == 0) return "";
    if (cycle().phase() != CommissionCycle::Phase::kIdle) return std::nullopt;
    const bool asks_on = said.ends_with("end > ");
    const bool is_writing = said.ends_with("Write this? yes, no > ");
    if (is_writing && on_write) on_write();
    if (is_writing && stops_after_writing) is_stopped_ = true;
    if (is_writing && --no_to_writing == 0) return "no";
    return asks_on ? goes_on : " yes\r";
  }

 private:
  std::string typed(const Question& question) {
    const Answer answer = rig.answer(question);
    const double unit = rig.truth[question.joint].is_prismatic ? 1e-3 : std::numbers::pi / 180.0;
    switch (answer.kind) {
      case Answer::Kind::kYes:
        return "yes";
      case Answer::Kind::kNo:
        return "no";
      case Answer::Kind::kPlus:
        return " + ";
      case Answer::Kind::kMinus:
        return "-";
      case Answer::Kind::kOtherJoint:
        return scene_.joint_names[static_cast<std::size_t>(answer.joint)];
      case Answer::Kind::kNumber:
        return fmt::format("{:.5f}", answer.value / unit);
      case Answer::Kind::kUpper:
        return "upper";
      case Answer::Kind::kLower:
        return "lower";
      case Answer::Kind::kDone:
        return "done";
      default:
        return "none";
    }
  }

  Scene scene_;
  bool is_stopped_ = false;
  long cycles_ = 0;
  int reading_cycles_ = 0;  ///< of the phase that goes on
};

void expectFileIsRight(const CommissionFolder& folder) {
  const Scene scene = folder.scene();
  const std::vector<test::HiddenJoint> arm = trueArm();
  for (std::size_t j = 0; j < arm.size(); ++j) {
    const DriveConfig& drive = scene.hardware->drives[j];
    SCOPED_TRACE(scene.joint_names[j]);
    EXPECT_EQ(drive.bus, arm[j].bus);
    EXPECT_EQ(drive.node_id, arm[j].node_id);
    EXPECT_EQ(drive.sign, arm[j].sign);
    EXPECT_NEAR(drive.counts_per_unit / arm[j].counts_per_unit, 1.0, 0.03);
    const double counts = arm[j].sign * arm[j].counts_per_unit * (arm[j].start - arm[j].offset);
    EXPECT_NEAR(counts / (drive.sign * drive.counts_per_unit) + drive.offset, arm[j].start,
                arm[j].is_prismatic ? 0.0015 : 0.0105);
  }
}

TEST(Commission, WritesWhatItFindsAndKeepsTheRest) {
  const CommissionFolder folder;
  const std::string before = folder.content("robot.yaml");
  VirtualDesk desk(folder.scene());
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitDone) << desk.said;
  expectFileIsRight(folder);
  EXPECT_TRUE(desk.said.ends_with("all joints are finished\n"));
  const std::string after = folder.content("robot.yaml");
  EXPECT_EQ(after.substr(0, 23), "# a comment at the top\n");
  EXPECT_NE(after.find("drives:  # and one here\n"), std::string::npos);
  // Counts that the marks confirm are left as somebody computed them.
  EXPECT_NE(after.find("counts_per_m: 1e7"), std::string::npos);
  EXPECT_NE(after.find("position_lag_s: 0.00"), std::string::npos);
  EXPECT_EQ(folder.content("robot.yaml~"), before);  // of three that were written
  EXPECT_NE(desk.said.find("- "), std::string::npos);
  EXPECT_NE(before, after);
}

/// Else a bus might be empty or overloaded by what is written first, which is refused.
TEST(Commission, JointsThatMovedOnTheWayGetTheirPlacesAtOnce) {
  const CommissionFolder folder;
  std::vector<test::HiddenJoint> arm = trueArm();
  arm[kLift].bus = 1;
  arm[kLift].node_id = 30;  // of which the file does not know
  arm[kRoll].bus = 0;
  arm[kRoll].node_id = 2;
  VirtualDesk desk(folder.scene(), arm);
  desk.stops_after_writing = true;
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitFault);
  EXPECT_EQ(readState(statePath(robotFile(folder.scene()))).at("joints").size(), 1u);
  const Scene scene = folder.scene();
  for (std::size_t j = 0; j < arm.size(); ++j) {
    EXPECT_EQ(scene.hardware->drives[j].bus, arm[j].bus) << j;
    EXPECT_EQ(scene.hardware->drives[j].node_id, arm[j].node_id) << j;
  }
}

/// All joints go into the file that the link leads to, not the first one alone.
TEST(Commission, ALinkToTheRobotStaysALink) {
  const CommissionFolder folder;
  std::filesystem::rename(folder.path("robot.yaml"), folder.path("mine.yaml"));
  std::filesystem::create_symlink("mine.yaml", folder.path("robot.yaml"));
  const std::string before = folder.content("mine.yaml");
  VirtualDesk desk(folder.scene());
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitDone) << desk.said;
  EXPECT_TRUE(std::filesystem::is_symlink(folder.path("robot.yaml")));
  expectFileIsRight(folder);
  EXPECT_NE(folder.content("mine.yaml").find("position_lag_s: 0.00"), std::string::npos);
  EXPECT_EQ(folder.content("mine.yaml~"), before);
}

TEST(Commission, GoesOnWhereItWasLeft) {
  const CommissionFolder folder;
  VirtualDesk desk(folder.scene());
  desk.stops_after_writing = true;
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitFault);
  EXPECT_NE(folder.content("robot.yaml~"), folder.content("robot.yaml"));
  const Json state = readState(statePath(robotFile(folder.scene())));
  EXPECT_EQ(state.at("joints").size(), 1u);
  desk.restart(folder.scene());
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitDone) << desk.said;
  EXPECT_EQ(desk.said.find("lift, perhaps"), std::string::npos);
  EXPECT_NE(desk.said.find("roll, perhaps"), std::string::npos);
  expectFileIsRight(folder);

  // One joint anew, though it is finished; and one whose entry somebody has changed since.
  desk.restart(folder.scene());
  CommissionOptions options;
  options.joint = kRoll;
  EXPECT_EQ(runCommission(folder.scene(), options, desk), kExitDone) << desk.said;
  EXPECT_NE(desk.said.find("roll, perhaps"), std::string::npos);
  folder.put("robot.yaml", test::replaced(folder.content("robot.yaml"), "counts_per_m: 1e7",
                                          "counts_per_m: 1.1e7"));
  desk.restart(folder.scene());
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitDone) << desk.said;
  EXPECT_NE(desk.said.find("lift, perhaps"), std::string::npos);
  EXPECT_EQ(desk.said.find("roll, perhaps"), std::string::npos);
}

/// A motion that a line stops is no failure: it is asked again, from where it stopped.
TEST(Commission, LineThatIsTypedStopsAMotion) {
  for (const int cycles : {200, 700, 1500, 12'000, 40'000}) {
    const CommissionFolder folder;
    VirtualDesk desk(folder.scene());
    desk.cycles_to_stop = cycles;
    EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitDone) << desk.said;
    EXPECT_LT(desk.cycles_to_stop, 0);
    EXPECT_EQ(desk.said.find("is not finished"), std::string::npos);
    expectFileIsRight(folder);
  }
}

/// The key that ends an answer, hit twice, is no wish to stop what has not begun.
TEST(Commission, SecondEnterAfterAnAnswerStopsNothing) {
  const CommissionFolder folder;
  VirtualDesk desk(folder.scene());
  desk.reading_cycle_typed = 1;
  desk.typed_while_reading = "\r";
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitDone) << desk.said;
  expectFileIsRight(folder);
}

TEST(Commission, AnyOtherLineAfterAnAnswerKeepsTheJointFromMoving) {
  struct Typed {
    int cycle;
    const char* line;
  };
  for (const Typed typed : {Typed{1, "no"}, Typed{299, ""}, Typed{300, ""}}) {
    SCOPED_TRACE(typed.cycle);
    const CommissionFolder folder;
    VirtualDesk desk(folder.scene());
    bool is_asking = false;
    desk.rig.on_question = [&](const Question&) {
      is_asking = true;  // from here on one drive lets the others wait
      return std::nullopt;
    };
    desk.rig.on_frame = [&](int, CanFrame& frame) { return !is_asking || frame.id != 0x589; };
    desk.reading_cycle_typed = typed.cycle;
    desk.typed_while_reading = typed.line;
    EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitFault);
    EXPECT_EQ(desk.said.find("is not finished: stopped") != std::string::npos, typed.cycle != 299)
        << desk.said;
    EXPECT_EQ(desk.rig.most_powered, 0);
  }
}

TEST(Commission, RefusesAFileThatChangedMeanwhile) {
  const CommissionFolder folder;
  VirtualDesk desk(folder.scene());
  const Scene scene = folder.scene();
  folder.put("robot.yaml", folder.content("robot.yaml") + "# edited\n");
  EXPECT_EQ(runCommission(scene, {}, desk), kExitFault);
  EXPECT_NE(desk.said.find("was changed meanwhile"), std::string::npos);
  EXPECT_TRUE(folder.content("robot.yaml").ends_with("# edited\n"));
  EXPECT_FALSE(std::filesystem::exists(statePath(robotFile(scene))));
}

TEST(Commission, FilesThatCannotBeReadAreNamed) {
  const CommissionFolder folder;
  const Scene scene = folder.scene();
  VirtualDesk desk(scene);
  desk.on_write = [&] { std::filesystem::remove(folder.path("robot.yaml")); };
  EXPECT_EQ(runCommission(scene, {}, desk), kExitFault);
  EXPECT_NE(desk.said.find(folder.path("robot.yaml") + ":1:1: -: No such file"), std::string::npos)
      << desk.said;
  const std::string state = statePath(robotFile(scene));
  std::filesystem::create_directory(state);
  try {
    readState(state);
    ADD_FAILURE() << "a folder was read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(state + ":1:1: -: is a folder"), std::string::npos)
        << error.what();
  }
}

TEST(Commission, WhatCannotBeWrittenIsSaidBeforeAnythingMoves) {
  for (const char* name : {"robot.yaml.next", "robot.yaml.commission.json.next", "robot.yaml~"}) {
    const CommissionFolder folder;
    VirtualDesk desk(folder.scene());
    std::filesystem::create_directory(folder.path(name));
    EXPECT_THROW(runCommission(folder.scene(), {}, desk), InputError) << name;
    EXPECT_EQ(desk.rig.most_powered, 0);
  }
}

/// A disk that is full when the first joint is written, and no more from the second try on. Counts
/// the writes.
void fillDiskForAWhile(const CommissionFolder& folder, VirtualDesk& desk, int& writes) {
  desk.on_write = [blocked = folder.path("robot.yaml.commission.json.next"), &writes] {
    ++writes;
    if (writes == 1) std::filesystem::create_directory(blocked);
    if (writes == 2) std::filesystem::remove(blocked);
  };
}

/// A disk that is full for a while costs no measured joint.
TEST(Commission, FindingsAreStillThereAfterAFailedWrite) {
  const CommissionFolder folder;
  VirtualDesk desk(folder.scene());
  int writes = 0;
  fillDiskForAWhile(folder, desk, writes);
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitDone) << desk.said;
  EXPECT_EQ(writes, 4);  // of three joints
  EXPECT_NE(desk.said.find("cannot be opened for writing"), std::string::npos);
  expectFileIsRight(folder);
}

/// The robot's file has the joint by then: that is no change by somebody else.
TEST(Commission, NoAfterHalfAWriteCostsNoOtherJoint) {
  const CommissionFolder folder;
  VirtualDesk desk(folder.scene());
  int writes = 0;
  fillDiskForAWhile(folder, desk, writes);
  desk.no_to_writing = 2;
  desk.goes_on = "next";
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitFault);
  EXPECT_EQ(desk.said.find("was changed meanwhile"), std::string::npos) << desk.said;
  EXPECT_TRUE(desk.said.ends_with("not finished: lift\n"));
  expectFileIsRight(folder);
}

TEST(Commission, ScanAloneMovesNothing) {
  const CommissionFolder folder;
  VirtualDesk desk(folder.scene());
  CommissionOptions options;
  options.is_scan_alone = options.json = true;
  EXPECT_EQ(runCommission(folder.scene(), options, desk), kExitDone);
  const Json json = Json::parse(desk.said);
  ASSERT_EQ(json.at("nodes").size(), 3u);
  EXPECT_EQ(json.at("nodes").at(2).at("joint"), "roll");
  EXPECT_EQ(json.at("nodes").at(2).at("node_id"), 9);
  EXPECT_EQ(json.at("missing").size(), 0u);
  EXPECT_EQ(desk.rig.most_powered, 0);
  desk.restart(folder.scene());
  desk.bus_fault.emplace(1, Fault::kBusOff);
  EXPECT_EQ(runCommission(folder.scene(), options, desk), kExitFault);
  desk.restart(folder.scene());
  desk.bus_fault.reset();
  desk.end();
  EXPECT_EQ(runCommission(folder.scene(), options, desk), kExitFault);
  EXPECT_EQ(desk.said, "");
}

TEST(Commission, LineThatWasTypedTooEarlyAnswersNothing) {
  const CommissionFolder folder;
  VirtualDesk desk(folder.scene());
  desk.typed_ahead = "yes";
  desk.is_gone = true;
  EXPECT_EQ(runCommission(folder.scene(), {}, desk), kExitFault);
  EXPECT_TRUE(desk.said.ends_with("yes, no > ")) << desk.said;
  EXPECT_EQ(desk.said.find("May it?"), std::string::npos);
  EXPECT_EQ(desk.rig.most_powered, 0);
}

}  // namespace
}  // namespace tactus
