#pragma once

#include <string>
#include <vector>

#include "tactus/record/output_file.h"
#include "tactus/record/record_fields.h"

namespace tactus {

/// Lines of a CSV file. Numbers are the shortest decimals that read back bit for bit; there is a
/// nan and an inf, as Python, numpy and strtod read them.
class CsvWriter {
 public:
  /// "-" is standard output. Errors as of OutputFile.
  explicit CsvWriter(const std::string& path) : file_(path) {}

  void add(std::string_view text);
  void add(double number);
  void add(std::int64_t number);
  void add(std::uint64_t number);

  /// The value of a column of `record`.
  void add(const CycleRecord& record, const RecordColumn& column);

  void endLine();
  void close() { file_.close(); }

 private:
  template <typename Number>
  void addNumber(Number number);

  OutputFile file_;
  std::string line_;
};

}  // namespace tactus
