#include "tactus/supervisor/joint_reader.h"

#include <algorithm>

namespace tactus {

JointReader::JointReader(const HardwareConfig& hardware, double period_s)
    : robot_(hardware, period_s),
      rest_(JointVector::Zero(static_cast<int>(hardware.drives.size()))) {}

void JointReader::update(std::span<const Fault> bus_faults) noexcept {
  robot_.read(input_);
  judge(bus_faults);
  // Whose set-up is done has told where it is.
  is_done_ = robot_.drives().are_configured || report_.fault != Fault::kNone;
  if (is_done_) return robot_.release();
  robot_.command(DriveGoal::kConfigure, is_first_, rest_);
  robot_.write(rest_);
  is_first_ = false;
}

void JointReader::judge(std::span<const Fault> bus_faults) noexcept {
  const DrivesReport drives = robot_.drives();
  const auto bus = std::ranges::find_if(bus_faults, [](Fault it) { return it != Fault::kNone; });
  if (bus != bus_faults.end()) {
    report_.fault = *bus;
    report_.bus = static_cast<int>(bus - bus_faults.begin());
  } else if (drives.fault != Fault::kNone) {
    report_.fault = drives.fault;
    report_.joint = drives.joint;
    report_.drive = robot_.drive(drives.joint);
  }
}

}  // namespace tactus
