#include <gtest/gtest.h>

#include <random>

#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

using test::loggedWords;
using test::randomRecord;
using test::readLog;
using test::smallDescription;
using test::writeLog;

std::vector<CycleRecord> randomRecords(int count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<CycleRecord> records;
  for (int i = 0; i < count; ++i) records.push_back(randomRecord(random));
  return records;
}

void expectPrefix(const std::vector<CycleRecord>& read, const std::vector<CycleRecord>& written,
                  const RecordShape& shape) {
  ASSERT_LE(read.size(), written.size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_EQ(loggedWords(read[i], shape), loggedWords(written[i], shape)) << i;
  }
}

TEST(Ulog, KeepsEveryBitOfEveryShape) {
  for (int joints = 2; joints <= kMaxJoints; ++joints) {
    for (int task_size = 1; task_size <= kMaxTaskSize; ++task_size) {
      LogDescription description = smallDescription();
      description.shape = {joints, task_size, task_size % 2 == 0, 1 + joints % 8};
      const auto records = randomRecords(5, static_cast<unsigned>(joints * 10 + task_size));
      const auto log = readLog(writeLog(description, records));
      EXPECT_EQ(log.description.shape, description.shape);
      EXPECT_EQ(log.records.size(), records.size());
      EXPECT_FALSE(log.cut_off);
      expectPrefix(log.records, records, description.shape);
    }
  }
}

TEST(Ulog, KeepsMoreCyclesThanItsBufferHolds) {
  const auto records = randomRecords(5000, 1);
  LogDescription description = smallDescription();
  description.shape = {16, 6};
  const auto log = readLog(writeLog(description, records));
  EXPECT_EQ(log.records.size(), records.size());
  expectPrefix(log.records, records, description.shape);
}

TEST(Ulog, KeepsSourcesAndOverridesExactly) {
  LogDescription description = smallDescription();
  std::string text(200000, '\0');
  std::mt19937_64 random(3);
  for (char& c : text) c = static_cast<char>(random());
  description.sources = {{"a b/\xc3\xa9.yaml", text},
                         {"empty.yaml", ""},
                         {"c", text.substr(0, 32768)},
                         {"d", text.substr(0, 32769)},
                         {"e", text.substr(0, 65536)}};
  description.overrides = {{"a.b", "1"}, {"a.b", ""}, {"c", "[1, 2]"}};
  const LogDescription read = readLog(writeLog(description, {})).description;
  ASSERT_EQ(read.sources.size(), description.sources.size());
  for (std::size_t i = 0; i < read.sources.size(); ++i) {
    EXPECT_EQ(read.sources[i].path, description.sources[i].path);
    EXPECT_TRUE(read.sources[i].text == description.sources[i].text) << i;
  }
  ASSERT_EQ(read.overrides.size(), 3u);
  EXPECT_EQ(read.overrides[1].key, "a.b");
  EXPECT_EQ(read.overrides[1].value, "");
  EXPECT_EQ(read.overrides[2].value, "[1, 2]");
}

TEST(Ulog, HoldsInfosAndParametersByAllowedNames) {
  const LogDescription read = readLog(writeLog(smallDescription(), {})).description;
  const std::pair<std::string, std::string> expected_info{"ver_sw", "1.2.3"};
  EXPECT_EQ(std::count(read.infos.begin(), read.infos.end(), expected_info), 1);
  ASSERT_EQ(read.parameters.size(), 2u);
  EXPECT_EQ(read.parameters[0].first, "controller/time_constant_s");
  EXPECT_EQ(read.parameters[0].second, static_cast<double>(0.1f));
  EXPECT_EQ(read.parameters[1].first, "a/b/0/12");
  EXPECT_EQ(read.parameters[1].second, -2.5);
}

