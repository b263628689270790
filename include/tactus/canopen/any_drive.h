#pragma once

#include <variant>

#include "tactus/canopen/drive.h"
#include "tactus/canopen/moteus_drive.h"

namespace tactus {

/// A drive of any kind that there is. All have the functions of Drive.
using AnyDrive = std::variant<Drive, MoteusDrive>;

/// Throws std::invalid_argument with one line for settings that no drive can be given.
AnyDrive makeDrive(const DriveConfig& config, const CanopenConfig& canopen, double period_s);

}  // namespace tactus
