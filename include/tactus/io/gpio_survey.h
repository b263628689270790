#pragma once

#include <string>

#include "tactus/canopen/hardware_config.h"

namespace tactus {

/// What can be said of the robot's lines without taking them.
struct GpioSurvey {
  std::string problem;  ///< chip or line that is not to be had; empty: all are there
  std::string users;    ///< who holds which line: "line 4: gpiomon"; empty: nobody
};

GpioSurvey surveyGpio(const GpioConfig& config);

}  // namespace tactus
