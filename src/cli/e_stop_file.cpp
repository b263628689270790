#include "tactus/cli/e_stop_file.h"

#include <errno.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <stdexcept>
#include <string_view>
#include <system_error>

namespace tactus {
namespace {

constexpr const char* kPressed = "1\n";
constexpr const char* kReleased = "0\n";

/// A FIFO, a new file, or one that was such a file before.
bool isForStops(int descriptor) {
  struct stat file {};
  if (fstat(descriptor, &file) != 0) return false;
  if (S_ISFIFO(file.st_mode)) return true;
  if (!S_ISREG(file.st_mode)) return false;
  char bytes[3];
  const ssize_t size = pread(descriptor, bytes, sizeof bytes, 0);
  if (size < 0) return false;
  const std::string_view content(bytes, static_cast<std::size_t>(size));
  return content.empty() || content == kPressed || content == kReleased;
}

}  // namespace

EmergencyStopFile::EmergencyStopFile(const std::string& path) {
  if (path.empty()) return;
  // For reading too: a FIFO can then be opened before its reader.
  descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_NONBLOCK | O_CLOEXEC, 0644);
  if (descriptor_ < 0)
    throw std::system_error(errno, std::system_category(),
                            path + ": the file for the e-stop can't be opened");
  if (!isForStops(descriptor_)) {
    close(descriptor_);
    throw std::runtime_error(path +
                             ": holds something else than an e-stop's 0 or 1, expected a FIFO, a "
                             "new file, or one of an earlier plant");
  }
  write(false);
}

EmergencyStopFile::~EmergencyStopFile() {
  if (descriptor_ >= 0) close(descriptor_);
}

bool EmergencyStopFile::write(bool is_pressed) noexcept {
  if (descriptor_ < 0) return true;
  lseek(descriptor_, 0, SEEK_SET);  // a FIFO has no start, and needs none
  return ::write(descriptor_, is_pressed ? kPressed : kReleased, 2) == 2;
}

}  // namespace tactus
