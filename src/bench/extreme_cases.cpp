#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/bench/extreme_case.h"
#include "tactus/math/serial_chain.h"

namespace tactus {
namespace {

// The line of the base scene.
constexpr double kWay_m = 0.4436;
constexpr double kSpeed_m_per_s = 0.0537;
constexpr double kStartAndRamps_s = 1.5;
constexpr double kAfterWay_s = 4.5;
constexpr double kBaseDuration_s = 13.0;

std::string obstacleText(double x_m, double y_m, double stiffness_N_per_m,
                         const std::string& rest) {
  return fmt::format("{{x_m: {}, y_m: {}, stiffness_N_per_m: {}{}}}", x_m, y_m, stiffness_N_per_m,
                     rest);
}

}  // namespace

std::vector<ExtremeCase> extremeCases() {
  std::vector<ExtremeCase> cases;
  addContactCases(cases);
  addObstacleCases(cases);
  addSensorCases(cases);
  addPoseCases(cases);
  addGainCases(cases);
  addLongCases(cases);
  return cases;
}

std::string bandText(double stiffness_N_per_m, const std::string& rest) {
  return obstacleText(0.70333, -0.07897, stiffness_N_per_m, rest);
}

std::string profileText(double stiffness_N_per_m, const std::string& rest) {
  return obstacleText(0.65413, 0.06351, stiffness_N_per_m, rest);
}

Override obstaclesAre(const std::vector<std::string>& texts) {
  return {"simulation.obstacles", fmt::format("[{}]", fmt::join(texts, ", "))};
}

void setSpeed(double factor, std::vector<Override>& overrides) {
  const double speed_m_per_s = factor * kSpeed_m_per_s;
  const double duration_s = kStartAndRamps_s + kWay_m / speed_m_per_s + kAfterWay_s;
  overrides.push_back({"task.trajectory.line.speed_m_per_s", fmt::format("{}", speed_m_per_s)});
  overrides.push_back({"simulation.duration_s",
                       fmt::format("{}", std::max(kBaseDuration_s, std::ceil(duration_s)))});
}

void setHold(double duration_s, std::vector<Override>& overrides) {
  overrides.push_back({"task.trajectory.line", "~"});
  overrides.push_back({"task.trajectory.hold", "{}"});
  overrides.push_back({"simulation.duration_s", fmt::format("{}", duration_s)});
}

void makeArmRigid(Scene& scene) { scene.plant.robot_stiffness_N_per_m = kNoLimit; }

void addBeside(const Beside& place, double stiffness_N_per_m, double swing_m, double frequency_hz,
               double vanishes_s, Scene& scene) {
  const TactileModuleConfig& module = scene.controller.tactile_modules.front();
  ChainPose pose;
  scene.controller.chain.computePose(scene.controller.q_start, pose);
  const Pose X = framePose(pose, module.link);
  const Vector3 axis = X.R_AB.col(0);
  const Vector3 left = Vector3(-axis.y(), axis.x(), 0.0).normalized();
  const Vector3 away = place.side * left;
  const Vector3 point = X.p_AB + place.along_share * module.length_m * axis +
                        (scene.plant.modules[0].cover_radius_m + place.gap_m) * away;
  ObstacleConfig obstacle;
  obstacle.x_m = point.x();
  obstacle.y_m = point.y();
  obstacle.stiffness_N_per_m = stiffness_N_per_m;
  obstacle.vanishes_s = vanishes_s;
  if (frequency_hz > 0.0) obstacle.swing = {-swing_m * away.x(), -swing_m * away.y(), frequency_hz};
  scene.plant.obstacles.push_back(obstacle);
}

}  // namespace tactus
