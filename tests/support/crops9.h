#pragma once

#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/sim/plant_config.h"

/// The robot and the scenes of the independent reference, built without any file.
namespace tactus::test {

inline JointVector jointVector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<int>(values.size()));
}

inline SerialChain crops9Chain() {
  const Vector3 x = Vector3::UnitX();
  const Vector3 y = Vector3::UnitY();
  const Vector3 z = Vector3::UnitZ();
  const std::vector<Vector3> axes{z, z, y, z, y, z, x, z, y};
  const std::vector<double> offsets{0.0, 0.1, 0.12, 0.23, 0.38, 0.12, 0.18, 0.15, 0.12};
  std::vector<Joint> joints(9);
  for (int i = 0; i < 9; ++i) {
    joints[i].axis = axes[i];
    joints[i].X_ParentJoint.p_AB = Vector3(offsets[i], 0.0, i == 0 ? 0.8 : 0.0);
  }
  joints[0].type = JointType::kPrismatic;
  return SerialChain(joints, {8, {Matrix3::Identity(), Vector3(0.15, 0.0, 0.0)}});
}

inline ControllerConfig crops9Controller() {
  ControllerConfig config{.chain = crops9Chain()};
  config.q_start = jointVector(
      {0.05435, -0.55466, 0.46559, 0.45517, 0.44598, 0.91397, 1.07822, -0.66951, 0.58605});
  config.limits.upper = jointVector({0.4, 1.118, 0.89, 0.921, 0.852, 1.82, 2.174, 1.315, 1.172});
  config.limits.lower = -config.limits.upper;
  config.limits.max_velocity = JointVector::Constant(9, 5.0);
  config.limits.max_acceleration = JointVector::Constant(9, 200.0);
  config.task.components = {0, 1, 2};
  config.task.size = 3;
  config.task.trajectory.start_s = 0.5;
  Waypoint line;
  line.displacement_m = Vector3(0.0, 0.4436, 0.0);
  line.speed_m_per_s = 0.0537;
  config.task.trajectory.waypoints = {line};
  config.weights = JointVector::Ones(9);
  config.has_joint_limit_avoidance = true;
  return config;
}

/// With the tactile module and a law; the paper's parameters are the defaults.
inline ControllerConfig crops9Controller(Variant variant, bool estimated = false) {
  ControllerConfig config = crops9Controller();
  config.tactile_modules.emplace_back();
  config.tactile_modules.front().link.joint = 3;
  config.tactile_modules.front().length_m = 0.38;
  config.force_control.emplace();
  config.force_control->variant = variant;
  config.force_control->has_estimator = estimated;
  return config;
}

/// Noise and quantisation off.
inline PlantConfig crops9Plant(const std::vector<ObstacleConfig>& obstacles) {
  PlantConfig plant;
  plant.robot_stiffness_N_per_m = 7000.0;
  plant.modules.emplace_back().quantised = false;
  for (int cell = 0; cell < 8; ++cell) {
    const double x_m = cell < 4 ? 0.04 : 0.34;
    const double sign = cell % 2 == 0 ? 1.0 : -1.0;
    const bool along_y = cell % 4 < 2;
    plant.modules[0].channels.calibration.col(cell) =
        along_y ? Eigen::Vector4d(sign, 0.0, 0.0, sign * x_m)
                : Eigen::Vector4d(0.0, sign, -sign * x_m, 0.0);
  }
  plant.obstacles = obstacles;
  return plant;
}

inline ObstacleConfig band(double x_m, double y_m, double stiffness_N_per_m) {
  return {.x_m = x_m, .y_m = y_m, .stiffness_N_per_m = stiffness_N_per_m, .foam = {}};
}

inline std::vector<ObstacleConfig> scenario1() { return {band(0.70771, 0.00265, 60.0)}; }

inline std::vector<ObstacleConfig> scenario3() {
  return {{.x_m = 0.65413,
           .y_m = 0.06351,
           .stiffness_N_per_m = 17000.0,
           .foam = {{1400.0, 9.0}, {1800.0, 16.0}}}};
}

inline std::vector<ObstacleConfig> scenario2() {
  return {band(0.70333, -0.07897, 30.0), scenario3().front()};
}

}  // namespace tactus::test
