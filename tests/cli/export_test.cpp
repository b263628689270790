#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <random>
#include <sstream>

#include "support/command_run.h"
#include "support/telemetry.h"
#include "tactus/cli/commands.h"
#include "tactus/record/csv_export.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::istringstream in(text);
  for (std::string part; std::getline(in, part, separator);) parts.push_back(part);
  return parts;
}

struct Export {
  test::TemporaryFile log{".ulg"}, csv{".csv"};
  std::vector<CycleRecord> records;
  RecordShape shape{9, 3};

  explicit Export(int count) {
    std::mt19937_64 random(1);
    for (int i = 0; i < count; ++i) records.push_back(test::randomRecord(random));
    LogDescription description;
    description.shape = shape;
    log.setContent(test::writeLog(description, records));
  }
};

int run(const std::vector<std::string>& arguments) {
  std::string output;
  return test::runCommand(addExportCommand, arguments, output);
}

TEST(Export, EveryNumberReadsBackToTheBit) {
  const Export e(50);
  exportCsv(e.log.path(), e.csv.path());
  const auto lines = split(e.csv.content(), '\n');
  ASSERT_EQ(lines.size(), e.records.size() + 1);
  const auto columns = recordColumns(e.shape);
  for (std::size_t i = 0; i < e.records.size(); ++i) {
    const auto cells = split(lines[i + 1], ',');
    const auto words = test::loggedWords(e.records[i], e.shape);
    ASSERT_EQ(cells.size(), words.size() + 2);
    for (std::size_t k = 0; k < words.size(); ++k) {
      std::uint64_t word;
      if (columns[k].type == FieldType::kDouble) {
        const double number = std::strtod(cells[k].c_str(), nullptr);
        double expected;
        std::memcpy(&expected, &words[k], 8);
        if (std::isnan(expected)) {
          EXPECT_TRUE(std::isnan(number)) << cells[k];
          continue;
        }
        std::memcpy(&word, &number, 8);
      } else if (columns[k].type == FieldType::kInt64) {
        word = static_cast<std::uint64_t>(std::strtoll(cells[k].c_str(), nullptr, 10));
      } else {
        word = std::strtoull(cells[k].c_str(), nullptr, 10);
      }
      EXPECT_EQ(word, words[k]) << columns[k].name << ": " << cells[k];
    }
  }
}

TEST(Export, HeaderNamesTheColumns) {
  const Export e(1);
  exportCsv(e.log.path(), e.csv.path());
  const auto header = split(split(e.csv.content(), '\n')[0], ',');
  const auto columns = recordColumns(e.shape);
  ASSERT_EQ(header.size(), columns.size() + 2);
  EXPECT_EQ(header.front(), "t_s");
  EXPECT_EQ(header[columns.size() - 1], "path_time_s");
  EXPECT_EQ(header[columns.size()], "fault_name");
  EXPECT_EQ(header.back(), "mode_name");
}

TEST(Export, NamesFaultAndMode) {
  Export e(3);
  const std::uint64_t numbers[][2] = {{1, 4}, {21, 7}, {22, 0xffffffffffffffff}};
  for (int i = 0; i < 3; ++i) {
    e.records[i].fault = numbers[i][0];
    e.records[i].mode = numbers[i][1];
  }
  LogDescription description;
  description.shape = e.shape;
  e.log.setContent(test::writeLog(description, e.records));
  exportCsv(e.log.path(), e.csv.path());
  const auto lines = split(e.csv.content(), '\n');
  EXPECT_TRUE(lines[1].ends_with(",tactile_invalid,holding"));
  EXPECT_TRUE(lines[2].ends_with(",forbidden_system_call,off"));
  EXPECT_TRUE(lines[3].ends_with(",unknown,unknown"));
}

TEST(Export, LeavesOutWhatTheLogDoesNotHave) {
  const Export e(1);
  std::string bytes = e.log.content();
  bytes.replace(bytes.find("missed_cycles"), 13, "something_new");
  e.log.setContent(bytes);
  exportCsv(e.log.path(), e.csv.path());
  const std::string header = split(e.csv.content(), '\n')[0];
  EXPECT_EQ(header.find("missed_cycles"), std::string::npos);
  EXPECT_TRUE(header.ends_with(",path_time_s,fault_name,mode_name"));
}

TEST(Export, CommandExportsACutLogUpToTheCut) {
  const Export e(5);
  std::string bytes = e.log.content();
  bytes.resize(bytes.size() - 1);
  e.log.setContent(bytes);
  EXPECT_EQ(run({"export", e.log.path(), "-o", e.csv.path()}), kExitDone);
  EXPECT_EQ(split(e.csv.content(), '\n').size(), 5u);
}

TEST(Export, ADamagedLogLeavesNoFile) {
  const Export e(5);
  std::string bytes = e.log.content();
  const std::size_t message_size = 3 + 2 + 8 + 8 * recordColumns(e.shape).size();
  bytes[bytes.size() - message_size + 2] = 'x';
  e.log.setContent(bytes);
  EXPECT_THROW(run({"export", e.log.path(), "-o", e.csv.path()}), InputError);
  EXPECT_FALSE(std::filesystem::exists(e.csv.path()));
}

TEST(Export, RefusesToOverwriteItsLog) {
  const Export e(1);
  const std::string before = e.log.content();
  EXPECT_THROW(run({"export", e.log.path(), "-o", e.log.path()}), InputError);
  EXPECT_EQ(e.log.content(), before);
}

TEST(Export, ReportsAFullDisk) {
  const Export e(1);
  EXPECT_THROW(run({"export", e.log.path(), "-o", "/dev/full"}), RunError);
}

}  // namespace
}  // namespace tactus
