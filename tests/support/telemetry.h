#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "tactus/record/record_fields.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/record/ulog_writer.h"

/// Records, logs and files for the tests of telemetry.
namespace tactus::test {

/// A file of this test alone, removed at the end.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& suffix = "") {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    std::string name = std::string(test->test_suite_name()) + "." + test->name() + suffix;
    std::replace(name.begin(), name.end(), '/', '_');  // of parameterised tests
    path_ = ::testing::TempDir() + name;
  }
  ~TemporaryFile() { std::filesystem::remove(path_); }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::string& path() const { return path_; }

  std::string content() const {
    std::ifstream in(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  void setContent(const std::string& bytes) const {
    std::ofstream(path_, std::ios::binary) << bytes;
  }

 private:
  std::string path_;
};

/// Any bits: NaNs with payload, denormals, negative zeros, infinities; the gains are as always.
inline CycleRecord randomRecord(std::mt19937_64& random) {
  CycleRecord record;
  const std::uint64_t special[] = {0x8000000000000000, 1,
                                   0x7ff0000000000000, 0xfff0000000000000,
                                   0x7ff0000000000001, 0xfff8dead0000beef,
                                   0x000fffffffffffff};
  char* const bytes = reinterpret_cast<char*>(&record);
  for (std::size_t offset = 0; offset < offsetof(CycleRecord, gains); offset += 8) {
    const std::uint64_t word = random() % 4 == 0 ? special[random() % 7] : random();
    std::memcpy(bytes + offset, &word, 8);
  }
  return record;
}

/// All words that a log of this shape holds.
inline std::vector<std::uint64_t> loggedWords(const CycleRecord& record, const RecordShape& shape) {
  std::vector<std::uint64_t> words;
  for (const RecordColumn& column : recordColumns(shape)) {
    words.push_back(0);
    std::memcpy(&words.back(), reinterpret_cast<const char*>(&record) + column.offset, 8);
  }
  return words;
}

inline LogDescription smallDescription() {
  LogDescription description;
  description.shape = {2, 1};
  description.infos = {{"ver_sw", "1.2.3"}, {"scene", "small"}};
  description.parameters = {{"controller.time_constant_s", 0.1}, {"a.b[0][12]", -2.5}};
  description.sources = {{"scenes/small.yaml", "robot: r\n"}, {"r.yaml", ""}};
  description.overrides = {{"controller.damping", "0.7"}};
  return description;
}

inline std::string writeLog(const LogDescription& description,
                            const std::vector<CycleRecord>& records) {
  const TemporaryFile file(".writeLog");
  UlogWriter writer(file.path(), description);
  for (const CycleRecord& record : records) writer.write(record);
  writer.close();
  return file.content();
}

struct ReadLog {
  LogDescription description;
  std::vector<CycleRecord> records;
  bool cut_off = false;
};

/// Throws InputError as the reader does.
inline ReadLog readLog(const std::string& bytes) {
  std::istringstream in(bytes);
  UlogReader reader(in, "run.ulg");
  ReadLog log;
  log.description = reader.description();
  CycleRecord record;
  while (reader.next(record)) log.records.push_back(record);
  log.cut_off = reader.cutOff();
  return log;
}

}  // namespace tactus::test
