#include "tactus/sim/velocity_loop.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace tactus {
namespace {

constexpr double kLoopStep_s = 0.001;

JointVector one(double q) { return JointVector::Constant(1, q); }

/// 1 - exp(-d w t) (cos w_d t + d w / w_d sin w_d t), and its like beyond d = 1.
double unitStep(double w, double d, double t_s) {
  if (d == 1.0) return 1.0 - std::exp(-w * t_s) * (1.0 + w * t_s);
  if (d < 1.0) {
    const double w_d = w * std::sqrt(1.0 - d * d);
    return 1.0 - std::exp(-d * w * t_s) * (std::cos(w_d * t_s) + d * w / w_d * std::sin(w_d * t_s));
  }
  const double root = std::sqrt(d * d - 1.0);
  const double fast = w * (d + root), slow = w * (d - root);
  return 1.0 + (slow * std::exp(-fast * t_s) - fast * std::exp(-slow * t_s)) / (fast - slow);
}

TEST(VelocityLoop, AnswersAStepAsTheClosedFormSays) {
  for (const double bandwidth_hz : {0.5, 8.0, 100.0, 500.0}) {
    for (const double d : {0.05, 0.3, 0.7, 1.0, 1.5, 10.0}) {
      VelocityLoop loop({bandwidth_hz, d}, one(0.0), kLoopStep_s);
      JointVector q = one(0.0);
      for (int i = 1; i <= 2000; ++i) {
        loop.update(one(1.0), q);
        ASSERT_NEAR(q[0], unitStep(2.0 * std::numbers::pi * bandwidth_hz, d, i * kLoopStep_s), 1e-9)
            << bandwidth_hz << " " << d << " " << i;
      }
    }
  }
}

/// Following a ramp it lags by 2 d / w times the speed.
TEST(VelocityLoop, LagsBehindARampByItsTimeConstant) {
  const double w = 2.0 * std::numbers::pi * 8.0;
  VelocityLoop loop({8.0, 0.7}, one(0.3), kLoopStep_s);
  JointVector q = one(0.3);
  double q_d = 0.3;
  for (int i = 0; i < 3000; ++i) loop.update(one(q_d += 0.2 * kLoopStep_s), q);
  EXPECT_NEAR(q_d - q[0], 0.2 * (2.0 * 0.7 / w - 0.5 * kLoopStep_s), 1e-5)
      << "half a step less, as q_d stands at the step's end all along";
}

}  // namespace
}  // namespace tactus
