#include "tactus/scene/drive_effects_loader.h"

#include <fmt/format.h>

namespace tactus {
namespace {

constexpr const char* kDrives = "simulation.drives";

struct DriveChecks {
  const YamlNode& scene;
  const LoadedRobot& robot;

  [[noreturn]] void fail(const std::string& key, const std::string& problem,
                         const std::string& expectation) const {
    const std::string path = fmt::format("{}.{}", kDrives, key);
    failAt(locate(scene, path), path, problem, "expected " + expectation);
  }

  JointVector oneAJoint(const std::optional<std::vector<double>>& values, const char* key) const {
    if (!values) return {};
    return toJointVector(*values, scene, fmt::format("{}.{}", kDrives, key), robot.chain);
  }
};

void checkLoop(const DriveChecks& checks, const SimulationSection& simulation, double period_s) {
  if (simulation.arm != SimulatedArm::kQuasiStatic)
    checks.fail("bandwidth_hz", "an arm with mass has servos of its own",
                "servo_bandwidth_hz in `dynamics` of its robot.yaml, or arm: quasi_static");
  const double bandwidth_hz = *simulation.drives->bandwidth_hz;
  if (bandwidth_hz <= 0.5 / period_s) return;
  checks.fail("bandwidth_hz", fmt::format("{} Hz is too high", bandwidth_hz),
              fmt::format("at most {:.4g} Hz, half the rate of the cycles", 0.5 / period_s));
}

void checkArm(const DriveChecks& checks, const SimulationSection& simulation) {
  const SimulatedDrivesSection& drives = *simulation.drives;
  const auto refuse = [&](bool is_given, const char* key, const char* problem,
                          const char* expectation) {
    if (is_given) checks.fail(key, problem, expectation);
  };
  if (simulation.arm == SimulatedArm::kQuasiStatic) {
    constexpr const char* kProblem = "a quasi-static arm has no torques";
    constexpr const char* kExpectation = "arm: rigid_gears or flexible_gears";
    refuse(drives.max_torque.has_value(), "max_torque", kProblem, kExpectation);
    refuse(drives.coulomb_friction.has_value(), "coulomb_friction", kProblem, kExpectation);
    refuse(drives.viscous_friction.has_value(), "viscous_friction", kProblem, kExpectation);
  }
  if (simulation.arm == SimulatedArm::kFlexibleGears) return;
  constexpr const char* kProblem = "its gears do not give way";
  refuse(drives.backlash.has_value(), "backlash", kProblem, "arm: flexible_gears");
  refuse(drives.feedback == EncoderSide::kLink, "feedback", kProblem, "arm: flexible_gears");
}

void checkRotors(const DriveChecks& checks, const ArmDynamicsConfig& dynamics) {
  for (Eigen::Index i = 0; i < dynamics.backlash.size(); ++i)
    if (dynamics.backlash[i] > 0.0 && dynamics.rotor_inertia[i] <= 0.0)
      checks.fail(fmt::format("backlash[{}]", i), "its motor has no mass",
                  "rotor_inertia in `dynamics` of the robot, or no play");
}

}  // namespace

void loadDriveEffects(const YamlNode& scene, const SimulationSection& simulation,
                      const LoadedRobot& robot, double period_s, PlantConfig& plant) {
  if (simulation.arm != SimulatedArm::kQuasiStatic && simulation.drive_lag_s.value_or(0.0) > 0.0) {
    const std::string key = "simulation.drive_lag_s";
    failAt(locate(scene, key), key, "an arm with mass has servos of its own",
           "expected servo_bandwidth_hz in `dynamics` of its robot.yaml, or arm: quasi_static");
  }
  if (!simulation.drives) return;
  const SimulatedDrivesSection& section = *simulation.drives;
  const DriveChecks checks{scene, robot};
  if (section.bandwidth_hz) checkLoop(checks, simulation, period_s);
  if (section.damping_ratio && !section.bandwidth_hz)
    checks.fail("damping_ratio", "damps nothing", "bandwidth_hz beside it");
  checkArm(checks, simulation);
  DriveEffectsConfig& drives = plant.drives;
  drives.dead_time_s = section.dead_time_s;
  drives.max_acceleration = checks.oneAJoint(section.max_acceleration, "max_acceleration");
  if (section.bandwidth_hz) drives.loop = VelocityLoopConfig{.bandwidth_hz = *section.bandwidth_hz};
  if (section.damping_ratio) drives.loop->damping_ratio = *section.damping_ratio;
  drives.reports_links = section.feedback == EncoderSide::kLink;
  if (!plant.dynamics) return;
  ArmDynamicsConfig& dynamics = *plant.dynamics;
  dynamics.max_torque = checks.oneAJoint(section.max_torque, "max_torque");
  dynamics.coulomb_friction = checks.oneAJoint(section.coulomb_friction, "coulomb_friction");
  dynamics.viscous_friction = checks.oneAJoint(section.viscous_friction, "viscous_friction");
  dynamics.backlash = checks.oneAJoint(section.backlash, "backlash");
  checkRotors(checks, dynamics);
}

}  // namespace tactus
