#pragma once

#include <string>

namespace tactus {

/// What the machine would not grant, for a person to mend. Whether the daemon runs without it is
/// the scene's decision, so a refusal is a value and no exception.
struct Refusal {
  std::string what;            ///< "SCHED_FIFO at priority 80: Operation not permitted"
  std::string why_it_matters;  ///< what can go wrong without it
  std::string how_to_grant;
};

}  // namespace tactus
