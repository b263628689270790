/// Prints the robot's GPIO lines as the daemon sees them, and toggles the outputs, for trying out a
/// real chip:
///
///     gpio_check CHIP STOP ENABLE BRAKE HEARTBEAT [CYCLES [PERIOD_MS]]
///
/// STOP... are line numbers, -1 for a line that there is none of, with an `l` behind it if active
/// low: `gpio_check gpiochip0 0 1l 2 -1 1000 1`. A line is printed whenever an input changes:
/// `cycle stop enable valid`. Exit status: 0 if the chip could always be read and written, else 1.

#include <time.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <optional>
#include <string>

#include "tactus/io/gpio_lines.h"

namespace {

std::optional<tactus::GpioLineConfig> lineOf(const std::string& text) {
  const int number = std::atoi(text.c_str());
  if (number < 0) return std::nullopt;
  return tactus::GpioLineConfig{number, text.back() == 'l', 0.0};
}

void sleepFor(double duration_s) {
  const auto whole_s = static_cast<time_t>(duration_s);
  const timespec duration{whole_s,
                          static_cast<long>(1e9 * (duration_s - static_cast<double>(whole_s)))};
  nanosleep(&duration, nullptr);
}

/// Number of cycles in which the chip refused.
int watch(tactus::GpioLines& lines, int cycles, double period_s) {
  int refused = 0;
  std::string last;
  for (int cycle = 0; cycle < cycles; ++cycle) {
    const tactus::GpioInputs inputs = lines.read();
    const bool is_written =
        lines.write({.release_brake = cycle / 2 % 2 != 0, .heartbeat = cycle % 2 != 0});
    if (!inputs.is_valid || !is_written) ++refused;
    const std::string now = std::to_string(inputs.emergency_stop) + " " +
                            std::to_string(inputs.enable) + " " + std::to_string(inputs.is_valid);
    if (now != last) std::printf("%d %s\n", cycle, now.c_str());
    std::fflush(stdout);
    last = now;
    sleepFor(period_s);
  }
  return refused;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 6) {
    std::fprintf(stderr,
                 "usage: gpio_check CHIP STOP ENABLE BRAKE HEARTBEAT [CYCLES [PERIOD_MS]]\n");
    return 2;
  }
  tactus::GpioConfig config;
  config.chip = argv[1];
  config.e_stop = lineOf(argv[2]);
  config.enable = lineOf(argv[3]);
  config.brake = lineOf(argv[4]);
  config.heartbeat = lineOf(argv[5]);
  const int cycles = argc > 6 ? std::atoi(argv[6]) : 1000;
  const double period_s = argc > 7 ? 0.001 * std::atof(argv[7]) : 0.001;
  try {
    tactus::GpioLines lines(config, period_s);
    std::printf("edges of the e-stop: %s\n", lines.seesPulses() ? "seen" : "not seen, polled");
    const int refused = watch(lines, cycles, period_s);
    std::printf("%d cycles, %d refused\n", cycles, refused);
    return refused == 0 ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
