#include "tactus/scene/eds_check.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/eds_text.h"
#include "support/scene_files.h"

namespace tactus {
namespace {

struct SheetCase {
  DriveConfig drive{};
  BusConfig bus{"can0", 1e6};
  CanopenConfig canopen{};
  double period_s = 0.001;

  std::string error(const std::string& text) const {
    try {
      checkEds(parseEds({"drive.eds", text}), drive, bus, canopen, period_s);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
};

/// A line of the sheet that is replaced, and what it is then refused for: at that line, by that
/// key.
struct WrongLine {
  std::string_view section, key, line;
  std::string_view problem, expectation;
};

void PrintTo(const WrongLine& wrong, std::ostream* stream) {
  *stream << wrong.section << " " << wrong.line;
}

class WrongSheet : public testing::TestWithParam<WrongLine> {};

TEST_P(WrongSheet, IsRefusedAtItsLine) {
  const WrongLine& wrong = GetParam();
  const std::string eds = test::edsText();
  const std::string error =
      SheetCase{}.error(test::withEdsLine(eds, wrong.section, wrong.key, wrong.line));
  const std::string place =
      fmt::format("drive.eds:{}:1: {}.{}: ", test::edsLineOf(eds, wrong.section, wrong.key),
                  wrong.section, wrong.key);
  test::expectError(error, {"", "", place, wrong.problem, wrong.expectation});
}

INSTANTIATE_TEST_SUITE_P(
    Device, WrongSheet,
    testing::Values(
        WrongLine{"DeviceInfo", "BaudRate_1000", "BaudRate_1000=0", "1000 kbit/s of can0", "1,"},
        WrongLine{"DeviceInfo", "BaudRate_1000", "BaudRate_1000=x", "'x' is no number", "0 or 1"},
        WrongLine{"DeviceInfo", "NrOfRXPDO", "NrOfRXPDO=0", "no such PDO", "1 or more"},
        WrongLine{"DeviceInfo", "NrOfTXPDO", "NrOfTXPDO=0", "no such PDO", "1 or more"},
        WrongLine{"DeviceInfo", "NrOfRXPDO", "NrOfRXPDO=5", "none is described beyond 1403",
                  "most 4"},
        WrongLine{"DeviceInfo", "NrOfRXPDO", "NrOfRXPDO=200", "200 PDOs, and none", "most 4"},
        WrongLine{"DeviceInfo", "NrOfTXPDO", "NrOfTXPDO=7", "none is described beyond 1805",
                  "most 6"},
        WrongLine{"DeviceInfo", "NrOfTXPDO", "NrOfTXPDO=513", "513 PDOs", "at most 6"},
        WrongLine{"DeviceInfo", "Granularity", "Granularity=0", "cannot be changed", "1 to 16"},
        WrongLine{"DeviceInfo", "Granularity", "Granularity=64", "maps no 16 bits", "1 to 16"},
        WrongLine{"6502", "DefaultValue", "DefaultValue=0xA5", "mode 9", "bit 8 set"},
        WrongLine{"1000", "DefaultValue", "DefaultValue=0x191", "401 is another device", "402"}));

INSTANTIATE_TEST_SUITE_P(
    Entries, WrongSheet,
    testing::Values(
        WrongLine{"6040", "PDOMapping", "PDOMapping=0", "to RPDO1", "1"},
        WrongLine{"60FF", "PDOMapping", "PDOMapping=0", "to RPDO1", "1"},
        WrongLine{"6041", "PDOMapping", "PDOMapping=0", "to TPDO1", "1"},
        WrongLine{"6064", "PDOMapping", "PDOMapping=0x0", "to TPDO1", "1"},
        WrongLine{"60FF", "AccessType", "AccessType=ro", "received by a PDO", "rw, rww or wo"},
        WrongLine{"60FF", "AccessType", "AccessType=rwr", "received by a PDO", "rw, rww or wo"},
        WrongLine{"6064", "AccessType", "AccessType=wo", "sent by a PDO", "ro, rw or rwr"},
        WrongLine{"6064", "AccessType", "AccessType=rww", "sent by a PDO", "ro, rw or rwr"},
        WrongLine{"60FF", "DataType", "DataType=0x0003", "signed 16 bit", "signed type of 32"},
        WrongLine{"60FF", "DataType", "DataType=0x0007", "unsigned 32 bit", "signed type of 32"},
        WrongLine{"6064", "DataType", "DataType=0x0015", "signed 64 bit", "signed type of 32"},
        WrongLine{"6041", "DataType", "DataType=0x0007", "unsigned 32 bit", "a type of 16"},
        WrongLine{"1600sub0", "AccessType", "AccessType=ro", "cannot be written", "rw"},
        WrongLine{"1A00sub2", "AccessType", "AccessType=const", "cannot be written", "rw"},
        WrongLine{"1400sub1", "AccessType", "AccessType=wo", "cannot be read", "ro or rw"},
        WrongLine{"1400sub1", "AccessType", "AccessType=ro", "cannot be written", "rw"},
        WrongLine{"605E", "AccessType", "AccessType=ro", "cannot be written", "rw"},
        WrongLine{"6061", "AccessType", "AccessType=wo", "cannot be read", "ro or rw"},
        WrongLine{"6060", "HighLimit", "HighLimit=6", "below the 9", "at least 9"},
        WrongLine{"1017", "HighLimit", "HighLimit=10", "below the 20", "at least 20"},
        WrongLine{"6060", "HighLimit", "HighLimit=0xG", "'0xG' is no number", "or nothing"},
        WrongLine{"6060", "LowLimit", "LowLimit=1.5", "'1.5' is no number", "or nothing"},
        WrongLine{"60C2sub1", "DefaultValue", "DefaultValue=1 ms", "'1 ms' is no number",
                  "whole"}));

/// A limit of an entry whose default value is not said.
class WrongLimit : public testing::TestWithParam<WrongLine> {};

TEST_P(WrongLimit, IsRefusedAtItsLine) {
  const WrongLine& wrong = GetParam();
  std::string eds =
      test::withEdsLine(test::edsText(), wrong.section, "DefaultValue", "DefaultValue=");
  const bool is_there = test::hasEdsLine(eds, wrong.section, wrong.key);
  eds = test::withEdsLine(eds, wrong.section, is_there ? wrong.key : "DefaultValue", wrong.line);
  const std::string place =
      fmt::format("drive.eds:{}:1: {}.{}: ", test::edsLineOf(eds, wrong.section, wrong.key),
                  wrong.section, wrong.key);
  test::expectError(SheetCase{}.error(eds), {"", "", place, wrong.problem, wrong.expectation});
}

INSTANTIATE_TEST_SUITE_P(
    Entries, WrongLimit,
    testing::Values(
        WrongLine{"60FF", "LowLimit", "LowLimit=1", "above the 0 needed", "at most 0"},
        WrongLine{"60FF", "HighLimit", "HighLimit=-1", "below the 0 needed", "at least 0"},
        WrongLine{"60FF", "LowLimit", "LowLimit=100\nHighLimit=-100", "above HighLimit = -100",
                  "at most that"},
        WrongLine{"6064", "LowLimit", "LowLimit=0\nHighLimit=0xFFFFFFFF", "above HighLimit = -1",
                  "at most that"},
        WrongLine{"6040", "HighLimit", "HighLimit=15", "below the 128 needed", "at least 128"},
        WrongLine{"6040", "LowLimit", "LowLimit=2", "above the 0 needed", "at most 0"},
        WrongLine{"1401sub1", "HighLimit", "HighLimit=0x7FF", "below the 2147483648", "at least"},
        WrongLine{"605A", "LowLimit", "LowLimit=5", "above the 2", "at most 2"},
        WrongLine{"60C2sub2", "HighLimit", "HighLimit=0xFC", "below the -3", "at least -3"},
        WrongLine{"60C2sub2", "LowLimit", "LowLimit=-2", "above the -3", "at most -3"}));

TEST(EdsCheck, WantsADefaultValueWithinItsLimits) {
  const std::string sheet = test::edsText();
  const auto errorOf = [&](const char* lines) {
    return SheetCase{}.error(test::withEdsLine(sheet, "60FF", "DefaultValue", lines));
  };
  EXPECT_NE(errorOf("DefaultValue=11\nLowLimit=-10\nHighLimit=10")
                .find("60FF.DefaultValue: 11 is above HighLimit = 10, expected at most that"),
            std::string::npos);
  EXPECT_NE(errorOf("DefaultValue=0xFFFFFFF5\nLowLimit=-10\nHighLimit=10")
                .find("60FF.DefaultValue: -11 is below LowLimit = -10, expected at least that"),
            std::string::npos);
  EXPECT_EQ(errorOf("DefaultValue=-10\nLowLimit=-10\nHighLimit=10"), "");
  EXPECT_EQ(errorOf("DefaultValue=$NODEID+11\nHighLimit=10"), "") << "which is not known here";
  const std::string off =
      test::withEdsLine(sheet, "1400sub2", "DefaultValue", "DefaultValue=0\nLowLimit=1");
  EXPECT_EQ(SheetCase{}.error(off), "") << "0 says nothing";
}

/// Wherever its end is lost: at the object that is not there any more, or in a line that is half.
TEST(EdsCheck, RefusesASheetThatIsCutOff) {
  const std::string eds = test::edsText();
  const std::size_t last = eds.find("\n[6502]\n");
  ASSERT_NE(last, std::string::npos);
  for (std::size_t end = eds.find('\n'); end <= last; end = eds.find('\n', end + 1))
    EXPECT_NE(SheetCase{}.error(eds.substr(0, end + 1)), "") << eds.substr(0, end).size();
  const std::string error = SheetCase{}.error(eds.substr(0, last + 1));
  const std::string place =
      fmt::format("drive.eds:{}:1: 6502: ", test::edsLineOf(eds, "OptionalObjects", "22"));
  EXPECT_EQ(error, place +
                       "the object is listed and has no section, expected [6502], or a file "
                       "that is whole");
}

TEST(EdsCheck, AcceptsADriveThatFits) {
  EXPECT_EQ(SheetCase{}.error(test::edsText()), "");
  std::string windows;
  for (const char c : test::edsText()) windows += c == '\n' ? "\r\n" : std::string(1, c);
  EXPECT_EQ(SheetCase{}.error(windows), "");
}

TEST(EdsCheck, MissesWhatTheSetUpNeedsAndNothingElse) {
  const std::string eds = test::edsText();
  const auto errorWithout = [&](const char* section) {
    return SheetCase{}.error(test::withoutEdsSection(eds, section));
  };
  for (const char* const needed : {"1000", "1016", "1017", "1400", "1600", "1800", "1A00", "6040",
                                   "6041", "605A", "6060", "6061", "6064", "60C2", "60FF"}) {
    const std::string error = SheetCase{}.error(test::withoutEdsObject(eds, needed));
    EXPECT_NE(error.find(": " + std::string(needed)), std::string::npos) << needed << error;
    EXPECT_NE(error.find("the drive does not have it, expected it"), std::string::npos) << error;
  }
  // What is not in the list either is not there; what is in it alone is half a file.
  for (const char* const optional : {"6007", "605E", "6502", "1401", "1801"}) {
    EXPECT_EQ(SheetCase{}.error(test::withoutEdsObject(eds, optional)), "") << optional;
    EXPECT_NE(errorWithout(optional).find("is listed and has no section"), std::string::npos);
  }
  for (const char* const unused : {"1001", "1018", "1005"})
    EXPECT_EQ(errorWithout(unused), "") << unused;
  EXPECT_NE(errorWithout("DeviceInfo").find("the section is missing"), std::string::npos);
}

TEST(EdsCheck, LeavesOutWhatTheProfileLeavesOut) {
  SheetCase sheet;
  sheet.drive.has_quick_stop_option = false;
  EXPECT_EQ(sheet.error(test::withoutEdsSection(test::edsText(), "605A")), "");
}

/// Object 607F is written for what it may be good for: a drive may refuse it.
TEST(EdsCheck, LeavesOutWhatADriveMayRefuse) {
  SheetCase sheet;
  sheet.drive.max_velocity = 1e3;
  const std::string with_limit =
      test::edsText() +
      "\n[607F]\nParameterName=Max profile velocity\nObjectType=7\nDataType=5\n"
      "AccessType=ro\nDefaultValue=9\nLowLimit=0\nHighLimit=9\nPDOMapping=0\n";
  EXPECT_EQ(sheet.error(test::edsText()), "");
  EXPECT_EQ(sheet.error(with_limit), "");
}

TEST(EdsCheck, LooksAtBitRateAndCycleOfThisRobot) {
  SheetCase sheet;
  sheet.bus.bit_rate_per_s = 5e5;
  EXPECT_EQ(sheet.error(test::edsText()), "");
  sheet.bus.bit_rate_per_s = 8e5;
  EXPECT_NE(sheet.error(test::edsText()).find("800 kbit/s of can0"), std::string::npos);
  sheet.bus.bit_rate_per_s = 9e5;
  EXPECT_NE(sheet.error(test::edsText()).find("no drive has the 900000 bit/s"), std::string::npos);
  sheet.bus.bit_rate_per_s = 1e6;
  const std::string only_1_ms =
      test::withEdsLine(test::edsText(), "60C2sub1", "PDOMapping", "LowLimit=1\nHighLimit=1");
  EXPECT_EQ(sheet.error(only_1_ms), "");
  sheet.period_s = 0.002;
  EXPECT_NE(sheet.error(only_1_ms).find("60C2sub1.HighLimit: is below the 2 needed"),
            std::string::npos);
}

/// Drives of one unit for the period, or of one period, are fit where it is the right one.
TEST(EdsCheck, TakesAPeriodThatCannotBeWrittenWhereItIsTheOne) {
  SheetCase sheet;
  std::string eds = test::edsText();
  for (const char* section : {"60C2sub1", "60C2sub2"})
    eds = test::withEdsLine(eds, section, "AccessType", "AccessType=ro");
  EXPECT_EQ(sheet.error(eds), "");
  EXPECT_EQ(sheet.error(test::withEdsLine(eds, "60C2sub1", "DefaultValue", "DefaultValue=")), "");
  const std::string in_100_us =
      test::withEdsLine(eds, "60C2sub2", "DefaultValue", "DefaultValue=-4");
  EXPECT_NE(sheet.error(in_100_us).find("60C2sub2.AccessType: cannot be written"),
            std::string::npos);
  sheet.period_s = 0.002;
  EXPECT_NE(sheet.error(eds).find("60C2sub1.AccessType: cannot be written"), std::string::npos);
}

TEST(EdsCheck, AsksForNoMoreThanTheSheetSays) {
  std::string eds = test::edsText();
  eds = test::withEdsLine(eds, "6502", "DefaultValue", "DefaultValue=");
  eds = test::withEdsLine(eds, "1000", "DefaultValue", "DefaultValue=0");
  eds = test::withEdsLine(eds, "6060", "HighLimit", "HighLimit=");
  eds = test::withEdsLine(eds, "605A", "HighLimit", "HighLimit=$NODEID+1");
  eds = test::withEdsLine(eds, "1400sub5", "AccessType", "AccessType=ro");
  // Where it says what is not so, and nothing comes of it.
  eds = test::withEdsLine(eds, "60FF", "ParameterName", ";");
  eds = test::withEdsLine(eds, "DeviceInfo", "NrOfRXPDO", "NrOfRXPDO=1");
  eds = test::withEdsLine(eds, "1018sub3", "DefaultValue", "DefaultValue=9\nHighLimit=8");
  eds = test::withEdsLine(eds, "1600sub2", "DefaultValue", "DefaultValue=0x20000040");
  eds = test::withEdsLine(eds, "1600sub0", "DefaultValue", "DefaultValue=0\nLowLimit=-128");
  eds = test::withEdsLine(eds, "60C2sub1", "DefaultValue", "DefaultValue=1 ; ms\nLowLimit=;none");
  EXPECT_EQ(SheetCase{}.error(eds), "");
}

}  // namespace
}  // namespace tactus
