#pragma once

#include <string>

namespace tactus {

/// The e-stop line for whoever moves the real one: a file that holds 1 or 0, or a FIFO.
class EmergencyStopFile {
 public:
  /// Not pressed at first. Without a path it is no file, and takes all. Throws std::runtime_error
  /// where it cannot be opened, or is something else than such a file: what is in it may be wanted.
  explicit EmergencyStopFile(const std::string& path);
  ~EmergencyStopFile();
  EmergencyStopFile(const EmergencyStopFile&) = delete;
  EmergencyStopFile& operator=(const EmergencyStopFile&) = delete;

  /// False: it cannot be written.
  bool write(bool is_pressed) noexcept;

 private:
  int descriptor_ = -1;
};

}  // namespace tactus
