#include "tactus/record/growing_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <thread>
#include <utility>

#include "tactus/record/ulog_reader.h"

namespace tactus {
namespace {

/// The log's writer leaves its cycles with the kernel every 100 ms.
constexpr std::chrono::milliseconds kPause{20};
/// A writer closes a file once the next one has its name, which may be seen later.
constexpr int kLeftAfter_looks = 50;
constexpr const char* kSignOfTheEnd = "summary.json";

}  // namespace

GrowingFile::GrowingFile(std::string path, std::stop_token stop)
    : path_(std::move(path)), stop_(std::move(stop)) {
  openLog(path_);  // says what is wrong with it
  fd_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
}

GrowingFile::~GrowingFile() {
  if (fd_ >= 0) ::close(fd_);
}

long GrowingFile::fill() { return ::read(fd_, buffer_.data(), buffer_.size()); }

bool GrowingFile::isOther() const {
  struct stat own {
  }, there{};
  if (::fstat(fd_, &own) != 0) return false;
  // While the writer renames its files there may be none.
  return ::stat(path_.c_str(), &there) == 0 && own.st_ino != there.st_ino;
}

bool GrowingFile::isOver() const {
  return std::filesystem::exists(std::filesystem::path(path_).parent_path() / kSignOfTheEnd);
}

/// By its writer, which has not said that the run is over. Of one that nobody was seen to write
/// more may come all the same: another program may copy it.
bool GrowingFile::isLeft() {
  struct flock lock {};
  lock.l_type = F_RDLCK;
  lock.l_whence = SEEK_SET;
  const bool is_written = ::fcntl(fd_, F_OFD_GETLK, &lock) == 0 && lock.l_type == F_WRLCK;
  was_written_ = was_written_ || is_written;
  unwritten_looks_ = was_written_ && !is_written ? unwritten_looks_ + 1 : 0;
  return unwritten_looks_ > kLeftAfter_looks;
}

GrowingFile::int_type GrowingFile::underflow() {
  if (gptr() < egptr()) return traits_type::to_int_type(*gptr());
  while (!stop_.stop_requested()) {
    // What was written before the end is there once the end is seen.
    const bool is_other = isOther(), is_over = isOver() || isLeft();
    const long size = fill();
    if (size > 0) {
      setg(buffer_.data(), buffer_.data(), buffer_.data() + size);
      return traits_type::to_int_type(*gptr());
    }
    is_live_ = true;
    if (size < 0 || is_other || is_over) {
      goes_on_ = is_other;  // also of a run that is over: its last file
      return traits_type::eof();
    }
    std::this_thread::sleep_for(kPause);
  }
  return traits_type::eof();
}

}  // namespace tactus
