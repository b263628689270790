#include "tactus/scene/key_builders.h"

namespace tactus {
namespace {

using namespace keys;
using Draft = ConfigDraft;

KeySpec calibrationTable() {
  KeySpec spec =
      value(ValueType::kNumberTable, "calibration", "1 or m",
            "rows of F_y, F_z, M_y, M_z in the link's frame for a force of 1 N on each "
            "of the 8 channels",
            [](Draft& d) -> Eigen::Matrix<double, 4, 8>& { return d.plant.module.calibration; });
  spec.range = within(-1e3, 1e3);
  spec.count = {4, 4};
  spec.columns = 8;
  return spec;
}

KeySpec tactileModuleSection() {
  KeySpec spec = section(
      "tactile_module", "the sensing cover around one link",
      {
          text("link", "URDF link whose x axis runs along the cover from its start",
               [](Draft& d) -> std::string& { return d.module_link; }),
          number("length_m", "m", above(0, 10), "length of the cover along x",
                 [](Draft& d) -> double& { return d.module.length_m; }),
          number("cover_radius_m", "m", above(0, 1), "radius of the cover around x",
                 [](Draft& d) -> double& { return d.plant.cover_radius_m; }),
          defaulted("100",
                    number("max_force_N", "N", above(0, 1e4), "a larger reading is a sensor fault",
                           [](Draft& d) -> double& { return d.module.max_force_N; })),
          defaulted("0.02", number("max_sample_age_s", "s", above(0, 1),
                                   "an older sample is a sensor fault",
                                   [](Draft& d) -> double& { return d.module.max_sample_age_s; })),
          defaulted("15",
                    number("filter_cutoff_hz", "Hz", within(0.1, 1e5),
                           "of the module's 3rd-order Butterworth filter",
                           [](Draft& d) -> double& { return d.plant.module.filter_cutoff_hz; })),
          defaulted(
              "1000",
              number("filter_rate_hz", "Hz", within(1, 1e5), "rate at which the module filters",
                     [](Draft& d) -> double& { return d.plant.module.filter_rate_hz; })),
          defaulted("0.004",
                    number("sample_period_s", "s", above(0, 1),
                           "time between samples, a multiple of the filter's period",
                           [](Draft& d) -> double& { return d.plant.module.sample_period_s; })),
          defaulted("100000",
                    number("counts_per_N", "1/N", above(0, 1e7), "of the 24-bit channels",
                           [](Draft& d) -> double& { return d.plant.module.counts_per_N; })),
          calibrationTable(),
      });
  for (const KeySpec& row : moduleOnBusKeys()) spec.keys.push_back(row);
  return spec;
}

}  // namespace

const std::vector<KeySpec>& robotKeys() {
  static const std::vector<KeySpec> table = {
      text("urdf", "robot description, relative to this file",
           [](Draft& d) -> std::string& { return d.urdf; }),
      text("tip", "URDF link that is the tool", [](Draft& d) -> std::string& { return d.tip; }),
      oneAJoint("home", "m or rad", within(-1e6, 1e6),
                "joint positions where a scene starts unless it names others",
                [](Draft& d) -> std::vector<double>& { return d.home; }),
      defaulted("", section("limits", "beyond those of the URDF",
                            {optional(oneAJoint("acceleration", "m/s^2 or rad/s^2", above(0, 1e6),
                                                "largest change of the command; absent: no limit",
                                                [](Draft& d) -> std::vector<double>& {
                                                  return d.max_acceleration;
                                                }))})),
      optional(number("stiffness_N_per_m", "N/m", above(0, 1e9),
                      "compliance of the arm, in series with every obstacle; absent: rigid",
                      [](Draft& d) -> double& { return d.plant.robot_stiffness_N_per_m; })),
      optional(canSection()),
      defaulted("", drivesSection()),
      optional(tactileModuleSection()),
      optional(gpioSection()),
      defaulted("", realTimeSection()),
  };
  return table;
}

}  // namespace tactus
