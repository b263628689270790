#include "tactus/scene/cover_keys.h"

namespace tactus {

using namespace keys;

Table<CoverSection> coverLoadKeys() {
  using Config = CoverSection;
  Row<Config> center =
      optional(value(ValueType::kNumberList, "center_m", "m",
                     "its centre of mass in the link's frame; absent: the middle of length_m, on x",
                     &Config::center_m));
  center.spec.range = within(-10, 10);
  center.spec.count = {3, 3};
  return {
      required(number("mass_kg", "kg", within(0, 100), "of all that hangs on the module's cells",
                      &Config::mass_kg)),
      center,
  };
}

CoverConfig makeCover(const CoverSection& section, double length_m) {
  return {section.mass_kg, section.center_m.value_or(Vector3(0.5 * length_m, 0.0, 0.0))};
}

}  // namespace tactus
