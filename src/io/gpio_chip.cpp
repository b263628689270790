#include "gpio_chip.h"

#include <errno.h>

#include <cstring>
#include <stdexcept>

namespace tactus {

void failOnChip(const std::string& name, const std::string& problem) {
  throw std::runtime_error(name + ": " + problem);
}

std::unique_ptr<GpioChip> openGpioChip(const std::string& name) {
  std::unique_ptr<GpioChip> chip = findGpioChip(name);
  if (!chip)
    failOnChip(name, std::string("cannot open this GPIO chip (") + std::strerror(errno) +
                         "); gpiodetect lists the chips, and the user needs access to /dev/" +
                         name);
  return chip;
}

void requireGpioLine(GpioChip& chip, const std::string& name, int line) {
  const int count = chip.lineCount();
  if (line < 0 || line >= count)
    failOnChip(name, "has no line " + std::to_string(line) + ", expected 0 to " +
                         std::to_string(count - 1));
}

}  // namespace tactus
