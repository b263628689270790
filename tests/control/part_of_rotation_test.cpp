#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "support/period.h"
#include "support/random_robot.h"
#include "support/tactile_samples.h"
#include "tactus/control/controller.h"
#include "tactus/math/rotation.h"

/// Tasks with one or two of rx, ry and rz: the tool keeps them however far it has turned about the
/// rest, which nobody controls.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kTurnStart_s = 2.0;

/// Nine joints, so that much is left free.
ControllerConfig partController(test::Random& random, int rotations, ControlLevel level) {
  ControllerConfig config = test::randomController(random, 9, 3 + rotations);
  config.task.components = {5, 3, 0, 1, 2};
  if (rotations == 1) config.task.components = {random.integer(3, 5), 0, 1, 2};
  config.gains.task.drift_gain_per_s = 5.0;
  config.force_control.emplace();
  config.force_control->variant = Variant::kNullSpace;
  config.force_control->level = level;
  return config;
}

Waypoint turnBy(const Vector3& rotation_vector_rad) {
  Waypoint there;
  there.rotation_vector_rad = rotation_vector_rad;
  return there;
}

/// What turns the tool to its reference; the part that the task leaves free is anything.
Vector3 turnToReference(const Controller& controller, double t_s, const JointVector& q) {
  const ControllerConfig& config = controller.config();
  const Pose X_BaseStart = tipPose(config.chain, config.q_start);
  const Matrix3 R_d = Trajectory(config.task.trajectory, X_BaseStart).evaluate(t_s).R_BaseTool;
  return rotationVector(R_d * tipPose(config.chain, q).R_AB.transpose());
}

struct TurnFollowed {
  double largest_error = 0.0;      ///< m or rad, once it began to move
  double farthest_turned = 0.0;    ///< of what is free, rad
  double largest_step = 0.0;       ///< of the command between two cycles
  double fastest_rad_per_s = 0.0;  ///< of any joint
  int changes_of_sign = 0;         ///< of the turn to the reference
};

TurnFollowed followTurn(const Controller& controller, const JointVector& q_start) {
  ControllerState state = controller.initialState(q_start);
  ControllerOutput output;
  TurnFollowed followed;
  Vector3 before = turnToReference(controller, 0.0, q_start);
  JointVector velocity_before = JointVector::Zero(q_start.size());
  for (int cycle = 0; cycle * kPeriod_s < kTurnStart_s + 4.0; ++cycle) {
    const double t_s = cycle * kPeriod_s;
    const Vector3 turn = turnToReference(controller, t_s, state.q_desired);
    controller.update({state.q_desired, {test::touchAt(0.2, 0.0, 0.0, cycle + 1)}},
                      controller.initialGains(), t_s, kPeriod_s, state, output);
    if (turn.dot(before) < 0.0) ++followed.changes_of_sign;
    before = turn;
    if (t_s > kTurnStart_s) {
      followed.largest_error = std::max(followed.largest_error, output.error.norm());
      followed.farthest_turned = std::max(followed.farthest_turned, turn.norm());
      followed.largest_step = std::max(followed.largest_step,
                                       (output.velocity - velocity_before).cwiseAbs().maxCoeff());
    }
    followed.fastest_rad_per_s =
        std::max(followed.fastest_rad_per_s, output.velocity.cwiseAbs().maxCoeff());
    velocity_before = output.velocity;
  }
  return followed;
}

void expectFollowed(ControlLevel level, double velocity_gain_per_s, double most_error_rad) {
  test::Random random(611);
  double farthest = 0.0;
  int regular = 0;
  for (int i = 0; i < 40; ++i) {
    ControllerConfig config = partController(random, random.integer(1, 2), level);
    config.gains.force.velocity_gain_per_s = velocity_gain_per_s;
    Vector3 turn = random.vector<Vector3>(3, -0.4, 0.4);
    for (int k = 0; k < 3; ++k)
      if (!config.task.controls(3 + k)) turn[k] *= 5.0;
    if (turn.norm() > std::numbers::pi) continue;
    config.task.trajectory = {kTurnStart_s, {turnBy(turn)}};
    const TurnFollowed followed = followTurn(Controller(config), config.q_start);
    if (followed.fastest_rad_per_s > 2.0) continue;  // an Euler step would be far off
    ++regular;
    farthest = std::max(farthest, followed.farthest_turned);
    EXPECT_LT(followed.largest_error, most_error_rad) << i;
  }
  EXPECT_GT(regular, 20);
  EXPECT_GT(farthest, 1.0) << "or nothing was tested";
}

TEST(PartOfRotation, IsKeptWhileTheReferenceTurnsAboutTheRest) {
  expectFollowed(ControlLevel::kVelocity, 200.0, 5e-4);
}

/// With next to no k_v, so that what is known has to be right.
TEST(PartOfRotation, IsKeptAtTheAccelerationLevel) {
  expectFollowed(ControlLevel::kAcceleration, 1e-3, 1e-3);
}

/// Where the rotation vector changes its sign the command goes on as it was.
TEST(PartOfRotation, GoesOverHalfATurn) {
  test::Random random(612);
  int over = 0;
  for (int i = 0; i < 200; ++i) {
    ControllerConfig config = partController(random, random.integer(1, 2), ControlLevel::kVelocity);
    const JointVector q = config.q_start + random.vector(9, -1.5, 1.5);
    Vector3 turn = Vector3::Zero();
    for (int k = 0; k < 3; ++k)
      if (!config.task.controls(3 + k)) turn[k] = random.uniform(-2.0, 2.0);
    config.task.trajectory = {kTurnStart_s, {turnBy(turn)}};
    const TurnFollowed followed = followTurn(Controller(config), q);
    if (followed.fastest_rad_per_s > 20.0 || followed.farthest_turned < 3.14) continue;
    ++over;
    EXPECT_GT(followed.changes_of_sign, 0) << i;
    EXPECT_LT(followed.largest_error, 1e-3) << i;
    EXPECT_LT(followed.largest_step, 2e-3) << i;
  }
  EXPECT_GT(over, 5);
}

}  // namespace
}  // namespace tactus
