#pragma once

#include <array>
#include <atomic>
#include <stop_token>
#include <streambuf>
#include <string>

namespace tactus {

/// A log that somebody else writes: where others are at its end, this waits for more. It ends where
/// the run has ended, told by the summary beside it, where its writer has closed it or was killed,
/// where the log goes on in another file, and at the end of what is there once nobody waits for
/// more.
class GrowingFile final : public std::streambuf {
 public:
  /// Throws InputError as openLog().
  explicit GrowingFile(std::string path, std::stop_token stop = {});
  ~GrowingFile() override;
  GrowingFile(const GrowingFile&) = delete;
  GrowingFile& operator=(const GrowingFile&) = delete;

  /// All that was there has been read; what comes is new. From any thread.
  bool isLive() const noexcept { return is_live_; }
  /// At the end: another file of this name has the rest.
  bool goesOn() const noexcept { return goes_on_; }

 protected:
  int_type underflow() override;

 private:
  long fill();
  bool isOther() const;
  bool isOver() const;
  bool isLeft();

  std::string path_;
  std::stop_token stop_;
  int fd_ = -1;
  std::atomic<bool> is_live_ = false;
  bool goes_on_ = false;
  bool was_written_ = false;  ///< somebody was seen to write it
  int unwritten_looks_ = 0;   ///< in a row
  std::array<char, 1 << 16> buffer_;
};

}  // namespace tactus
