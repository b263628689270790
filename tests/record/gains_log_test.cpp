#include <gtest/gtest.h>

#include <cstring>
#include <set>

#include "support/telemetry.h"
#include "tactus/record/ulog_format.h"
#include "tactus/record/ulog_topic.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

/// Messages of a log, headers included.
std::vector<std::string> messagesOf(const std::string& log) {
  std::vector<std::string> messages;
  for (std::size_t at = kUlogHeaderSize; at < log.size(); at += messages.back().size()) {
    std::uint16_t size = 0;
    std::memcpy(&size, log.data() + at, sizeof(size));
    messages.push_back(log.substr(at, kMessageHeaderSize + size));
  }
  return messages;
}

bool isGains(const std::string& message) {
  const bool is_data = message[2] == 'D' && message[3] == 1 && message[4] == 0;
  const bool is_subscription = message[2] == 'A' && message.ends_with(kGainsTopic);
  return is_data || is_subscription || message.find("F" + std::string(kGainsTopic) + ":") == 2;
}

/// The log without what `is_left_out` tells.
template <typename Predicate>
std::string without(const std::string& log, const Predicate& is_left_out) {
  std::string rest = log.substr(0, kUlogHeaderSize);
  for (const std::string& message : messagesOf(log)) {
    if (!is_left_out(message)) rest += message;
  }
  return rest;
}

/// Ten cycles each with other gains.
std::vector<CycleRecord> tunedRecords() {
  std::mt19937_64 random(7);
  std::vector<CycleRecord> records;
  for (int i = 0; i < 50; ++i) {
    records.push_back(test::randomRecord(random));
    records.back().gains.force.damping = 0.5 + 0.1 * (i / 10);
    records.back().gains.task.wait_beyond_m = i < 20 ? kNoLimit : 0.05;
  }
  return records;
}

TEST(GainKeys, AreEveryWordOfGainsOnce) {
  const std::vector<GainKey>& keys = gainKeys();
  ASSERT_EQ(keys.size(), sizeof(Gains) / sizeof(double));
  std::set<std::string> names;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    EXPECT_EQ(keys[i].offset, 8 * i) << keys[i].path;
    EXPECT_TRUE(names.insert(gainFieldName(keys[i].path)).second) << keys[i].path;
  }
  EXPECT_TRUE(names.contains("controller_transition_distance_m"));
}

TEST(GainsLog, ComesBackToTheBitAndIsWrittenWhereItChanges) {
  const std::vector<CycleRecord> records = tunedRecords();
  const std::string log = test::writeLog(test::smallDescription(), records);
  const auto read = test::readLog(log);
  ASSERT_EQ(read.records.size(), records.size());
  for (std::size_t i = 0; i < records.size(); ++i)
    ASSERT_TRUE(isSame(read.records[i].gains, records[i].gains)) << i;
  const std::vector<std::string> messages = messagesOf(log);
  EXPECT_EQ(std::ranges::count_if(messages, isGains), 2 + 5) << "format, subscription, 5 changes";
}

TEST(GainsLog, OfAnOlderVersionLeavesThemAsAssumed) {
  const std::string log =
      without(test::writeLog(test::smallDescription(), tunedRecords()), isGains);
  std::istringstream in(log);
  UlogReader reader(in, "run.ulg");
  Gains assumed;
  assumed.force.damping = 0.75;
  reader.assumeGains(assumed);
  CycleRecord record;
  int cycles = 0;
  for (; reader.next(record); ++cycles) ASSERT_TRUE(isSame(record.gains, assumed));
  EXPECT_EQ(cycles, 50);
}

TEST(GainsLog, CyclesWithoutTheirGainsAreRefused) {
  const std::string log =
      without(test::writeLog(test::smallDescription(), tunedRecords()),
              [](const std::string& message) { return message[2] == 'D' && isGains(message); });
  try {
    test::readLog(log);
    FAIL() << "read";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("its gains are expected before it"), std::string::npos)
        << error.what();
  }
}

TEST(GainsLog, CutOffWithinGainsIsReadUpToThere) {
  const std::string log = test::writeLog(test::smallDescription(), tunedRecords());
  std::size_t at = kUlogHeaderSize;
  int gains = 0;
  for (const std::string& message : messagesOf(log)) {
    gains += message[2] == 'D' && isGains(message);
    if (gains == 3) break;
    at += message.size();
  }
  const auto read = test::readLog(log.substr(0, at + 50));
  EXPECT_TRUE(read.cut_off);
  EXPECT_EQ(read.records.size(), 20u);
}

}  // namespace
}  // namespace tactus
