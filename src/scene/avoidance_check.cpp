#include "tactus/scene/avoidance_check.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "tactus/control/clearance_cost.h"
#include "tactus/scene/drawn_configurations.h"
#include "tactus/scene/number_text.h"

namespace tactus {
namespace {

/// How fast what the pairs lack, in the worst mixture of them, is made good with a gain of 1/s, in
/// 1/s: the largest eigenvalue of what their costs of 1 m do to their distances.
double fastestOfPairs(const ControllerConfig& controller, const BodyDistances& distances,
                      const JointVector& q) {
  const ScaledVector inv_sqrt_weights =
      scaled(controller.weights.cwiseSqrt().cwiseInverse(), ScaledVector::Ones());
  const double reach_m = controller.clearance->avoid->distance_m;
  ChainPose pose;
  controller.chain.computePose(q, pose);
  NearBodies near;
  distances.findNear(pose, reach_m, near);
  using Square = Eigen::Matrix<double, kMaxJoints, kMaxJoints>;
  Square sum = Square::Zero();
  forEachThatCosts(distances, pose, near, reach_m, [&](double share, const NearBody& body) {
    const ScaledVector gradient = distances.gradient(pose, body).cwiseProduct(inv_sqrt_weights);
    sum += share / (kClearanceLever_m * kClearanceLever_m) * gradient * gradient.transpose();
  });
  return Eigen::SelfAdjointEigenSolver<Square>(sum, Eigen::EigenvaluesOnly)
      .eigenvalues()
      .maxCoeff();
}

}  // namespace

void checkAvoidance(const YamlNode& root, const ControllerConfig& controller, double period_s) {
  if (!controller.clearance || !controller.clearance->avoid) return;
  if (controller.task.size == controller.chain.size())
    failAt(locate(root, "clearance.avoid"), "clearance.avoid",
           "the task takes all joints, so that nothing goes out of the way",
           "expected fewer task.components, or no such section");
  const double gain_per_s = controller.clearance->avoid->gain_per_s;
  const BodyDistances distances(controller.chain, *controller.clearance);
  double fastest = fastestOfPairs(controller, distances, controller.q_start);
  for (int number = 1; number <= kDrawnConfigurations; ++number) {
    const JointVector q = drawnConfiguration(controller.chain, controller.limits, number);
    fastest = std::max(fastest, fastestOfPairs(controller, distances, q));
  }
  if (gain_per_s * fastest * period_s <= 1.0) return;
  const std::string key = "clearance.avoid.gain_per_s";
  failAt(locate(root, key), key,
         fmt::format("{} is too steep: with this arm's levers the null space would overshoot in a "
                     "cycle",
                     gain_per_s),
         fmt::format("expected at most {:.4g} with this period_s",
                     kInsideLimit / (fastest * period_s)));
}

}  // namespace tactus
