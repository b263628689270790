#include "tactus/scene/simulation_keys.h"

#include "tactus/scene/cover_keys.h"
#include "tactus/scene/shape_keys.h"

namespace tactus {
namespace {

using namespace keys;

Table<FoamLayer> foamKeys() {
  return {
      required(number("stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m), "of the layer",
                      &FoamLayer::stiffness_N_per_m)),
      required(number("until_force_N", "N", above(0, 1e5), "force at which the layer is compressed",
                      &FoamLayer::until_force_N)),
  };
}

Table<Swing> swingKeys() {
  return {
      number("x_m", "m", within(-100, 100), "amplitude", &Swing::x_m),
      number("y_m", "m", within(-100, 100), "amplitude", &Swing::y_m),
      number("z_m", "m", within(-100, 100), "amplitude", &Swing::z_m),
      required(number("frequency_hz", "Hz", above(0, 1000), "of the sine", &Swing::frequency_hz)),
  };
}

/// One of them, or x_m and y_m.
Table<ObstacleConfig> shapeKeys() {
  using Config = ObstacleConfig;
  return {
      optional(number("x_m", "m", within(-100, 100),
                      "place of a vertical line, base frame; absent: one of the shapes",
                      &Config::x_m)),
      optional(number("y_m", "m", within(-100, 100), "place of a vertical line, base frame",
                      &Config::y_m)),
      optional(section("sphere", "in place of x_m and y_m: a ball", &Config::sphere, sphereKeys())),
      optional(section("plane", "in place of x_m and y_m: all that is behind a plane",
                       &Config::plane, planeKeys())),
      optional(section("line", "in place of x_m and y_m: an endless line of any direction",
                       &Config::line, obstacleLineKeys())),
      optional(section("post", "in place of x_m and y_m: a round bar of finite length",
                       &Config::post, postKeys())),
  };
}

Table<ObstacleConfig> springKeys() {
  using Config = ObstacleConfig;
  return {
      required(number("stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                      "of the solid part", &Config::stiffness_N_per_m)),
      sectionList("foam", {0, 16}, "layers before the solid part, outermost first", &Config::foam,
                  foamKeys()),
      number("appears_s", "s", within(0, kMaxTime_s), "absent before", &Config::appears_s),
      optional(number("vanishes_s", "s", above(0, kMaxTime_s), "absent from then on",
                      &Config::vanishes_s)),
      number("friction_coefficient", "", within(0, 10), "mu of the cover on it; 0: slides freely",
             &Config::friction_coefficient),
      optional(number("slide_force_N", "N", above(0, 1e5),
                      "largest force that it bears: beyond it its foot slides away; absent: it "
                      "stands",
                      &Config::slide_force_N)),
      optional(number("shear_stiffness_N_per_m", "N/m", above(0, kMaxStiffness_N_per_m),
                      "along the cover while it sticks; absent: stiffness_N_per_m",
                      &Config::shear_stiffness_N_per_m)),
      optional(section("swing", "motion to and fro around the place, along a sine", &Config::swing,
                       swingKeys())),
  };
}

Table<ObstacleConfig> obstacleKeys() { return join(shapeKeys(), springKeys()); }

Table<Trouble> kindAndTimes() {
  return {
      required(choice(
          "kind",
          "what happens. To frames: drop, delay, reorder, corrupt, duplicate. To a bus: bus_off, "
          "power_cut. To a drive: drive_fault; ignore_commands, it obeys neither control words nor "
          "setpoints and keeps its last velocity; freeze_feedback, it sends the status and "
          "position of the beginning; nonsense_status, its status word is not in CiA 402; boot_up, "
          "it sends one boot-up message and runs on; heartbeat_only, neither missing SYNC nor "
          "missing setpoints stop it. To the line: emergency_stop",
          &Trouble::kind, kTroubleWords)),
      required(number("from_s", "s", within(0, kMaxTime_s), "since the first drive was enabled",
                      &Trouble::from_s)),
      required(
          number("until_s", "s", within(0, kMaxTime_s), "end of the trouble", &Trouble::until_s)),
  };
}

Table<TroubleSection> troubleKeys() {
  using Config = TroubleSection;
  return join(inside(&Config::trouble, kindAndTimes()),
              Table<Config>{
                  text("interface", "bus of the robot that it happens to; none with emergency_stop",
                       &Config::interface),
                  integer("id", within(0, 0x7FF),
                          "of the frames, or node id of the drive; absent or 0: all of the bus",
                          &Config::id),
                  number("delay_s", "s", above(0, 0.25), "how late frames come, with delay only",
                         &Config::delay_s),
              });
}

Row<SimulatedModuleConfig> eachChannel(const std::string& key, const std::string& unit,
                                       const std::string& doc,
                                       std::vector<double> SimulatedModuleConfig::*member) {
  Row<SimulatedModuleConfig> row = optional(value(ValueType::kNumberList, key, unit, doc, member));
  row.spec.range = within(-100, 100);
  row.spec.count = {8, 8};
  return row;
}

Table<SimulatedModuleConfig> imperfectionKeys() {
  using Config = SimulatedModuleConfig;
  return {
      boolean("quantised", "24-bit channels", &Config::quantised),
      number("noise_N", "N", within(0, 100), "standard deviation of one channel", &Config::noise_N),
      number("lost_share", "", within(0, 1), "share of the samples that get lost",
             &Config::lost_share),
      number("jitter_s", "s", within(0, 1),
             "samples come late by up to that, at the latest with the next one", &Config::jitter_s),
      integer("seed", within(0, 1e15), "of noise, losses and jitter", &Config::seed),
      eachChannel("channel_gains", "", "error of calibration: what a channel reads of 1 N",
                  &Config::channel_gains),
      eachChannel("channel_drifts_N_per_s", "N/s", "of each channel since the start",
                  &Config::channel_drifts_N_per_s),
      number("direction_error_rad", "rad", within(-4, 4), "by which the cells are turned about x",
             &Config::direction_error_rad),
  };
}

Row<SimulationSection> moduleSection() {
  const Table<SimulationSection> cutoff = {
      number("filter_cutoff_hz", "Hz", within(0.1, 1e5),
             "of its own filter; absent: as robot.yaml says", &SimulationSection::filter_cutoff_hz),
      optional(section("cover", "absent: as robot.yaml says", &SimulationSection::cover,
                       coverLoadKeys()))};
  return group("tactile_module", "imperfections of the simulated tactile modules",
               join(cutoff, inside(&SimulationSection::module, imperfectionKeys())));
}

Table<SimulatedDrivesSection> driveEffectKeys() {
  using Config = SimulatedDrivesSection;
  return {
      optional(number("bandwidth_hz", "Hz", above(0, 1e4),
                      "of a second-order velocity loop, in place of drive_lag_s; of a quasi-static "
                      "arm alone",
                      &Config::bandwidth_hz)),
      optional(number("damping_ratio", "", within(0.05, 10), "of that loop; absent: 0.7",
                      &Config::damping_ratio)),
      number("dead_time_s", "s", within(0, 0.1), "by which setpoints come late",
             &Config::dead_time_s),
      oneAJoint("max_acceleration", "m/s^2 or rad/s^2", above(0, 1e6),
                "of the drive's own ramp; absent: none", &Config::max_acceleration),
      oneAJoint("max_torque", "Nm or N", above(0, 1e9),
                "at the joint, of an arm with mass; absent: no limit", &Config::max_torque),
      oneAJoint("coulomb_friction", "Nm or N", within(0, 1e6),
                "of motor and gear, at the joint, of an arm with mass; absent: none",
                &Config::coulomb_friction),
      oneAJoint("viscous_friction", "Nm s/rad or N s/m", within(0, 1e9), "likewise",
                &Config::viscous_friction),
      oneAJoint("backlash", "rad or m", within(0, 0.1),
                "whole play of the gear, at the joint, with flexible_gears; absent: none",
                &Config::backlash),
      choice("feedback",
             "motor: drives report where their motors are; link: what is behind their flexible "
             "gears",
             &Config::feedback, kFeedbackWords),
  };
}

Table<SimulationSection> simulationKeys() {
  using Config = SimulationSection;
  return {
      required(number("duration_s", "s", above(0, kMaxTime_s),
                      "length of a simulated run; tactusd goes on until it is stopped",
                      &Config::duration_s)),
      choice("arm",
             "quasi_static: it follows its drives with their lag. rigid_gears: bodies with the "
             "masses of the URDF and `dynamics` of robot.yaml, moved by velocity servos. "
             "flexible_gears: each behind the spring of its gear",
             &Config::arm, kArmWords),
      number("drive_lag_s", "s", within(0, 1),
             "lag of the simulated drives of a quasi-static arm; absent: as robot.yaml says",
             &Config::drive_lag_s),
      optional(section("drives", "what drives do beside following; absent: nothing",
                       &Config::drives, driveEffectKeys())),
      moduleSection(),
      oneAJoint("link_length_errors_m", "m", within(-10, 10),
                "by how much the simulated link behind each joint is longer, up to the next joint "
                "or the tool, than the URDF says; the controller does not know; absent: 0",
                &Config::link_length_errors_m),
      sectionList("obstacles", {0, 64}, "what pushes on the cover, and on collision_capsules",
                  &Config::obstacles, obstacleKeys()),
      sectionList("troubles", {0, 64},
                  "what goes wrong on the buses of tactus plant; simulate has none",
                  &Config::troubles, troubleKeys()),
  };
}

}  // namespace

Row<SceneConfig> simulationSection() {
  return required(section("simulation", "the world that the robot meets", &SceneConfig::simulation,
                          simulationKeys()));
}

}  // namespace tactus
