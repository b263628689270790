#include "tactus/record/csv_export.h"

#include "tactus/record/csv_writer.h"
#include "tactus/record/ulog_reader.h"

namespace tactus {
namespace {

constexpr std::uint64_t kCyclesBetweenReports = 1000;

/// Of a number from a log, which may be any.
template <typename Enum>
std::string_view nameOf(std::uint64_t number, std::size_t count, const char* (*name)(Enum)) {
  return number < count ? name(static_cast<Enum>(number)) : "unknown";
}

}  // namespace

void exportCsv(const std::string& log_path, const std::string& csv_path,
               const std::function<void(std::uint64_t cycles)>& progress) {
  refuseOverwriting(log_path, csv_path);
  std::ifstream in = openLog(log_path);
  UlogReader reader(in, log_path);
  CsvWriter csv(csv_path);
  std::vector<RecordColumn> columns = recordColumns(reader.description().shape);
  std::erase_if(columns, [&](const RecordColumn& column) { return !reader.has(column.field); });
  for (const RecordColumn& column : columns) csv.add(column.name);
  csv.add("fault_name");
  csv.add("mode_name");
  csv.endLine();
  CycleRecord record;
  for (std::uint64_t cycles = 0; reader.next(record); ++cycles) {
    if (progress && cycles % kCyclesBetweenReports == 0) progress(cycles);
    for (const RecordColumn& column : columns) csv.add(record, column);
    csv.add(nameOf(record.fault, faultTable().size(), faultName));
    csv.add(nameOf(record.mode, kModeCount, modeName));
    csv.endLine();
  }
  csv.close();
}

}  // namespace tactus
