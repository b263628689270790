#include "soak/growth.h"

namespace tactus::soak {

double growth(std::span<const Reading> readings) {
  const std::span<const Reading> late = readings.subspan(readings.size() / 3);
  if (late.size() < 3) return 0.0;
  const auto count = static_cast<double>(late.size());
  double mean_s = 0.0, mean = 0.0;
  for (const Reading& reading : late) {
    mean_s += reading.t_s / count;
    mean += reading.value / count;
  }
  double squares = 0.0, products = 0.0;
  for (const Reading& reading : late) {
    squares += (reading.t_s - mean_s) * (reading.t_s - mean_s);
    products += (reading.t_s - mean_s) * (reading.value - mean);
  }
  if (!(squares > 0.0)) return 0.0;
  return products / squares * (late.back().t_s - late.front().t_s);
}

}  // namespace tactus::soak
