#include <fmt/format.h>
#include <gtest/gtest.h>

#include <random>

#include "support/telemetry.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

constexpr std::size_t kLostSector_bytes = 512;

/// A log of some cycles, and what a loss of power makes of it.
struct LoggedCycles {
  static constexpr std::size_t kCycles = 12;

  LoggedCycles() {
    std::mt19937_64 random(21);
    for (std::size_t i = 0; i < kCycles; ++i) records.push_back(test::randomRecord(random));
    bytes = test::writeLog(test::smallDescription(), records);
    cycle_bytes = logBytesACycle(test::smallDescription().shape);
    first = bytes.size() - kCycles * cycle_bytes;
  }

  std::string withZerosFrom(std::size_t place, std::size_t further = 1500) const {
    return bytes.substr(0, place) + std::string(bytes.size() - place + further, '\0');
  }

  std::vector<CycleRecord> records;
  std::string bytes;
  std::size_t cycle_bytes = 0, first = 0;
};

std::string refusalOf(const std::string& bytes) {
  try {
    test::readLog(bytes);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

/// A cycle of which a part is lost would be read as one with zeros in it.
TEST(LostZeros, AreTheEndOfALogAndTakeTheCycleThatTheyBeginIn) {
  const LoggedCycles log;
  const std::size_t first_sector = (log.first / kLostSector_bytes + 1) * kLostSector_bytes;
  int places = 0;
  for (std::size_t place = first_sector; place < log.bytes.size(); place += kLostSector_bytes) {
    const auto read = test::readLog(log.withZerosFrom(place));
    EXPECT_TRUE(read.cut_off) << place;
    EXPECT_EQ(read.records.size(), (place - log.first) / log.cycle_bytes) << place;
    ++places;
  }
  EXPECT_GE(places, 8);
}

/// It ends with its sector, so that the zeros behind it are those of others.
TEST(LostZeros, TakeTheCycleWhoseLastSectorIsLostWhole) {
  LogDescription description = test::smallDescription();
  description.shape = {16, 6};
  std::mt19937_64 random(22);
  std::vector<CycleRecord> records;
  for (int i = 0; i < 2000; ++i) records.push_back(test::randomRecord(random));
  const std::string bytes = test::writeLog(description, records);
  const std::size_t cycle_bytes = logBytesACycle(description.shape);
  ASSERT_GT(cycle_bytes, kLostSector_bytes + 3);
  std::size_t end = bytes.size();
  std::size_t whole = records.size();
  for (; whole > 0 && end % kLostSector_bytes != 0; --whole) end -= cycle_bytes;
  ASSERT_GT(whole, 0u) << "or no cycle ends with a sector";
  const std::size_t place = end - kLostSector_bytes;
  const auto read = test::readLog(bytes.substr(0, place) + std::string(bytes.size() - place, '\0'));
  EXPECT_TRUE(read.cut_off);
  EXPECT_EQ(read.records.size(), whole - 1);
}

TEST(LostZeros, BehindAWholeCycleTakeNone) {
  const LoggedCycles log;
  for (const std::size_t further : {1, 2, 3, 4, 100'000}) {
    const auto read = test::readLog(log.withZerosFrom(log.bytes.size(), further));
    EXPECT_TRUE(read.cut_off) << further;
    EXPECT_EQ(read.records.size(), LoggedCycles::kCycles) << further;
  }
}

TEST(LostZeros, AreDamageWhereAnythingIsBehindThem) {
  const LoggedCycles log;
  const std::string refusal =
      fmt::format("run.ulg:1:{}: message: unknown type 0x00, an undamaged log is expected",
                  log.bytes.size() + 1);
  const std::string zeros = log.withZerosFrom(log.bytes.size());
  EXPECT_EQ(refusalOf(zeros + "D"), refusal);
  EXPECT_EQ(refusalOf(zeros + log.bytes.substr(log.first)), refusal);
  const std::size_t place = (log.first / kLostSector_bytes + 2) * kLostSector_bytes;
  EXPECT_NE(refusalOf(log.withZerosFrom(place) + "x").find("unknown type 0x00"), std::string::npos);
}

/// The zeros at the end of whole cycles are their values, wherever a sector ends.
TEST(LostZeros, AreNotTakenForThoseThatACycleHolds) {
  std::vector<CycleRecord> records(200);
  for (CycleRecord& record : records) record.t_s = 1.0;
  const auto read = test::readLog(test::writeLog(test::smallDescription(), records));
  EXPECT_FALSE(read.cut_off);
  EXPECT_EQ(read.records.size(), records.size());
}

TEST(LostZeros, InTheDefinitionsLeaveNoLog) {
  const LoggedCycles log;
  EXPECT_NE(refusalOf(log.withZerosFrom(kLostSector_bytes)).find("the log ends here"),
            std::string::npos);
  EXPECT_NE(refusalOf(std::string(5000, '\0')).find("header: not a ULog"), std::string::npos);
}

}  // namespace
}  // namespace tactus