TEST(Ulog, SaysWhatItsNumbersMean) {
  const LogDescription read = readLog(writeLog(smallDescription(), {})).description;
  const auto has = [&read](const std::string& name, const std::string& value) {
    return std::count(read.infos.begin(), read.infos.end(), std::pair{name, value}) == 1;
  };
  EXPECT_TRUE(has("fault/0", "none"));
  EXPECT_TRUE(has("fault/1", "tactile_invalid"));
  EXPECT_TRUE(has("fault/21", "forbidden_system_call"));
  EXPECT_TRUE(has("mode/0", "boot"));
  EXPECT_TRUE(has("mode/7", "off"));
  EXPECT_TRUE(has("unit/q", "m or rad"));
}

TEST(Ulog, NamesJointsAndComponentsOfTheScene) {
  const Scene scene = test::shippedScene("free_motion", {{"task.components", "[x, rz, ry]"}});
  const LogDescription description = describeLog(scene);
  EXPECT_EQ(description.shape, (RecordShape{9, 3, true}));
  const auto has = [&description](const std::string& name, const std::string& value) {
    return std::count(description.infos.begin(), description.infos.end(), std::pair{name, value}) ==
           1;
  };
  EXPECT_TRUE(has("joint/9", scene.joint_names[8]));
  EXPECT_TRUE(has("component/1", "x"));
  EXPECT_TRUE(has("component/2", "rz"));
  EXPECT_TRUE(has("component/3", "ry"));
}

TEST(Ulog, HasARotationErrorOnlyOfATaskWithOne) {
  LogDescription description = smallDescription();
  const std::string name = "tool_rotation_error_rad";
  EXPECT_EQ(writeLog(description, {}).find(name), std::string::npos);
  description.shape.has_rotation = true;
  EXPECT_NE(writeLog(description, {}).find("double " + name + ";"), std::string::npos);
  EXPECT_EQ(recordColumns(description.shape).back().name, name);
}

TEST(Ulog, HasAMomentAboutTheAxisOnlyOfModulesThatTellIt) {
  LogDescription description = smallDescription();
  const std::string name = "tactile_moment_x_Nm";
  EXPECT_EQ(writeLog(description, {}).find(name), std::string::npos);
  description.shape.has_moment_x = true;
  EXPECT_NE(writeLog(description, {}).find("double " + name + ";"), std::string::npos);
  EXPECT_EQ(recordColumns(description.shape).back().name, name);
  description.shape.modules = 3;
  EXPECT_NE(writeLog(description, {}).find("double[3] " + name + ";"), std::string::npos);
  EXPECT_EQ(recordColumns(description.shape).back().name, name + "_3");
}

TEST(Ulog, HasWhatIsLostOnlyOfARobotThatGoesOnWithoutIt) {
  LogDescription description = smallDescription();
  EXPECT_EQ(writeLog(description, {}).find("modules_lost"), std::string::npos);
  description.shape.has_loss = true;
  const std::string bytes = writeLog(description, {});
  EXPECT_NE(bytes.find("uint64_t modules_lost;double speed_share;"), std::string::npos);
  EXPECT_EQ(recordColumns(description.shape).back().name, "speed_share");
}

