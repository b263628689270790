#include "tactus/doctor/line_check.h"

namespace tactus {

Finding checkLines(const GpioSurvey& survey) {
  if (!survey.problem.empty())
    return {"gpio", Level::kNotFit, survey.problem, "tactusd does not start without its lines",
            "name chip and lines as gpioinfo shows them in robot.yaml; for access, a udev rule: "
            "SUBSYSTEM==\"gpio\", GROUP=\"tactus\", MODE=\"0660\""};
  if (!survey.users.empty())
    return {"gpio", Level::kNotFit, "lines in use: " + survey.users,
            "tactusd does not start while another program holds them",
            "end that program, which may be a tactusd on other buses; if it is the kernel, free "
            "the line in the device tree"};
  return {"gpio", Level::kOk, "all GPIO lines are there and free"};
}

}  // namespace tactus
