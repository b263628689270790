#include "tactus/io/gpio_survey.h"

#include <stdexcept>

#include "gpio_chip.h"

namespace tactus {

GpioSurvey surveyGpio(const GpioConfig& config) {
  GpioSurvey survey;
  try {
    const std::unique_ptr<GpioChip> chip = openGpioChip(config.chip);
    for (const auto* line : {&config.e_stop, &config.enable, &config.brake, &config.heartbeat}) {
      if (!*line) continue;
      const int number = (*line)->line;
      requireGpioLine(*chip, config.chip, number);
      const auto user = chip->user(number);
      if (!user) continue;
      survey.users +=
          (survey.users.empty() ? "line " : ", line ") + std::to_string(number) + ": " + *user;
    }
  } catch (const std::runtime_error& error) {
    survey.problem = error.what();
  }
  return survey;
}

}  // namespace tactus