/// Every byte of a small log, written down from the specification.
TEST(Ulog, WritesTheBytesOfTheSpecification) {
  LogDescription description;
  description.shape = {2, 1};
  CycleRecord record;
  record.t_s = 0.25;
  const std::string bytes = writeLog(description, {record});
  const auto startsAt = [&bytes](std::size_t at, const std::string& expected) {
    return bytes.compare(at, expected.size(), expected) == 0;
  };
  using namespace std::string_literals;
  EXPECT_TRUE(startsAt(0, "ULog\x01\x12\x35\x01\0\0\0\0\0\0\0\0"s));
  EXPECT_TRUE(startsAt(16, "\x28\0B"s + std::string(40, '\0')));
  const std::string format =
      "cycle:uint64_t timestamp;double t_s;double force_sensor_N;double contact_position_m;"
      "double contact_dir_x;double contact_dir_y;double contact_dir_z;double force_contact_N;"
      "double stiffness_N_per_m;double stiffness_raw_N_per_m;double gamma;double k_n;double k_j;"
      "double k_t;double x_dot_eff_m_per_s;double u_n;double u_j;double u_t;double[2] q;"
      "double[2] dq;double[1] w;double[1] wd;double[1] wd_dot;uint64_t fault;"
      "int64_t wake_latency_ns;int64_t step_ns;double[2] q_measured;double tactile_force_y_N;"
      "double tactile_force_z_N;double tactile_moment_y_Nm;double tactile_moment_z_Nm;"
      "uint64_t tactile_sequence;double tool_error_x_m;double tool_error_y_m;"
      "double tool_error_z_m;double task_time_s;uint64_t mode;int64_t read_ns;int64_t write_ns;"
      "uint64_t missed_cycles;"
      "double path_time_s;";
  const std::string format_size{static_cast<char>(format.size() & 0xff),
                                static_cast<char>(format.size() >> 8)};
  EXPECT_TRUE(startsAt(59, format_size + "F" + format));
  EXPECT_TRUE(startsAt(62 + format.size(),
                       "\x17\0I\x10"
                       "char[6] sys_nametactus"s));
  const std::size_t data_size = 2 + 8 + 8 * (17 + 2 + 2 + 3 + 3 + 2 + 5 + 3 + 5 + 1);
  const std::size_t data_start = bytes.size() - data_size - 3;
  EXPECT_TRUE(startsAt(data_start - logBytesOfSides(description) - 11, "\x08\0A\0\0\0cycle"s));
  const std::string timestamp_250000_us = "\x90\xd0\x03\0\0\0\0\0"s;
  const std::string quarter_as_double = "\0\0\0\0\0\0\xd0\x3f"s;
  EXPECT_TRUE(startsAt(data_start,
                       "\x62\x01"
                       "D\0\0"s +
                           timestamp_250000_us + quarter_as_double));
  EXPECT_EQ(data_size, 0x162u);
}

TEST(Ulog, WritesInfoMultiInfoAndParameterAsSpecified) {
  using namespace std::string_literals;
  const std::string bytes = writeLog(smallDescription(), {});
  const auto contains = [&bytes](const std::string& part) {
    return bytes.find(part) != std::string::npos;
  };
  EXPECT_TRUE(
      contains("\x14\0I\x0e"
               "char[5] ver_sw1.2.3"s));
  EXPECT_TRUE(
      contains("\x27\0M\0\x14"
               "char[17] source_pathscenes/small.yaml"s));
  EXPECT_TRUE(
      contains("\x1e\0M\0\x13"
               "char[9] source_textrobot: r\n"s));
  EXPECT_TRUE(
      contains("\x25\0P\x20"
               "float controller/time_constant_s\xcd\xcc\xcc\x3d"s));
}

TEST(Ulog, CutAnywhereItReadsUpToTheCut) {
  const auto records = randomRecords(3, 7);
  const RecordShape shape = smallDescription().shape;
  const std::string bytes = writeLog(smallDescription(), records);
  const std::size_t message_size = logBytesACycle(shape);
  const std::size_t definitions_size = writeLog(smallDescription(), {}).size();
  const std::size_t first = bytes.size() - 3 * message_size;  // before it come the gains
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::string cut = bytes.substr(0, size);
    if (size < definitions_size) {
      EXPECT_THROW(readLog(cut), InputError) << size;
      continue;
    }
    const auto log = readLog(cut);
    const bool is_whole =
        size == definitions_size || (size >= first && (size - first) % message_size == 0);
    EXPECT_EQ(log.records.size(), size < first ? 0 : (size - first) / message_size) << size;
    EXPECT_EQ(log.cut_off, !is_whole) << size;
    expectPrefix(log.records, records, shape);
  }
}

