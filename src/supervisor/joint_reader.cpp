#include "tactus/supervisor/joint_reader.h"

#include <algorithm>

#include "tactus/canopen/cycle_count.h"

namespace tactus {

JointReader::JointReader(const HardwareConfig& hardware, double period_s)
    : robot_(hardware, period_s),
      rest_(JointVector::Zero(static_cast<int>(hardware.drives.size()))),
      stop_deadline_cycles_(cyclesLasting(hardware.canopen.stop_deadline_s, period_s)) {}

void JointReader::update(std::span<const Fault> bus_faults) noexcept {
  robot_.read(input_);
  const DrivesReport drives = robot_.drives();
  if (drives.are_configured && !drives.are_disabled) ++stopping_cycles_;
  judge(bus_faults, drives);
  // Whose set-up is done has told where it is.
  const bool is_known = drives.are_configured && drives.are_disabled;
  is_done_ = is_known || report_.fault != Fault::kNone;
  if (is_done_) return robot_.release();
  robot_.command(DriveGoal::kConfigure, is_first_, rest_);
  robot_.write(rest_);
  is_first_ = false;
}

void JointReader::judge(std::span<const Fault> bus_faults, const DrivesReport& drives) noexcept {
  const auto bus = std::ranges::find_if(bus_faults, [](Fault it) { return it != Fault::kNone; });
  if (bus != bus_faults.end()) {
    report_.fault = *bus;
    report_.bus = static_cast<int>(bus - bus_faults.begin());
  } else if (drives.fault != Fault::kNone) {
    report_.fault = drives.fault;
    report_.joint = drives.joint;
  } else if (stopping_cycles_ > stop_deadline_cycles_) {
    report_.fault = Fault::kDriveStateLost;
    report_.joint = robot_.firstWithPower();
  }
  if (report_.joint >= 0) report_.drive = robot_.drive(report_.joint);
}

}  // namespace tactus
