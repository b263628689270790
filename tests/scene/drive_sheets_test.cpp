#include "tactus/scene/drive_sheets.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/eds_text.h"
#include "support/hardware_files.h"

namespace tactus {
namespace {

/// The robot with two buses, whose drives have data sheets.
struct SheetFiles {
  test::SceneFiles files = test::hardwareFiles();
  std::vector<SourceFile> sheets{{"drive.eds", test::edsText()}};

  SheetFiles() { files.robot = test::replaced(files.robot, ", bit_rate_per_s: 9e5", ""); }

  void give(const std::string& more) {
    files.robot = test::replaced(files.robot, "drives:\n", "drives:\n" + more);
  }
  std::vector<SourceFile> sources() const {
    std::vector<SourceFile> all = files.sources();
    all.insert(all.end(), sheets.begin(), sheets.end());
    return all;
  }
  std::string error() const { return test::loadError(sources()); }
  HardwareConfig load() const { return loadScene(sources(), {}).hardware.value(); }
};

TEST(DriveSheets, TellWhichNodeItHasToBe) {
  SheetFiles robot;
  EXPECT_FALSE(robot.load().drives[0].vendor_id);
  robot.give("  eds: drive.eds\n");
  for (const DriveConfig& drive : robot.load().drives) {
    EXPECT_EQ(drive.vendor_id, 0x7ACu);
    EXPECT_EQ(drive.product_code, 1u);
    EXPECT_EQ(drive.transmit_pdos, 6) << "1805 is the last one";
    EXPECT_TRUE(drive.has_quick_stop_option);
  }
}

TEST(DriveSheets, AreOneADriveWhereItHasItsOwn) {
  SheetFiles robot;
  std::string other =
      test::withEdsLine(test::edsText(), "1018sub2", "DefaultValue", "DefaultValue=7");
  other = test::withEdsLine(other, "DeviceInfo", "ProductNumber", "ProductNumber=7");
  robot.sheets.push_back({"other.eds", other});
  robot.sheets.push_back({"odd.yaml", "source: here\nwithout: [quick_stop_option, speed_limit]\n"});
  robot.give("  eds: drive.eds\n  profile: odd.yaml\n");
  robot.files.robot =
      test::replaced(robot.files.robot, "counts_per_m: 1e7", "counts_per_m: 1e7, eds: other.eds");
  const std::vector<DriveConfig> drives = robot.load().drives;
  EXPECT_EQ(drives[0].product_code, 7u);
  EXPECT_EQ(drives[1].product_code, 1u);
  for (const DriveConfig& drive : drives)
    EXPECT_FALSE(drive.has_quick_stop_option || drive.has_speed_limit);
}

TEST(DriveSheets, AreAmongTheSourcesOnceEach) {
  SheetFiles robot;
  robot.give("  eds: drive.eds\n");
  const Scene scene = loadScene(robot.sources(), {});
  ASSERT_EQ(scene.sources.size(), 4u);
  EXPECT_EQ(scene.sources[2].path, "drive.eds");
  EXPECT_EQ(scene.sources.back().path, "robot.urdf");
  EXPECT_EQ(loadScene(scene.sources, {}).hardware->drives[0].vendor_id, 0x7ACu) << "as of a log";
}

TEST(DriveSheets, MayBeInLatin1) {
  SheetFiles robot;
  robot.give("  eds: drive.eds\n");
  robot.sheets[0].text =
      test::withEdsLine(robot.sheets[0].text, "DeviceInfo", "VendorName", "VendorName=M\xFCller");
  const Scene scene = loadScene(robot.sources(), {});
  EXPECT_NE(scene.sources[2].text.find("M\xC3\xBCller"), std::string::npos) << "kept as UTF-8";
  EXPECT_EQ(loadScene(scene.sources, {}).sources[2].text, scene.sources[2].text);
  robot.sheets[0].text[5] = '\0';
  EXPECT_NE(robot.error().find("drive.eds:1:6: drives.eds: byte 0x00 is no text"),
            std::string::npos)
      << robot.error();
}

TEST(DriveSheets, MayBeNoLargerThanAnyFile) {
  SheetFiles robot;
  robot.give("  eds: drive.eds\n");
  robot.sheets[0].text = "; " + std::string(600000, '\xFC') + "\n" + robot.sheets[0].text;
  EXPECT_NE(robot.error().find("drive.eds: is larger than 1 MiB"), std::string::npos)
      << "as UTF-8 it would be: " << robot.error();
}

TEST(DriveSheets, AreRefusedWhereTheyAreWrong) {
  SheetFiles robot;
  robot.give("  eds: gone.eds\n");
  EXPECT_EQ(robot.error().find("robot.yaml:12:8: drives.eds: gone.eds: "), 0u) << robot.error();
  robot = {};
  robot.give("  eds: drive.eds\n");
  robot.sheets[0].text =
      test::withEdsLine(robot.sheets[0].text, "60FF", "PDOMapping", "PDOMapping=0");
  EXPECT_EQ(robot.error().find("drive.eds:"), 0u) << robot.error();
  EXPECT_NE(robot.error().find("60FF.PDOMapping: cannot be mapped to RPDO1, expected 1 (for the "
                               "scene scene.yaml)"),
            std::string::npos)
      << robot.error();
}

TEST(DriveSheets, ContradictNeitherThemselves) {
  const auto errorWith = [](const char* section, const char* key, const char* line) {
    SheetFiles robot;
    robot.give("  eds: drive.eds\n");
    robot.sheets[0].text = test::withEdsLine(robot.sheets[0].text, section, key, line);
    return robot.error();
  };
  EXPECT_NE(errorWith("1018sub1", "DefaultValue", "DefaultValue=0x7AD")
                .find("1018sub1.DefaultValue: 0x7ad is not DeviceInfo.VendorNumber = 0x7ac"),
            std::string::npos);
  EXPECT_NE(errorWith("DeviceInfo", "VendorNumber", "VendorNumber=0x100000000")
                .find("DeviceInfo.VendorNumber: '0x100000000' is no number"),
            std::string::npos);
  EXPECT_EQ(errorWith("1018sub2", "DefaultValue", "DefaultValue=0"), "") << "which says nothing";
  EXPECT_NE(errorWith("1018sub1", "DefaultValue", "DefaultValue=0x7AG")
                .find("1018sub1.DefaultValue: '0x7AG' is no number, expected a whole number, or"),
            std::string::npos);
  EXPECT_NE(errorWith("1018sub2", "DefaultValue", "DefaultValue=$NODEID+1")
                .find("1018sub2.DefaultValue: differs with the node id, expected one number"),
            std::string::npos);
  EXPECT_NE(errorWith("OptionalObjects", "1", "1=0x1806")
                .find(": 1806: the object is listed and has no section"),
            std::string::npos)
      << "and its frames would be in no bus's load";
}

TEST(DriveProfile, IsASourceAndAListOfWords) {
  const auto parse = [](const std::string& text) {
    return parseDriveProfile({"odd.yaml", text}).has_quick_stop_option;
  };
  EXPECT_TRUE(parse("source: its manual\n"));
  EXPECT_FALSE(parse("source: its manual\nwithout: [quick_stop_option]\n"));
  const DriveProfile both = parseDriveProfile(
      {"odd.yaml", "source: its manual\nwithout: [velocity_unit, quick_stop_option]\n"});
  EXPECT_FALSE(both.has_velocity_unit || both.has_quick_stop_option);
  EXPECT_TRUE(both.has_speed_limit);
  EXPECT_TRUE(parse("source: its manual\nwithout: [velocity_unit]\n"));
  const auto error = [&](const std::string& text) -> std::string {
    try {
      parse(text);
    } catch (const InputError& problem) {
      return problem.what();
    }
    return "";
  };
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"", "odd.yaml:1:1: -: "},
      {"[]", "odd.yaml:1:1: -: "},
      {"without: [quick_stop_option]\n", "odd.yaml:1:1: source: is missing"},
      {"source: ''\n", "odd.yaml:1:9: source: "},
      {"source: [1]\n", "odd.yaml:1:9: source: "},
      {"source: x\nwith: 1\n", "odd.yaml:2:1: with: unknown key"},
      {"source: x\nwithout: quick_stop_option\n", "odd.yaml:2:10: without: "},
      {"source: x\nwithout: []\n", "odd.yaml:2:10: without: "},
      {"source: x\nwithout: [heartbeat]\n", "odd.yaml:2:11: without[0]: "},
      {"source: x\nwithout: [quick_stop_option, quick_stop_option]\n",
       "odd.yaml:2:30: without[1]: 'quick_stop_option' is given twice"},
  };
  for (const auto& [text, begin] : wrong)
    EXPECT_EQ(error(text).substr(0, begin.size()), begin) << error(text);
}

TEST(DriveProfile, ThatShipsIsRead) {
  SheetFiles robot;
  robot.sheets.push_back({"profile.yaml", ""});
  std::ostringstream text;
  text << std::ifstream(TACTUS_SOURCE_DIR "/config/profiles/zeroerr_edriver.yaml").rdbuf();
  robot.sheets.back().text = text.str();
  robot.give("  profile: profile.yaml\n");
  EXPECT_FALSE(robot.load().drives[0].has_quick_stop_option);
}

}  // namespace
}  // namespace tactus
