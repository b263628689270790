#include "tactus/scene/dynamics_loader.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>

#include "tactus/analysis/geared_contact.h"
#include "tactus/scene/tactile_loader.h"

namespace tactus {
namespace {

JointVector orAll(const std::optional<std::vector<double>>& values, double absent,
                  const LoadedRobot& robot, const char* key) {
  if (values)
    return toJointVector(*values, robot.root, std::string("dynamics.") + key, robot.chain);
  return JointVector::Constant(static_cast<Eigen::Index>(robot.chain.joints.size()), absent);
}

MassMatrix massMatrix(const LoadedRobot& robot, const JointVector& q) {
  return massMatrixAt(SerialChain(robot.chain.joints, robot.chain.tip), robot.bodies, q);
}

[[noreturn]] void failAtRobot(const LoadedRobot& robot, const std::string& key,
                              const std::string& problem, const std::string& expectation) {
  failAt(locate(robot.root, key), key, problem, "expected " + expectation);
}

bool isMassive(const MassMatrix& M, const JointVector& rotors) {
  MassMatrix all = M;
  all.diagonal() += rotors;
  return all.llt().info() == Eigen::Success;
}

/// The last joint that moves nothing is what makes it singular.
void checkMass(const LoadedRobot& robot, const MassMatrix& M, const JointVector& rotors) {
  if (isMassive(M, rotors)) return;
  MassMatrix all = M;
  all.diagonal() += rotors;
  Eigen::Index least = 0;
  all.diagonal().minCoeff(&least);
  failAtRobot(robot, "dynamics",
              fmt::format("joint {} moves no mass", inQuotes(robot.chain.joint_names[least])),
              "<inertial> in the URDF's links, or rotor_inertia");
}

/// The modes of the links behind motors that are held fast.
void checkGearModes(const LoadedRobot& robot, const MassMatrix& M, const JointVector& stiffness,
                    double period_s) {
  const double fastest_hz = gearModes_hz(M, stiffness).maxCoeff();
  if (fastest_hz <= 0.5 / period_s) return;
  failAtRobot(robot, "dynamics.gear_stiffness",
              fmt::format("a gear rings with {:.4g} Hz at the start", fastest_hz),
              fmt::format("at most {:.4g} Hz, half the rate of the cycles: softer gears, more mass "
                          "behind them, or rigid_gears",
                          0.5 / period_s));
}

/// The key that asks for gears; empty: none.
std::string coverBehindGears(const LoadedRobot& robot) {
  const std::vector<TactileModuleSection>& modules = robot.config.tactile_modules;
  for (std::size_t i = 0; i < modules.size(); ++i)
    if (modules[i].cover && modules[i].cover->behind_gears)
      return moduleKey(robot.root, i) + ".cover.behind_gears";
  return "";
}

ArmDynamicsConfig readDynamics(const LoadedRobot& robot, bool is_flexible) {
  const DynamicsSection& section = *robot.config.dynamics;
  ArmDynamicsConfig config;
  config.bodies = robot.bodies;
  config.rotor_inertia = orAll(section.rotor_inertia, 0.0, robot, "rotor_inertia");
  config.gear_damping = orAll(section.gear_damping, 0.0, robot, "gear_damping");
  config.gear_stiffness =
      orAll(is_flexible ? section.gear_stiffness : std::nullopt, kNoLimit, robot, "gear_stiffness");
  config.servo_bandwidth_hz = section.servo_bandwidth_hz;
  config.servo_integral_hz = section.servo_integral_hz;
  return config;
}

}  // namespace

std::optional<GearedLinks> loadGearedLinks(const LoadedRobot& robot, const JointVector& q_start) {
  const std::string key = coverBehindGears(robot);
  if (key.empty()) return std::nullopt;
  const auto& section = robot.config.dynamics;
  if (!section || !section->gear_stiffness)
    failAtRobot(robot, key, "the robot has no gear_stiffness", "one in its section dynamics");
  checkMass(robot, massMatrix(robot, q_start), JointVector::Zero(q_start.size()));
  return GearedLinks{robot.bodies, orAll(section->gear_stiffness, 0.0, robot, "gear_stiffness"),
                     orAll(section->gear_damping, 0.0, robot, "gear_damping")};
}

std::optional<ArmDynamicsConfig> loadDynamics(const YamlNode& scene, SimulatedArm arm,
                                              const LoadedRobot& robot, const JointVector& q_start,
                                              double period_s) {
  if (arm == SimulatedArm::kQuasiStatic) return std::nullopt;
  const auto& section = robot.config.dynamics;
  if (!section) {
    failAt(locate(scene, "simulation.arm"), "simulation.arm", "the robot has no section dynamics",
           "expected one in its robot.yaml, or quasi_static");
  }
  const bool is_flexible = arm == SimulatedArm::kFlexibleGears;
  if (is_flexible && !section->gear_stiffness) {
    failAt(locate(scene, "simulation.arm"), "simulation.arm", "the robot has no gear_stiffness",
           "expected one in `dynamics` of its robot.yaml, or rigid_gears");
  }
  const ArmDynamicsConfig config = readDynamics(robot, is_flexible);
  const MassMatrix M = massMatrix(robot, q_start);
  if (is_flexible) {
    checkMass(robot, M, JointVector::Zero(q_start.size()));  // of the links behind the springs
    checkGearModes(robot, M, config.gear_stiffness, period_s);
  } else {
    checkMass(robot, M, config.rotor_inertia);
  }
  return config;
}

JointVector rotorsOfLinks(const ArmDescription& arm) {
  const JointVector& rotors = arm.dynamics.rotor_inertia;
  return arm.has_gears ? JointVector(JointVector::Zero(rotors.size())) : rotors;
}

std::optional<ArmDescription> describeArm(const LoadedRobot& robot, const JointVector& q_start) {
  const auto& section = robot.config.dynamics;
  if (!section) return std::nullopt;
  ArmDescription arm;
  arm.has_gears = section->gear_stiffness.has_value();
  arm.dynamics = readDynamics(robot, arm.has_gears);
  arm.contact_stiffness_N_per_m = arm.has_gears
                                      ? section->contact_stiffness_N_per_m.value_or(kNoLimit)
                                      : robot.config.stiffness_N_per_m;
  arm.max_effort = robot.chain.max_effort;
  if (!isMassive(massMatrix(robot, q_start), rotorsOfLinks(arm))) return std::nullopt;
  return arm;
}

}  // namespace tactus