TEST(Ulog, DoesNotTakeDamageForACut) {
  const std::string bytes = writeLog(smallDescription(), randomRecords(3, 8));
  const std::size_t message_size = logBytesACycle(smallDescription().shape);
  const std::size_t second = bytes.size() - 2 * message_size;
  for (const std::size_t at : {second, second + 1, second + 2}) {
    for (int value = 0; value < 256; ++value) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(value);
      if (damaged == bytes) continue;
      // A message of another type that format allows is passed over, as the format demands.
      const bool is_allowed =
          at == second + 2 && std::string("FIMPQARLCSO").find(damaged[at]) != std::string::npos;
      if (is_allowed) {
        EXPECT_EQ(readLog(damaged).records.size(), 2u);
      } else {
        EXPECT_THROW(readLog(damaged), InputError) << at - second << ' ' << value;
      }
    }
  }
}

/// Reads or throws InputError of one line; nothing else is allowed.
void expectReadOrRefused(const std::string& bytes) {
  try {
    readLog(bytes);
  } catch (const InputError& error) {
    const std::string line = error.what();
    EXPECT_EQ(line.compare(0, 10, "run.ulg:1:"), 0) << line;
    EXPECT_EQ(line.find('\n'), std::string::npos) << line;
  }
}

TEST(Ulog, SurvivesAnyByteAtAnyPlaceOfTheDefinitions) {
  const std::string bytes = writeLog(smallDescription(), randomRecords(1, 9));
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const int value : {0x00, 0x01, 0x20, 0x3b, 0x41, 0x5b, 0x7f, 0x80, 0xff}) {
      std::string damaged = bytes;
      damaged[at] = static_cast<char>(value);
      expectReadOrRefused(damaged);
    }
  }
}

TEST(Ulog, SurvivesRandomDamage) {
  std::mt19937_64 random(11);
  const std::string bytes = writeLog(smallDescription(), randomRecords(4, 10));
  for (int trial = 0; trial < 20000; ++trial) {
    std::string damaged = bytes;
    for (std::uint64_t i = 0; i < 1 + random() % 8; ++i) {
      damaged[random() % damaged.size()] = static_cast<char>(random());
    }
    if (random() % 3 == 0) damaged.erase(random() % damaged.size(), random() % 40);
    if (random() % 3 == 0) damaged.insert(random() % damaged.size(), random() % 40, '[');
    expectReadOrRefused(damaged);
  }
}

TEST(Ulog, ReportsAFullDisk) {
  const auto records = randomRecords(2000, 12);
  LogDescription description = smallDescription();
  description.shape = {16, 6};
  EXPECT_THROW(
      {
        UlogWriter writer("/dev/full", description);
        for (const CycleRecord& record : records) writer.write(record);
      },
      RunError);
  UlogWriter writer("/dev/full", description);
  EXPECT_THROW(writer.flush(), RunError);
  UlogWriter another("/dev/full", description);
  EXPECT_THROW(another.close(), RunError);
}

TEST(Ulog, ReportsAPathThatCannotBeOpened) {
  EXPECT_THROW(UlogWriter("/nowhere/run.ulg", smallDescription()), InputError);
  EXPECT_THROW(openLog("/nowhere/run.ulg"), InputError);
  EXPECT_THROW(openLog("/dev/null"), InputError) << "no regular file, as a fifo";
  EXPECT_THROW(checkLog("/tmp"), InputError);
}

TEST(Ulog, KnowsItsSizeAndHandsItOverWhenAsked) {
  const test::TemporaryFile file;
  UlogWriter writer(file.path(), smallDescription());
  EXPECT_EQ(writer.size(), logDefinitions(smallDescription()).size());
  for (const CycleRecord& record : randomRecords(3, 14)) writer.write(record);
  EXPECT_EQ(file.content().size(), 0u);
  writer.flush();
  EXPECT_EQ(file.content().size(), writer.size());
  EXPECT_EQ(readLog(file.content()).records.size(), 3u);
}

TEST(Ulog, ALogLeftByAnErrorIsReadable) {
  const auto records = randomRecords(3, 13);
  const test::TemporaryFile file;
  {
    UlogWriter writer(file.path(), smallDescription());
    for (const CycleRecord& record : records) writer.write(record);
  }
  EXPECT_EQ(readLog(file.content()).records.size(), 3u);
}

}  // namespace
}  // namespace tactus
