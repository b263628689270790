#pragma once

#include "tactus/canopen/hardware_config.h"
#include "tactus/scene/eds_file.h"

namespace tactus {

/// Whether the drive that a data sheet describes can be what Tactus needs of it, on this bus and
/// with this cycle: device type and mode 9, each entry that the set-up reads or writes with type,
/// access and limits, both PDOs and what they carry, the bit rate. Throws InputError at the line of
/// the data sheet that says otherwise. The cycle is one that drives can be told.
void checkEds(const EdsFile& eds, const DriveConfig& drive, const BusConfig& bus,
              const CanopenConfig& canopen, double period_s);

}  // namespace tactus
