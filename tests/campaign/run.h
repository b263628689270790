#pragma once

#include <vector>

#include "campaign/judges.h"
#include "campaign/plan.h"
#include "campaign/stage.h"

namespace tactus::campaign {

struct Result {
  std::vector<Violation> violations;
  Mode mode = Mode::kOff;  ///< at the end
  Fault fault = Fault::kNone;
  Mode rest_mode = Mode::kOff;  ///< when the user comes
  Fault rest_fault = Fault::kNone;
  int rest_ms = 0;       ///< RestMeter
  double peak = 0.0;     ///< joint speed in the seconds after a return to running, m/s or rad/s
  long long cycles = 0;  ///< simulated
};

/// is_traced: prints what happens.
Result simulate(const Stage& stage, const Plan& plan, bool is_traced);

}  // namespace tactus::campaign
