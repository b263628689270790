#include <array>

#include "tactus/control/robot.h"
#include "tactus/scene/cover_keys.h"
#include "tactus/scene/hardware_keys.h"
#include "tactus/scene/key_defaults.h"
#include "tactus/scene/key_words.h"

namespace tactus {
namespace {

using namespace keys;

Table<TactileModuleSection> placeKeys() {
  using Config = TactileModuleSection;
  return {
      text("link", "URDF link whose x axis runs along the cover from its start", &Config::link)};
}

Table<CoverSection> gearedCoverKeys() {
  return join(coverLoadKeys(),
              Table<CoverSection>{boolean(
                  "behind_gears",
                  "the drives measure their motors, and gear_stiffness in `dynamics` says where "
                  "the links are; false: the drives measure the links, or gears are stiff",
                  &CoverSection::behind_gears)});
}

Table<TactileModuleSection> coverSection() {
  return {optional(section("cover",
                           "weight and inertia of the cover, which are taken out of the readings "
                           "and simulated; absent: none",
                           &TactileModuleSection::cover, gearedCoverKeys()))};
}

Table<TactileModuleConfig> coverKeys() {
  return {required(number("cover_radius_m", "m", above(0, 1), "radius of the cover around x",
                          &TactileModuleConfig::cover_radius_m))};
}

Table<TactileModuleConfig> readingKeys() {
  using Config = TactileModuleConfig;
  return {
      required(
          number("length_m", "m", above(0, 10), "length of the cover along x", &Config::length_m)),
      number("max_force_N", "N", above(0, 1e4), "a larger reading is a sensor fault",
             &Config::max_force_N),
      number("max_sample_age_s", "s", above(0, 1), "an older sample is a sensor fault",
             &Config::max_sample_age_s),
      number("filter_cutoff_hz", "Hz", within(0.1, 1e5),
             "of the module's 3rd-order Butterworth filter", &Config::filter_cutoff_hz),
  };
}

Row<TactileChannels> calibrationTable() {
  Row<TactileChannels> row;
  row.spec.key = "calibration";
  row.spec.type = ValueType::kNumberTable;
  row.spec.unit = "1 or m";
  row.spec.doc =
      "rows of F_y, F_z, M_y, M_z, and M_x if the module tells it, in the link's frame for a force "
      "of 1 N on each of the 8 channels";
  row.spec.range = within(-1e3, 1e3);
  row.spec.count = {4, 5};
  row.spec.columns = 8;
  row.spec.target = [](void* owner) -> Target { return static_cast<TactileChannels*>(owner); };
  return row;
}

Table<SimulatedModuleConfig> filterKeys() {
  return {number("filter_rate_hz", "Hz", within(1, 1e5), "rate at which the module filters",
                 &SimulatedModuleConfig::filter_rate_hz)};
}

Table<TactileChannels> channelKeys() {
  using Config = TactileChannels;
  return {
      number("sample_period_s", "s", above(0, 1),
             "time between samples, a multiple of the filter's period", &Config::sample_period_s),
      number("counts_per_N", "1/N", above(0, 1e7), "of the 24-bit channels", &Config::counts_per_N),
      calibrationTable(),
  };
}

Table<TactileModuleSection> tactileModuleKeys() {
  using Config = TactileModuleSection;
  return join(placeKeys(), inside(&Config::config, coverKeys()),
              inside(&Config::config, readingKeys()), coverSection(),
              inside(&Config::simulated, filterKeys()), inside(&Config::channels, channelKeys()),
              moduleOnBusKeys());
}

constexpr std::array kModuleLostWords = {
    Word<ModuleLost>{"stop", ModuleLost::kStop},
    Word<ModuleLost>{"go_on_slowly", ModuleLost::kGoOnSlowly},
};

Table<RobotConfig> moduleLostKeys() {
  using Config = RobotConfig;
  const Table<ModuleLossConfig> share = {number("module_lost_speed_share", "", within(0.01, 1),
                                                "of the speed at which the arm goes on slowly",
                                                &ModuleLossConfig::speed_share)};
  return join(
      Table<Config>{choice(
          "module_lost",
          "when one of several tactile modules tells nothing any more while nothing pushes on it, "
          "and another is good: stop, as after every fault, or go_on_slowly, until it has been "
          "good for 1 s",
          &Config::module_lost, kModuleLostWords)},
      inside(&Config::module_loss, share));
}

Row<RobotConfig> capsuleSections() {
  using Config = CapsuleSection;
  const Table<Config> rows = {
      text("link", "URDF link that it moves with, and whose frame it is given in", &Config::link),
      required(vector3("from_m", "m", within(-100, 100), "one end of its axis", &Config::from_m)),
      required(vector3("to_m", "m", within(-100, 100), "the other end, which may be the same",
                       &Config::to_m)),
      required(number("radius_m", "m", above(0, 10), "around its axis, also at its round ends",
                      &Config::radius_m)),
  };
  return sectionList("collision_capsules", {0, 64},
                     "parts of links that simulated obstacles push on, too, and no module feels: "
                     "what the covers of modules leave free",
                     &RobotConfig::collision_capsules, rows);
}

Row<RobotConfig> dynamicsSection() {
  using Config = DynamicsSection;
  const Table<Config> rows = {
      oneAJoint("rotor_inertia", "kg m^2 or kg", within(0, 1e5),
                "of motor and gear, at the joint; absent: none", &Config::rotor_inertia),
      oneAJoint("gear_stiffness", "Nm/rad or N/m", above(0, 1e12),
                "of the gear, for simulation.arm: flexible_gears", &Config::gear_stiffness),
      oneAJoint("gear_damping", "Nm s/rad or N s/m", within(0, 1e9),
                "of the gear's spring; absent: none", &Config::gear_damping),
      number("servo_bandwidth_hz", "Hz", within(0.1, 1000), "of the velocity loop",
             &Config::servo_bandwidth_hz),
      number("servo_integral_hz", "Hz", within(0, 1000),
             "zero of its integral part; 0: it has none", &Config::servo_integral_hz),
      optional(number("contact_stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                      "in place of stiffness_N_per_m where the gears are flexible: what is left "
                      "of it, as links and covers; absent: rigid",
                      &Config::contact_stiffness_N_per_m)),
  };
  return optional(
      section("dynamics", "of an arm that is simulated with mass", &RobotConfig::dynamics, rows));
}

Table<RobotConfig> robotTable() {
  using Config = RobotConfig;
  const Table<Config> of_arm = {
      text("urdf", "robot description, relative to this file", &Config::urdf),
      text("tip", "URDF link that is the tool", &Config::tip),
      oneAJoint("home", "m or rad", within(-1e6, 1e6),
                "joint positions where a scene starts unless it names others", &Config::home),
      group<Config>("limits", "beyond those of the URDF",
                    {oneAJoint("acceleration", "m/s^2 or rad/s^2", above(0, 1e6),
                               "largest change of the command; absent: no limit",
                               &Config::max_acceleration)}),
      vector3("gravity_m_per_s2", "m/s^2", within(-100, 100),
              "in the base frame, for the covers of tactile modules", &Config::gravity_Base),
      optional(number("stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                      "compliance of the arm, in series with every obstacle; absent: rigid",
                      &Config::stiffness_N_per_m)),
      dynamicsSection(),
      canSection(),
      drivesSection(),
      sectionList("tactile_modules", {1, kMaxTactileModules}, "sensing covers, one around a link",
                  &Config::tactile_modules, tactileModuleKeys()),
      onlyEntryOf("tactile_modules", "tactile_module",
                  "in place of tactile_modules: the only one, with the same keys",
                  &Config::tactile_modules, tactileModuleKeys()),
  };
  const Table<Config> beside = {capsuleSections(), gpioSection(), realTimeSection()};
  return join(of_arm, moduleLostKeys(), beside);
}

}  // namespace

const std::vector<KeySpec>& robotKeys() {
  static const std::vector<KeySpec> keys = [] {
    std::vector<KeySpec> rows = specsOf(robotTable());
    RobotConfig config;
    addDefaults(rows, &config);
    return rows;
  }();
  return keys;
}

}  // namespace tactus
