#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tactus/daemon/output_file.h"
#include "tactus/daemon/record_fields.h"
#include "tactus/daemon/scene.h"

namespace tactus {

/// What a log says before its first cycle.
struct LogDescription {
  RecordShape shape;
  /// Names of a-z A-Z 0-9 _ - / only, each once; a dot in a parameter's name becomes a slash.
  std::vector<std::pair<std::string, std::string>> infos;
  /// For the reader at a plot: the format holds them as float. The exact values are in `sources`.
  std::vector<std::pair<std::string, double>> parameters;
  std::vector<SourceFile> sources;
  std::vector<Override> overrides;
};

/// The description of a run of `scene`; `parameters` are its numeric values by dotted name.
LogDescription describeLog(const Scene& scene,
                           std::vector<std::pair<std::string, double>> parameters);

/// Writes cycles to a ULog file. A log cut off anywhere is readable up to the cut.
class UlogWriter {
 public:
  /// Throws InputError if `path` cannot be opened, RunError if it cannot be written.
  UlogWriter(const std::string& path, const LogDescription& description);

  /// Copies the record into a buffer and writes that out when it is full, about every 2000 cycles.
  /// Throws RunError if it cannot be written.
  void write(const CycleRecord& record);

  /// Writes what is left; throws RunError. A log that was not closed may have lost its end.
  void close() { file_.close(); }

 private:
  void writeDefinitions(const LogDescription& description);
  void writeFormat(const RecordShape& shape);
  void writeInfo(std::string_view name, std::string_view value);
  void writeMultiInfo(std::string_view name, std::string_view value);
  void writeParameter(std::string name, double value);
  void writeMessage(char type, std::string_view payload);

  OutputFile file_;
  std::vector<CopyRun> runs_;  ///< from a record to a data message, header included
  std::size_t data_size_;      ///< of a data message, header included, bytes
};

}  // namespace tactus
