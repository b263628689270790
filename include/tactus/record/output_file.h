#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace tactus {

/// A file that is written from start to end through one large buffer. Nothing is lost silently:
/// append(), reserve(), flush(), sync() and close() throw RunError when the system refuses a byte
/// (disk full).
class OutputFile {
 public:
  /// Fits into a second-level cache: filling it costs less than the system call that empties it.
  static constexpr std::size_t kBufferSize = std::size_t{1} << 18;

  /// Creates or truncates `path`; "-" is standard output. Throws InputError if it cannot be opened.
  explicit OutputFile(const std::string& path);

  /// Writes what is left, so that an aborted run keeps its log; errors are lost here, hence
  /// close().
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void append(std::string_view bytes);

  /// Room for `size` <= kBufferSize bytes, to be filled by the caller and then committed.
  char* reserve(std::size_t size) {
    if (kBufferSize - used_ < size) flush();
    return buffer_.get() + used_;
  }
  void commit(std::size_t size) noexcept { used_ += size; }

  /// Hands what is in the buffer to the kernel, from where no end of this process takes it away.
  void flush();
  /// flush(), and to the disk: it outlives a loss of power.
  void sync();
  /// Gives the file another name, which errors show from then on. Throws RunError.
  void rename(const std::string& from, const std::string& to);
  void close();

  /// Throws RunError where the file was removed: what is written then nobody will read.
  void requireName() const;

  /// Until it is closed, or this process ends in whatever way, a GrowingFile sees that more may
  /// come. Where the file system knows no locks it does not, and waits.
  void showThatItGrows() noexcept;

  /// What was appended so far, bytes.
  std::uint64_t size() const noexcept { return flushed_ + used_; }

 private:
  std::string path_;  ///< as errors show it
  int descriptor_;
  std::unique_ptr<char[]> buffer_;
  std::size_t used_ = 0;
  std::uint64_t flushed_ = 0;  ///< bytes
};

/// Gives a file that is there another content, as a whole or not at all, also where the power goes;
/// as it was it stays beside, with a tilde behind its name. Owner and rights stay, and a link stays
/// a link: what it leads to is replaced, and the tilde is there. check: of the new one by its path,
/// which is in the same folder, before it takes the old one's place; what it throws leaves all as
/// it was. Throws RunError or InputError.
void replaceFile(const std::string& path, const std::string& text,
                 const std::function<void(const std::string& next)>& check = {});

/// The same, but what it was is kept nowhere, and a copy beside stays as it is.
void replaceWithoutCopy(const std::string& path, const std::string& text);

/// As replaceWithoutCopy(): who reads the file meanwhile has the one before. Creates it where there
/// is none; what is no file, as a pipe or a device, is written to.
void writeWhole(const std::string& path, const std::string& text);

/// Throws InputError if writing to `output` would destroy the file `input`.
void refuseOverwriting(const std::string& input, const std::string& output);

}  // namespace tactus
