#pragma once

#include <linux/can.h>

#include <cstddef>
#include <string>

#include "tactus/canopen/can_frame.h"

namespace tactus {

/// A frame as the kernel's CAN sockets read and write it, and back; sizes are cut to eight bytes.
CanFrame fromKernel(const can_frame& raw) noexcept;
can_frame toKernel(const CanFrame& frame) noexcept;

/// The same for frames of CAN FD, whose rate is switched; sizes are cut to 64 bytes, and filled up
/// by zeros to those that there are.
CanFrame fromKernelFd(const canfd_frame& raw) noexcept;
canfd_frame toKernelFd(const CanFrame& frame) noexcept;

/// Either of them into the room of a larger one. Returns its bytes there, CAN_MTU or CANFD_MTU.
std::size_t putKernelFrame(const CanFrame& frame, canfd_frame& room) noexcept;
/// Of as many bytes as came, CAN_MTU or CANFD_MTU.
CanFrame takeKernelFrame(const canfd_frame& room, std::size_t bytes) noexcept;

/// Throws std::system_error: "can0: <problem>: <what the error number says>".
[[noreturn]] void failOnInterface(int error_number, const std::string& interface,
                                  const std::string& problem);

}  // namespace tactus
