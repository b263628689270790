#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "tactus/canopen/can_frame.h"

namespace tactus {

/// A CAN socket for whoever plays a bus instead of being on it: hears everything but its own
/// frames, sends whatever it is told, error frames too, and judges nothing.
class RawCanSocket {
 public:
  /// is_fd: CAN FD, too. Throws std::system_error whose text names interface, what failed and what
  /// to do.
  explicit RawCanSocket(const std::string& interface, bool is_fd = false);
  ~RawCanSocket();
  RawCanSocket(const RawCanSocket&) = delete;
  RawCanSocket& operator=(const RawCanSocket&) = delete;

  /// Frames waiting, as many as the batch holds. Never waits.
  void receive(FrameBatch& frames) noexcept;
  /// Never waits; what the kernel refuses is lost and counted.
  void send(std::span<const CanFrame> frames) noexcept;

  int descriptor() const noexcept { return descriptor_; }
  std::uint64_t refused() const noexcept { return refused_; }
  /// Whether the interface was removed, as receive() has seen. It does not come back.
  bool isGone() const noexcept { return is_gone_; }

 private:
  int descriptor_ = -1;
  std::uint64_t refused_ = 0;
  bool is_gone_ = false;
};

}  // namespace tactus
