#pragma once

#include <string>

#include "tactus/canopen/bus_load.h"

namespace tactus {

/// The arithmetic of a bus's worst-case load:
/// "3 x 115 (RPDO1) + ... + 4 x 65 / 20 (heartbeats) = 758 bits a cycle of 1000 = 75.8 %".
std::string describeBusLoad(const BusLoad& load, double period_s);

}  // namespace tactus
