#include "tactus/supervisor/joint_reader.h"

namespace tactus {

JointReader::JointReader(const HardwareConfig& hardware, double period_s)
    : robot_(hardware, period_s),
      rest_(JointVector::Zero(static_cast<int>(hardware.drives.size()))) {}

void JointReader::update(std::span<const Fault> bus_faults) noexcept {
  robot_.read(input_);
  judge(bus_faults);
  const bool is_known = robot_.drives().are_configured && robot_.hasPositions();
  is_done_ = is_known || report_.fault != Fault::kNone;
  if (is_done_) return robot_.release();
  robot_.command(DriveGoal::kConfigure, is_first_, rest_);
  robot_.write(rest_);
  is_first_ = false;
}

void JointReader::judge(std::span<const Fault> bus_faults) noexcept {
  const DrivesReport drives = robot_.drives();
  for (std::size_t bus = 0; bus < bus_faults.size(); ++bus) {
    if (bus_faults[bus] == Fault::kNone) continue;
    report_.fault = bus_faults[bus];
    report_.bus = static_cast<int>(bus);
    return;
  }
  if (drives.fault == Fault::kNone) return;
  report_.fault = drives.fault;
  report_.joint = drives.joint;
  report_.drive = robot_.drive(drives.joint);
  report_.detail = report_.drive.detail;
}

}  // namespace tactus
