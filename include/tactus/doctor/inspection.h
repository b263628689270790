#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "tactus/canopen/hardware_config.h"
#include "tactus/doctor/disk_check.h"
#include "tactus/doctor/finding.h"
#include "tactus/doctor/machine_files.h"

namespace tactus {

/// What a run asks of the machine.
struct MachineNeeds {
  RealTimeConfig real_time;
  std::vector<BusConfig> buses;
  std::optional<GpioConfig> gpio;
  LogNeeds log;
  std::filesystem::path log_folder = ".";
};

/// All that can be said of a machine without running anything on it. Changes nothing. The file
/// system is that under `root`; CAN controllers and GPIO chips are those of the kernel.
std::vector<Finding> inspectMachine(const MachineRoot& root, const MachineNeeds& needs);

}  // namespace tactus
