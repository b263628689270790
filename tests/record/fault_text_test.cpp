#include "tactus/record/fault_text.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <set>
#include <string>

#include "support/shipped_scene.h"

namespace tactus {
namespace {

FaultReport forceTooLarge() {
  FaultReport report;
  report.fault = Fault::kTactileInvalid;
  report.time_s = 3.214;
  report.detail = {102.5, 100.0, "N"};
  return report;
}

FaultReport ofDrive(Fault fault, const FaultDetail& detail) {
  FaultReport report;
  report.fault = fault;
  report.joint = 4;
  report.detail = detail;
  report.drive.state = DriveState::kOperationEnabled;
  return report;
}

class FaultText : public ::testing::Test {
 protected:
  const Scene scene_ = test::shippedScene("scenario1_null_space");
};

TEST_F(FaultText, TellsTimeValueAndLimit) {
  EXPECT_EQ(faultEvent(forceTooLarge(), scene_),
            "tactile_invalid, at 3.214 s, 102.5 N, at most 100 N");
  ModeReport report;
  static_cast<FaultReport&>(report) = forceTooLarge();
  report.mode = Mode::kHolding;
  EXPECT_EQ(describeMode(report, scene_),
            "holding: tactile_invalid, at 3.214 s, 102.5 N, at most 100 N: a reading not finite, "
            "beyond max_force_N, or of a push far off the cover; reaction: retreat");
  report.fault = Fault::kNone;
  EXPECT_EQ(describeMode(report, scene_), "holding");
}

/// A pause makes drives stop by themselves: else one would look for the fault in the drive.
TEST_F(FaultText, TellsOfAPauseJustBefore) {
  FaultReport report = ofDrive(Fault::kDriveFault, {});
  report.drive.emergency_code = 0x8700;
  report.missed_cycles = 500;
  const std::string text =
      "drive_fault, drive 2 on can1 (joint j5), emergency code 0x8700, operation enabled, after ";
  EXPECT_EQ(faultEvent(report, scene_), text + "500 missed cycles");
  EXPECT_EQ(faultJson(report, scene_).at("missed_cycles"), 500);
  report.missed_cycles = 1;
  EXPECT_EQ(faultEvent(report, scene_), text + "1 missed cycle");
  report.fault = Fault::kOverrun;
  report.joint = -1;
  report.detail = {501.0, 3.0, "cycles"};
  EXPECT_EQ(faultEvent(report, scene_), "overrun, 501 cycles, at most 3 cycles");
}

TEST_F(FaultText, NamesDriveBusAndJoint) {
  const FaultReport report = ofDrive(Fault::kFollowingError, {0.0613, 0.05, "rad"});
  EXPECT_EQ(faultEvent(report, scene_),
            "following_error, drive 2 on can1 (joint j5), operation enabled, 0.0613 rad, at most "
            "0.05 rad")
      << "before the arm has moved it has no time";
  const Json json = faultJson(report, scene_);
  EXPECT_EQ(json.at("joint"), "j5");
  EXPECT_EQ(json.at("bus"), "can1");
  EXPECT_EQ(jsonText(json.at("time_s")), "null\n");
}

TEST_F(FaultText, TellsWhatASilentDriveOwes) {
  const FaultReport report = ofDrive(Fault::kDriveSilent, {6.0, 5.0, "cycles without feedback"});
  EXPECT_EQ(faultEvent(report, scene_),
            "drive_silent, drive 2 on can1 (joint j5), operation enabled, 6 cycles without "
            "feedback, at most 5");
}

TEST_F(FaultText, NamesABus) {
  FaultReport report;
  report.fault = Fault::kBusOff;
  report.bus = 2;
  EXPECT_EQ(faultEvent(report, scene_), "bus_off, can2");
  const Json json = faultJson(report, scene_);
  EXPECT_EQ(json.at("bus"), "can2");
  EXPECT_TRUE(json.at("joint").is_null());
  EXPECT_TRUE(json.at("unit").is_null());
  EXPECT_EQ(jsonText(json.at("value")), "null\n");
}

TEST_F(FaultText, TellsAnEmergencyCodeOnce) {
  FaultReport report = ofDrive(Fault::kDriveFault, {.value = 0x8611, .unit = "emergency code"});
  report.drive.emergency_code = 0x8611;
  EXPECT_EQ(faultEvent(report, scene_),
            "drive_fault, drive 2 on can1 (joint j5), emergency code 0x8611, operation enabled");
  EXPECT_EQ(faultJson(report, scene_).at("value"), 0x8611);
}

TEST(FaultTextOfMoteus, TellsTheFaultCodeAsItsDocumentationDoes) {
  const Scene scene = test::shippedScene("robots/planar2_moteus");
  FaultReport report = ofDrive(Fault::kDriveFault, {.value = 39.0, .unit = "fault code"});
  report.joint = 1;
  report.drive.state = DriveState::kFault;
  report.drive.emergency_code = 39;
  EXPECT_EQ(faultEvent(report, scene).find("drive_fault, drive 2 on can0 (joint "), 0U);
  EXPECT_NE(
      faultEvent(report, scene).find("), fault code 39 (start outside of position limits), fault"),
      std::string::npos)
      << faultEvent(report, scene);
  report.drive.emergency_code = 61;
  EXPECT_NE(faultEvent(report, scene).find("), fault code 61, fault"), std::string::npos)
      << faultEvent(report, scene);
}

TEST(FaultTextOfMoteus, NamesTheRegisterAndWhatIsNaN) {
  const Scene scene = test::shippedScene("robots/planar2_moteus");
  FaultReport report = ofDrive(Fault::kDriveFault, {.value = 0.0, .unit = "fault code"});
  report.joint = 1;
  const auto has = [&](const std::string& text) {
    return faultEvent(report, scene).find(text) != std::string::npos;
  };
  EXPECT_TRUE(has("), its position or velocity is NaN, operation enabled"));
  report.drive.state = DriveState::kFault;
  EXPECT_FALSE(has("NaN"));
  report.fault = Fault::kDriveSetupRefused;
  report.drive.setup_failure = {.index = 1};
  EXPECT_TRUE(has("), register 0x001: no answer, "));
  report.drive.has_state = true;
  EXPECT_TRUE(has("), register 0x001: is NaN, "));
  report.drive.setup_failure = {0x102, 0, 0, true, 4, 5};
  EXPECT_TRUE(has("), register 0x102: is 0x4, expected 0x5, "));
}

TEST_F(FaultText, TellsTheObjectThatADriveRefuses) {
  FaultReport report = ofDrive(Fault::kDriveSetupRefused, {});
  report.drive.setup_failure = {0x60c2, 1, 0x06090030};
  const std::string text = faultEvent(report, scene_);
  EXPECT_NE(text.find(", object 60C2:01: "), std::string::npos) << text;
  report.drive.has_state = true;
  report.drive.setup_failure.abort_code = 0;
  EXPECT_NE(faultEvent(report, scene_).find(", object 60C2:01: no answer, "), std::string::npos);
}

TEST_F(FaultText, OfTheLawNamesTheJointAlone) {
  FaultReport report = ofDrive(Fault::kCommandNotFinite, {});
  EXPECT_EQ(faultEvent(report, scene_), "command_not_finite, joint j5");
  EXPECT_TRUE(faultJson(report, scene_).at("bus").is_null());
}

TEST_F(FaultText, AsJsonHasTheMembersOfTheContract) {
  const Json json = faultJson(forceTooLarge(), scene_);
  std::vector<std::string> keys;
  for (const auto& [key, value] : json.items()) keys.push_back(key);
  EXPECT_EQ(keys,
            (std::vector<std::string>{"name", "time_s", "joint", "bus", "tactile_module", "value",
                                      "limit", "unit", "missed_cycles", "description"}));
  EXPECT_EQ(json.at("name"), "tactile_invalid");
  EXPECT_EQ(json.at("time_s"), 3.214);
  EXPECT_EQ(json.at("value"), 102.5);
  EXPECT_EQ(json.at("limit"), 100.0);
  EXPECT_EQ(json.at("unit"), "N");
  EXPECT_EQ(json.at("description"), describeFault(forceTooLarge(), scene_));
  EXPECT_TRUE(faultJson({}, scene_).is_null());
}

TEST(WayOnText, SaysSomethingOfAllButNothing) {
  std::set<std::string> texts;
  for (int i = 0; i <= static_cast<int>(WaitsFor::kEnableOn); ++i)
    texts.insert(wayOnText({static_cast<WaitsFor>(i), Fault::kTactileStale}, Fault::kDriveSilent));
  EXPECT_EQ(texts.size(), 5u);
  EXPECT_EQ(texts.count(""), 1u);
  EXPECT_EQ(texts.count("tactile_stale to be gone"), 1u);
  EXPECT_EQ(
      wayOnText({WaitsFor::kFaultGone, Fault::kForbiddenSystemCall}, Fault::kForbiddenSystemCall),
      "a new start of the daemon");
}

TEST(WayOnText, SaysFirstThatAnArmHasToBeBack) {
  EXPECT_EQ(
      wayOnText({WaitsFor::kEnableOff}, Fault::kNotAtStart),
      "the arm to be back where it is expected, and the enable line to be switched off, then on");
  EXPECT_EQ(wayOnText({WaitsFor::kEnableOn}, Fault::kNotAtStart),
            "the arm to be back where it is expected, and the enable line to be switched on");
  EXPECT_EQ(wayOnText({}, Fault::kNotAtStart), "");
}

}  // namespace
}  // namespace tactus
