#pragma once

#include <array>
#include <cstdint>
#include <iosfwd>
#include <span>
#include <string>

#include "tactus/supervisor/mode_table.h"

/// What is written from the tables of modes, faults and brakes, and compared with the code that
/// runs from them.
namespace tactus::model {

/// The tables as docs/safety.md and tactusd(8) have them.
std::string modeTable();
std::string hazardTable();
std::string remedyTable();
std::string modeManual();
std::string faultManual();

/// The model that SPIN looks at: one cycle after the other, told anything.
std::string promelaModel();

/// Reads each step that SPIN took of that model, a line each, and takes it in the code, too: true
/// where both have the same states and the same steps between them. Says what differs.
bool agrees(std::istream& steps, std::ostream& says);

/// The faults that the model tells apart: of those that the code treats alike, the first.
Fault representative(Fault fault);

}  // namespace tactus::model
