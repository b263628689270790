#include <gtest/gtest.h>

#include <vector>

#include "support/shipped_scene.h"
#include "tactus/math/rotation.h"
#include "tactus/run/simulation.h"

/// A tool whose orientation belongs to the task, too, held by a band that vanishes.
namespace tactus {
namespace {

constexpr double kVanishes_s = 6.5;  // the path has ended at 6

/// The largest speeds of the tool from then on, position and rotation.
struct ToolSpeeds {
  double position_m_per_s = 0.0, rotation_rad_per_s = 0.0;
};

ToolSpeeds returnSpeeds(const std::string& variant, const std::vector<Override>& task) {
  std::vector<Override> overrides = {{"controller.variant", variant},
                                     {"controller.activation_force_N", "3.8"},
                                     {"redundancy.joint_limit_avoidance", "{}"},
                                     {"simulation.obstacles[0].vanishes_s", "6.5"},
                                     {"simulation.duration_s", "10"},
                                     {"task.components", "[x, y, z, rx, ry, rz]"}};
  overrides.insert(overrides.end(), task.begin(), task.end());
  const Scene scene = test::shippedScene("robots/kuka_iiwa7_contact", overrides);
  const SerialChain& chain = scene.controller.chain;
  ToolSpeeds speeds;
  Pose before;
  simulate(scene, [&](const CycleRecord& record) {
    ChainPose pose;
    chain.computePose(Eigen::Map<const Eigen::VectorXd>(record.q, chain.size()), pose);
    const Pose X_BaseTool = framePose(pose, chain.tip());
    if (record.t_s > kVanishes_s) {
      const Vector3 turn = rotationVector(X_BaseTool.R_AB * before.R_AB.transpose());
      const double way_m = (X_BaseTool.p_AB - before.p_AB).norm();
      speeds.position_m_per_s = std::max(speeds.position_m_per_s, way_m / scene.period_s);
      speeds.rotation_rad_per_s = std::max(speeds.rotation_rad_per_s, turn.norm() / scene.period_s);
    }
    before = X_BaseTool;
  });
  return speeds;
}

struct ReturnCase {
  std::string variant;
  double cap_m_per_s, cap_rad_per_s;
};

class ReturnSpeedScene : public testing::TestWithParam<ReturnCase> {};

TEST_P(ReturnSpeedScene, OfAnOrientationHasAKeyOfItsOwn) {
  const auto& [variant, cap_m_per_s, cap_rad_per_s] = GetParam();
  const ToolSpeeds free = returnSpeeds(variant, {});
  EXPECT_GT(free.position_m_per_s, 1.1 * cap_m_per_s);
  EXPECT_GT(free.rotation_rad_per_s, 1.1 * cap_rad_per_s);
  const ToolSpeeds slow =
      returnSpeeds(variant, {{"task.max_return_speed_m_per_s", std::to_string(cap_m_per_s)},
                             {"task.max_return_speed_rad_per_s", std::to_string(cap_rad_per_s)}});
  EXPECT_LE(slow.position_m_per_s, 1.02 * cap_m_per_s);
  EXPECT_LE(slow.rotation_rad_per_s, 1.02 * cap_rad_per_s);
}

INSTANTIATE_TEST_SUITE_P(Variants, ReturnSpeedScene,
                         testing::Values(ReturnCase{"task_space", 0.1, 0.3},
                                         ReturnCase{"null_task", 0.1, 0.25},
                                         ReturnCase{"joint_space", 0.03, 0.06}),
                         [](const auto& test) { return test.param.variant; });

}  // namespace
}  // namespace tactus
