#include "tactus/control/link_observer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/random.h"

/// Two carriages on crossed rails, which do not feel one another: each is an oscillator by hand.
namespace tactus {
namespace {

SerialChain crossedRails() {
  std::vector<Joint> joints(2);
  for (Joint& joint : joints) joint.type = JointType::kPrismatic;
  joints[0].axis = Vector3::UnitY();
  joints[1].axis = Vector3::UnitZ();
  return SerialChain(joints, {1, {}});
}

TEST(LinkObserver, RingsAsTheLinkDoesAndComesToItsMotor) {
  const SerialChain chain = crossedRails();
  test::Random random(941);
  for (int i = 0; i < 10; ++i) {
    GearedLinks links{{{random.uniform(1.0, 5.0)}, {random.uniform(1.0, 5.0)}}, {}, {}};
    const Eigen::Vector2d mass(links.bodies[0].mass_kg + links.bodies[1].mass_kg,
                               links.bodies[1].mass_kg);
    links.gear_stiffness = random.vector(2, 1000.0, 20000.0);
    links.gear_damping = random.vector(2, 5.0, 40.0);
    LinkObserverState state;
    constexpr double kStep_s = 1e-5;
    observeLinks(chain, links, JointVector::Zero(2), kStep_s, state);
    const JointVector motor = random.vector(2, -0.01, 0.01);
    state.q_motor = motor;  // it jumped, without a speed that damps
    for (int step = 1; step <= 20000; ++step) {
      observeLinks(chain, links, motor, kStep_s, state);
      if (step % 1000 != 0) continue;
      for (int j = 0; j < 2; ++j) {
        const double t_s = step * kStep_s;
        const double fade = 0.5 * links.gear_damping[j] / mass[j];
        const double omega = std::sqrt(links.gear_stiffness[j] / mass[j] - fade * fade);
        const double ring =
            std::exp(-fade * t_s) * (std::cos(omega * t_s) + fade / omega * std::sin(omega * t_s));
        ASSERT_NEAR(state.q[j], motor[j] * (1.0 - ring), 0.06 * std::abs(motor[j])) << t_s;
      }
    }
  }
}

/// A gear that damps takes its link along: M v = D (q_motor_dot - v) dt in the first step.
TEST(LinkObserver, IsTakenAlongByTheMotorsSpeed) {
  const SerialChain chain = crossedRails();
  GearedLinks links{{{2.0}, {1.0}}, JointVector::Constant(2, 1e-9), JointVector{{30.0, 5.0}}};
  constexpr double kStep_s = 0.01;
  LinkObserverState state;
  observeLinks(chain, links, JointVector::Zero(2), kStep_s, state);
  const JointVector speed{{0.2, -0.1}};
  observeLinks(chain, links, kStep_s * speed, kStep_s, state);
  EXPECT_NEAR(state.velocity[0], 0.2 * 30.0 * kStep_s / (3.0 + 30.0 * kStep_s), 1e-9);
  EXPECT_NEAR(state.velocity[1], -0.1 * 5.0 * kStep_s / (1.0 + 5.0 * kStep_s), 1e-9);
}

TEST(LinkObserver, StaysAtAMotorThatRestsAndStandsAnyGear) {
  const SerialChain chain = crossedRails();
  const JointVector motor{{0.3, -0.2}};
  GearedLinks links{{{2.0}, {1.0}}, JointVector::Constant(2, 1e12), JointVector::Zero(2)};
  LinkObserverState state;
  for (int cycle = 0; cycle < 100; ++cycle) observeLinks(chain, links, motor, 0.001, state);
  EXPECT_EQ(state.q, motor);
  for (int cycle = 0; cycle < 100; ++cycle) observeLinks(chain, links, 2.0 * motor, 0.001, state);
  EXPECT_LT((state.q - 2.0 * motor).norm(), 1e-6) << "stiff as it is";
}

}  // namespace
}  // namespace tactus
