#pragma once

#include <linux/can.h>

#include <string>

#include "tactus/canopen/can_frame.h"

namespace tactus {

/// A frame as the kernel's CAN sockets read and write it, and back; sizes are cut to eight bytes.
CanFrame fromKernel(const can_frame& raw) noexcept;
can_frame toKernel(const CanFrame& frame) noexcept;

/// Throws std::system_error: "can0: <problem>: <what the error number says>".
[[noreturn]] void failOnInterface(int error_number, const std::string& interface,
                                  const std::string& problem);

}  // namespace tactus
