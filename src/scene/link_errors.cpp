#include "tactus/scene/link_errors.h"

#include <fmt/format.h>

namespace tactus {
namespace {

constexpr double kShortestLink_m = 1e-4;  ///< shorter ones have no direction

}  // namespace

std::optional<SerialChain> loadPlantChain(const YamlNode& scene,
                                          const std::optional<std::vector<double>>& errors_m,
                                          const LoadedRobot& robot) {
  if (!errors_m) return std::nullopt;
  const std::string path = "simulation.link_length_errors_m";
  toJointVector(*errors_m, scene, path, robot.chain);  // which counts them
  std::vector<Joint> joints = robot.chain.joints;
  AttachedFrame tip = robot.chain.tip;
  for (std::size_t i = 0; i < joints.size(); ++i) {
    const double error_m = (*errors_m)[i];
    if (error_m == 0.0) continue;
    Vector3& way = i + 1 < joints.size() ? joints[i + 1].X_ParentJoint.p_AB : tip.X_JointFrame.p_AB;
    const double length_m = way.norm();
    if (!(length_m > kShortestLink_m) || !(length_m + error_m > kShortestLink_m)) {
      const std::string key = fmt::format("{}[{}]", path, i);
      failAt(locate(scene, key), key,
             fmt::format("the link behind joint {} is {:.4g} m long",
                         inQuotes(robot.chain.joint_names[i]), length_m),
             "expected 0, or a link that has a length with the error, too");
    }
    way *= (length_m + error_m) / length_m;
  }
  return SerialChain(joints, tip);
}

}  // namespace tactus
