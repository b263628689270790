#include "tactus/cli/commission_text.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <numbers>

#include "support/commission_folder.h"
#include "tactus/cli/commission_file.h"
#include "tactus/cli/commission_report.h"
#include "tactus/cli/commission_run.h"
#include "tactus/daemon/number_within.h"
#include "tactus/record/run_error.h"

/// What commissioning says, and makes of what is typed and of files.
namespace tactus {
namespace {

using test::CommissionFolder;

constexpr int kLiftJoint = 0, kShoulderJoint = 1, kRollJoint = 2;

TEST(CommissionText, NamesNodesOfNobodyAndThoseThatAreMissing) {
  const CommissionFolder folder;
  const Scene scene = folder.scene();
  const std::string text = nodesText(scene, {{0, 1, 0x20192, 0x7ac, 1, {}, {}},
                                             {1, 44, 0x191, {}, {}, {}, {}},
                                             {1, 100, {}, {}, {}, {}, {}}});
  EXPECT_NE(text.find("node 1 on can0"), std::string::npos);
  EXPECT_NE(text.find("drive (402), in the file of lift"), std::string::npos);
  EXPECT_NE(text.find("no 402 device, not in the file"), std::string::npos);
  EXPECT_NE(text.find("has the id of can.master_node_id"), std::string::npos);
  EXPECT_NE(text.find("does not answer, in the file of roll"), std::string::npos);
}

TEST(CommissionText, NamesDrivesThatCannotBeToldALimitOfSpeed) {
  const CommissionFolder folder;
  const Scene scene = folder.scene();
  FoundNode node{0, 1, 0x20192, {}, {}, {}, {}};
  const auto says = [&] { return nodesText(scene, {node}).find("607F") != std::string::npos; };
  EXPECT_TRUE(says());
  node.device_type = 0x191;  // no drive
  EXPECT_FALSE(says());
  node.device_type = 0x20192;
  node.has_speed_limit = true;
  EXPECT_FALSE(says());
}

TEST(CommissionText, StateOfAnotherProgramIsRefused) {
  const CommissionFolder folder;
  const std::string path = statePath(robotFile(folder.scene()));
  for (const char* text : {"", "[]", "{\"joints\": 3}", "{", "\xff"}) {
    folder.put("robot.yaml.commission.json", text);
    EXPECT_THROW(readState(path), InputError) << text;
  }
  for (const char* text :
       {R"({"joints": {"lift": 3}})", R"({"joints": {"lift": {"sign": "x"}}})"}) {
    folder.put("robot.yaml.commission.json", text);
    EXPECT_FALSE(isFinished(folder.scene(), readState(path), kLiftJoint)) << text;
  }
}

/// What was found so far is one of what was there and what is new, also where the power goes
/// between the two: a text that cannot be brought to the disk, here as its name leads elsewhere,
/// takes no place.
TEST(CommissionText, StateIsOnTheDiskBeforeItTakesItsPlace) {
  const CommissionFolder folder;
  const std::string path = statePath(robotFile(folder.scene()));
  const Json before = {{"joints", Json::object()}};
  writeState(path, before);
  std::filesystem::create_symlink("/dev/null", path + ".next");
  EXPECT_THROW(writeState(path, {{"joints", {{"lift", Json::object()}}}}), RunError);
  EXPECT_EQ(readState(path), before);
}

TEST(CommissionText, WhatIsTypedIsUnderstoodOrNot) {
  const CommissionFolder folder;
  const Scene scene = folder.scene();
  Question question;
  question.joint = kShoulderJoint;
  const auto parsed = [&](Asked asked, const char* line) {
    question.asked = asked;
    return parseAnswer(scene, question, line);
  };
  EXPECT_NEAR(parsed(Asked::kPlace, " +90 \r")->value, std::numbers::pi / 2.0, 1e-12);
  EXPECT_NEAR(parsed(Asked::kPlace, "-0.5")->value, -std::numbers::pi / 360.0, 1e-12);
  question.joint = kLiftJoint;
  EXPECT_NEAR(parsed(Asked::kEndPlace, "12.5")->value, 0.0125, 1e-12);
  EXPECT_EQ(parsed(Asked::kDirection, "roll")->joint, kRollJoint);
  for (const char* line : {"", " ", "1e999", "nan", "inf", "1,5", "1 2", "none", "++1", "+-5",
                           "-+5", "--5", "+", "0x10"})
    EXPECT_FALSE(parsed(Asked::kPlace, line)) << line;
  for (const char* line : {"", "Y", "+", "yes yes", "1"})
    EXPECT_FALSE(parsed(Asked::kReady, line)) << line;
  for (const char* line : {"", "yes", "+-", "elbow"})
    EXPECT_FALSE(parsed(Asked::kDirection, line)) << line;
  question.joint = kShoulderJoint;
  question.asked = Asked::kDirection;
  EXPECT_TRUE(expectedText(scene, question).ends_with("name: lift, roll"))
      << expectedText(scene, question);
}

TEST(CommissionText, SaysWhichWayIsPlus) {
  const CommissionFolder folder;
  const Scene scene = folder.scene();
  EXPECT_NE(axisText(scene, kLiftJoint).find("+ slides lift along its axis (0, 0, 1)"),
            std::string::npos)
      << axisText(scene, kLiftJoint);
  EXPECT_NE(axisText(scene, kShoulderJoint).find("along the base's +z"), std::string::npos);
}

/// The least that would do is named, and does. A motion that nobody has to see would be repeated
/// for ever, however exact the places are.
TEST(CommissionText, TravelThatCannotBeMeasuredIsRefused) {
  const CommissionFolder folder;
  const Scene scene = folder.scene();
  const auto refusal = [&](const CommissionOptions& options) -> std::string {
    try {
      commissionConfig(scene, options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  CommissionOptions options;
  options.revolute.max_travel = 0.03;
  options.revolute.measuring_error = 0.001;
  EXPECT_EQ(
      refusal(options),
      "--travel: 0.03 rad is too short to be seen and measured, expected at least 0.0525 rad");
  options.revolute.max_travel = 0.0525;
  EXPECT_EQ(refusal(options), "");
  options.revolute.measuring_error = 0.3 * std::numbers::pi / 180.0;
  const std::string longer = refusal(options);
  EXPECT_TRUE(longer.ends_with("at least 0.07854 rad")) << longer;
  options.revolute.max_travel = 0.07854;
  EXPECT_EQ(refusal(options), "");
  options.revolute.measuring_error = 2.0 * std::numbers::pi / 180.0;
  EXPECT_EQ(
      refusal(options),
      "--error: by 2 deg no motion is long enough to be measured, expected at most 0.38197 deg");
  options.revolute.max_travel = 0.1;
  options.revolute.measuring_error = 0.38197 * std::numbers::pi / 180.0;
  EXPECT_EQ(refusal(options), "");
  options.prismatic.max_travel = 0.002;
  options.prismatic.measuring_error = 1e-4;
  EXPECT_EQ(refusal(options),
            "--slide: 0.002 m is too short to be seen and measured, expected at least 0.003 m");
  options.prismatic.max_travel = 0.003;
  EXPECT_EQ(refusal(options), "");
}

/// By so few counts as the file's divided by the factor, their rounding would be a following error,
/// and any joint looks stuck.
TEST(CommissionText, CountsThatAreTooFewToFollowAMotionAreRefused) {
  const CommissionFolder folder;
  const std::string robot = folder.content("robot.yaml");
  CommissionOptions options;
  const auto refusal = [&](const char* counts) -> std::string {
    folder.put("robot.yaml", test::replaced(robot, "counts_per_rad: 1e6", counts));
    try {
      commissionConfig(folder.scene(), options);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(refusal("counts_per_rad: 652"),
            "--file-factor: by 10 the 652 counts/rad of shoulder are too few to tell whether it "
            "follows a motion, expected at most 6.52");
  EXPECT_EQ(refusal("counts_per_rad: 1000"), "");
  options.file_factor = 6.52;
  EXPECT_EQ(refusal("counts_per_rad: 652"), "");
  EXPECT_TRUE(refusal("counts_per_rad: 149").ends_with("a finer encoder, of 150 counts or more"));
  options.is_scan_alone = true;
  EXPECT_EQ(refusal("counts_per_rad: 149"), "");
}

/// Which of the file's counts it has is not known yet: it is not as far behind as those would say.
TEST(CommissionText, AJointThatDoesNotFollowIsBehindByUpToSoMuch) {
  const CommissionFolder folder;
  JointTrouble trouble{.kind = JointTroubleKind::kStroke, .bus = 0, .node_id = 2};
  trouble.stroke.end = StrokeEnd::kFault;
  trouble.stroke.fault = Fault::kFollowingError;
  trouble.stroke.detail = {0.02, 0.02, "m or rad"};
  const std::string text = troubleText(folder.scene(), kShoulderJoint, trouble);
  EXPECT_NE(text.find("it does not follow, up to 1.146 deg behind the command"), std::string::npos)
      << text;
}

TEST(CommissionText, BoundsThatAreNoNumbersAreRefused) {
  const CommissionFolder folder;
  const Scene scene = folder.scene();
  const double no_number = std::numeric_limits<double>::quiet_NaN();
  const double no_end = std::numeric_limits<double>::infinity();
  for (const double wrong : {no_number, no_end, -no_end, -0.01, 2.0}) {
    for (double MotionBounds::*const bound :
         {&MotionBounds::max_travel, &MotionBounds::max_speed, &MotionBounds::max_acceleration,
          &MotionBounds::max_following_error, &MotionBounds::measuring_error, &MotionBounds::margin,
          &MotionBounds::unseen}) {
      CommissionOptions options;
      options.prismatic.*bound = wrong;
      EXPECT_THROW(commissionConfig(scene, options), InputError) << wrong;
      options = {};
      options.revolute.*bound = wrong;
      EXPECT_THROW(commissionConfig(scene, options), InputError) << wrong;
    }
  }
  for (const double wrong : {no_number, no_end, 0.0, -1.0, 0.5}) {
    CommissionOptions options;
    options.file_factor = wrong;
    EXPECT_THROW(commissionConfig(scene, options), InputError) << wrong;
  }
}

TEST(CommissionText, OptionsTakeNumbersInRangeAlone) {
  const CLI::Validator within = numberWithin(0.1, 2.0);
  for (std::string good : {"0.1", "2", "1e0"}) EXPECT_EQ(within(good), "") << good;
  for (std::string wrong : {"nan", "-nan", "NaN", "inf", "0.09", "2.01", "-1", "", "x"})
    EXPECT_NE(within(wrong), "") << wrong;
}

TEST(CommissionText, DifferenceShowsLinesThatChanged) {
  EXPECT_EQ(differenceText("a\nb\nc\n", "a\nx\nc\nd\n"), "- b\n+ x\n+ d\n");
  EXPECT_EQ(differenceText("a\n", "a\n"), "");
  EXPECT_EQ(differenceText("", "a"), "+ a\n");
}

}  // namespace
}  // namespace tactus
