#include "tactus/canopen/any_drive.h"

namespace tactus {

AnyDrive makeDrive(const DriveConfig& config, const CanopenConfig& canopen, double period_s) {
  if (config.kind == DriveKind::kMoteus) return MoteusDrive(config, canopen, period_s);
  return Drive(config, canopen, period_s);
}

}  // namespace tactus
