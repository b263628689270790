#include "tactus/scene/scene.h"

namespace tactus {

std::vector<std::string> stageNames(const ControllerConfig& config) {
  std::vector<std::string> names = {"trajectory", "kinematics", "pseudoinverse"};
  if (config.has_joint_limit_avoidance) names.push_back("joint_limit_avoidance");
  if (config.q_posture) names.push_back("posture");
  if (!config.tactile_modules.empty()) names.push_back("tactile_module");
  if (config.force_control) {
    names.insert(names.end(), {"contact_space", "contact_transition"});
    const bool is_acceleration = config.force_control->level == ControlLevel::kAcceleration;
    names.push_back(is_acceleration ? "acceleration_law" : "control_law");
    if (config.force_control->has_estimator) names.push_back("stiffness_estimator");
    if (config.force_control->variant == Variant::kNullLimit) {
      names.push_back("approach_limit");
    }
  }
  if (config.clearance) names.push_back("clearance");
  names.insert(names.end(), {"limits", "telemetry"});
  return names;
}

std::vector<std::string> hardwareStageNames(const HardwareConfig& hardware) {
  std::vector<std::string> names = {"can"};
  if (hardware.gpio) names.push_back("gpio");
  return names;
}

}  // namespace tactus
