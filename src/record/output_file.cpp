#include "tactus/record/output_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "tactus/record/run_error.h"
#include "tactus/scene/located_error.h"

namespace tactus {

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

void OutputFile::rename(const std::string& from, const std::string& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0)
    throw RunError(fmt::format("{}: cannot be renamed: {}", escaped(to), std::strerror(errno)));
  path_ = escaped(to);
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
  namespace fs = std::filesystem;
  const std::string next = path + ".next";
  OutputFile file(next);
  file.append(text);
  file.close();
  try {
    if (check) check(next);
  } catch (...) {
    fs::remove(next);
    throw;
  }
  fs::permissions(next, fs::status(path).permissions());
  fs::copy_file(path, path + "~", fs::copy_options::overwrite_existing);
  fs::rename(next, path);
}

void refuseOverwriting(const std::string& input, const std::string& output) {
  std::error_code ignored;  // of an output that does not exist yet
  if (std::filesystem::equivalent(input, output, ignored)) {
    failAt(beginOf(output), "-o", "is the input itself", "expected another file");
  }
}

}  // namespace tactus
