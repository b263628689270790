#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace tactus {

enum class FrameKind : std::uint8_t { kData, kRemote, kError };

inline constexpr std::uint8_t kMaxClassicBytes = 8;
inline constexpr std::uint8_t kMaxFdBytes = 64;

/// A CAN frame as it lies on the bus, whoever carries it.
struct CanFrame {
  std::uint32_t id = 0;  ///< 11 or 29 bits; of an error frame its class (linux/can/error.h)
  FrameKind kind = FrameKind::kData;
  bool extended = false;  ///< 29-bit id
  bool is_fd = false;     ///< a data frame of CAN FD, its data at the data bit rate
  std::uint8_t size = 0;  ///< 0..8; of CAN FD 0..64, one of fdSize()
  std::array<std::uint8_t, kMaxFdBytes> data{};

  bool operator==(const CanFrame&) const = default;
};

/// The smallest size of CAN FD, 0..8, 12, 16, 20, 24, 32, 48 or 64, that so many bytes (0..64) fit
/// in.
constexpr int fdSize(int bytes) noexcept {
  if (bytes <= 8) return bytes;
  if (bytes <= 24) return (bytes + 3) / 4 * 4;
  return bytes <= 32 ? 32 : bytes <= 48 ? 48 : 64;
}

/// Frames of one bus and cycle, in the order of the bus. No heap.
class FrameBatch {
 public:
  static constexpr std::size_t kCapacity = 64;

  /// False, and the frame is dropped, when the batch is full.
  bool push(const CanFrame& frame) noexcept {
    if (size_ == kCapacity) return false;
    frames_[size_++] = frame;
    return true;
  }
  void clear() noexcept { size_ = 0; }
  std::size_t size() const noexcept { return size_; }
  bool empty() const noexcept { return size_ == 0; }
  const CanFrame* begin() const noexcept { return frames_.data(); }
  const CanFrame* end() const noexcept { return frames_.data() + size_; }
  std::span<const CanFrame> frames() const noexcept { return {frames_.data(), size_}; }

 private:
  std::array<CanFrame, kCapacity> frames_;
  std::size_t size_ = 0;
};

}  // namespace tactus
