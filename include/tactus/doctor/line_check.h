#pragma once

#include "tactus/doctor/finding.h"
#include "tactus/io/gpio_survey.h"

namespace tactus {

/// Whether chip and lines are there, and free, but for a tactusd that runs.
Finding checkLines(const GpioSurvey& survey);

}  // namespace tactus
