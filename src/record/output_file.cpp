#include "tactus/record/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

#include "tactus/record/run_error.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

/// A file of a name of its own beside another, which is gone at the end unless it took its place.
class Successor {
 public:
  /// With this text, for the file at path; a link stays one. It is gone as well if it cannot be
  /// written: the other constructor has made it by then.
  Successor(const std::string& path, const std::string& text)
      : Successor(std::filesystem::canonical(path).string()) {
    OutputFile file(path_);
    file.append(text);
    file.close();
  }

  ~Successor() {
    ::close(descriptor_);
    if (!path_.empty()) ::unlink(path_.c_str());
  }
  Successor(const Successor&) = delete;
  Successor& operator=(const Successor&) = delete;

  const std::string& path() const noexcept { return path_; }
  const std::string& target() const noexcept { return target_; }

  /// With owner and rights of who was there. On the disk before it has the name: a loss of power
  /// leaves the one or the other.
  void takePlace() {
    struct stat before {};
    expect(::stat(target_.c_str(), &before) == 0);
    // Also of root's sudo; nobody else may give a file away, but to a group of his.
    const bool is_given = ::fchown(descriptor_, before.st_uid, before.st_gid) == 0 ||
                          (errno == EPERM && ::fchown(descriptor_, -1, before.st_gid) == 0);
    const bool may_all_read = (before.st_mode & S_IROTH) != 0;
    expect(is_given || (errno == EPERM && may_all_read));
    expect(::fchmod(descriptor_, before.st_mode & 07777) == 0);
    expect(::fsync(descriptor_) == 0);
    expect(std::rename(path_.c_str(), target_.c_str()) == 0);
    path_.clear();
  }

 private:
  explicit Successor(std::string target)
      : target_(std::move(target)),
        path_(target_ + ".XXXXXX"),
        descriptor_(::mkostemp(path_.data(), O_CLOEXEC)) {
    if (descriptor_ < 0)
      failAt(beginOf(target_), "-", fmt::format("cannot be replaced: {}", std::strerror(errno)),
             "expected a file in a folder that can be written");
  }

  void expect(bool is_done) const {
    if (!is_done)
      throw RunError(
          fmt::format("{}: cannot be replaced: {}", escaped(target_), std::strerror(errno)));
  }

  std::string target_, path_;
  int descriptor_;
};

/// Another file, not what was there before: that may be another user's.
void keepBeside(const std::string& path) {
  std::error_code error;
  std::filesystem::remove(path + "~", error);
  if (!error) std::filesystem::copy_file(path, path + "~", error);
  if (error)
    throw RunError(fmt::format("{}~: cannot be written: {}", escaped(path), error.message()));
}

}  // namespace

OutputFile::OutputFile(const std::string& path)
    : path_(path == "-" ? "standard output" : escaped(path)),
      descriptor_(path == "-"
                      ? ::dup(STDOUT_FILENO)
                      : ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)),
      buffer_(new char[kBufferSize]) {
  if (descriptor_ < 0) {
    failAt(beginOf(path_), "-",
           fmt::format("cannot be opened for writing: {}", std::strerror(errno)),
           "expected a path that can be written");
  }
}

OutputFile::~OutputFile() {
  try {
    close();
  } catch (const RunError&) {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
}

void OutputFile::append(std::string_view bytes) {
  while (!bytes.empty()) {
    const std::size_t size = std::min(bytes.size(), kBufferSize);
    std::memcpy(reserve(size), bytes.data(), size);
    commit(size);
    bytes.remove_prefix(size);
  }
}

void OutputFile::flush() {
  const char* next = buffer_.get();
  std::size_t left = std::exchange(used_, 0);
  flushed_ += left;
  while (left > 0) {
    const ssize_t written = ::write(descriptor_, next, left);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      throw RunError(fmt::format("{}: cannot be written: {}", path_,
                                 written < 0 ? std::strerror(errno) : "no progress"));
    }
    next += written;
    left -= static_cast<std::size_t>(written);
  }
}

void OutputFile::sync() {
  flush();
  if (::fsync(descriptor_) != 0)
    throw RunError(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
}

void OutputFile::rename(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0)
    throw RunError(fmt::format("{}: cannot be renamed: {}", escaped(to), std::strerror(errno)));
  path_ = escaped(to);
}

/// What is no file, as a device, has names elsewhere or none.
void OutputFile::requireName() const {
  struct stat now {};
  if (::fstat(descriptor_, &now) == 0 && S_ISREG(now.st_mode) && now.st_nlink == 0)
    throw RunError(path_ + ": was removed");
}

/// A lock of the open file, as it is only looked at: to look disturbs nobody who takes it.
void OutputFile::showThatItGrows() noexcept {
  struct flock whole {};
  whole.l_type = F_WRLCK;
  whole.l_whence = SEEK_SET;
  ::fcntl(descriptor_, F_OFD_SETLK, &whole);
}

void OutputFile::close() {
  if (descriptor_ < 0) return;
  flush();
  if (::close(std::exchange(descriptor_, -1)) != 0) {
    throw RunError(fmt::format("{}: cannot be written: {}", path_, std::strerror(errno)));
  }
}

void replaceFile(const std::string& path, const std::string& text,
                 const std::function<void(const std::string& next)>& check) {
  Successor next(path, text);
  if (check) check(next.path());
  keepBeside(next.target());
  next.takePlace();
}

void replaceWithoutCopy(const std::string& path, const std::string& text) {
  Successor(path, text).takePlace();
}

void writeWhole(const std::string& path, const std::string& text) {
  std::error_code ignored;  // of what is not there yet
  if (std::filesystem::is_regular_file(path, ignored)) return replaceWithoutCopy(path, text);
  const bool is_new = !std::filesystem::exists(path, ignored);
  OutputFile file(path);
  try {
    file.append(text);
    file.close();
  } catch (...) {
    if (is_new) std::filesystem::remove(path, ignored);
    throw;
  }
}

void refuseOverwriting(const std::string& input, const std::string& output) {
  std::error_code ignored;  // of an output that does not exist yet
  if (std::filesystem::equivalent(input, output, ignored)) {
    failAt(beginOf(output), "-o", "is the input itself", "expected another file");
  }
}

}  // namespace tactus
