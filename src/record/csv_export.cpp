#include "tactus/record/csv_export.h"

#include "tactus/record/csv_writer.h"
#include "tactus/record/ulog_reader.h"

namespace tactus {

void exportCsv(const std::string& log_path, const std::string& csv_path) {
  refuseOverwriting(log_path, csv_path);
  std::ifstream in = openLog(log_path);
  UlogReader reader(in, log_path);
  CsvWriter csv(csv_path);
  std::vector<RecordColumn> columns = recordColumns(reader.description().shape);
  std::erase_if(columns, [&](const RecordColumn& column) { return !reader.has(column.field); });
  for (const RecordColumn& column : columns) csv.add(column.name);
  csv.endLine();
  CycleRecord record;
  while (reader.next(record)) {
    for (const RecordColumn& column : columns) csv.add(record, column);
    csv.endLine();
  }
  csv.close();
}

}  // namespace tactus
