#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactus/record/output_file.h"
#include "tactus/record/record_fields.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What a log says before its first cycle.
struct LogDescription {
  RecordShape shape;
  bool has_commands = false;  ///< the task is by command, and its motion logged
  /// Names of a-z A-Z 0-9 _ - / only, each once.
  std::vector<std::pair<std::string, std::string>> infos;
  /// For the reader at a plot: the format holds them as float, and a.b[0] as a/b/0. The exact
  /// values are in `sources`.
  std::vector<std::pair<std::string, double>> parameters;
  std::vector<SourceFile> sources;
  std::vector<Override> overrides;
};

LogDescription describeLog(const Scene& scene);

/// What a log begins with, up to its first cycle.
std::string logDefinitions(const LogDescription& description);

/// What a log grows by each cycle.
std::size_t logBytesACycle(const RecordShape& shape);

/// And before the first cycle of a file; later less, where something of it has changed.
std::size_t logBytesOfSides(const LogDescription& description);

/// Writes cycles to a ULog file. A log cut off anywhere is readable up to the cut.
class UlogWriter {
 public:
  /// Throws InputError if `path` cannot be opened, RunError if it cannot be written.
  UlogWriter(const std::string& path, const LogDescription& description);

  /// Copies the record into a buffer and writes that out when it is full, about every 500 cycles.
  /// Throws RunError if it cannot be written.
  void write(const CycleRecord& record);

  /// What the log would grow by, bytes.
  std::size_t sizeOf(const CycleRecord& record) const noexcept;

  /// Writes out what is in the buffer; throws RunError.
  void flush() { file_.flush(); }

  /// As OutputFile::rename().
  void rename(const std::string& from, const std::string& to) { file_.rename(from, to); }

  /// As OutputFile::requireName().
  void requireName() const { file_.requireName(); }

  /// Of the log so far, bytes.
  std::uint64_t size() const noexcept { return file_.size(); }

  /// Writes what is left; throws RunError. A log that was not closed may have lost its end.
  void close() { file_.close(); }

 private:
  bool isOther(const CycleRecord& record, int side) const noexcept;
  char* beginData(std::uint16_t id, std::size_t size, double t_s);

  OutputFile file_;
  std::vector<CopyRun> runs_;  ///< from a record to a data message, header included
  std::size_t data_size_;      ///< of a data message, header included, bytes
  bool has_commands_;
  bool has_sides_ = false;  ///< written any
  CycleRecord sides_;       ///< of which the parts of side topics are as written at last
};

}  // namespace tactus
