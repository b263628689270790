#include "tactus/control/several_contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "support/allocation_guard.h"
#include "support/closed_loop.h"
#include "support/random_robot.h"

/// Two contacts at once, before a simulated arm that can be worked out by hand.
namespace tactus {
namespace {

constexpr double kCycle_s = 0.001;

/// A carriage along y with a slide along x on it, each with a tactile module along x: both modules
/// move alike in y.
ControllerConfig slide() {
  std::vector<Joint> joints(2);
  joints[0].type = joints[1].type = JointType::kPrismatic;
  joints[0].axis = Vector3::UnitY();
  joints[1].axis = Vector3::UnitX();
  joints[1].X_ParentJoint.p_AB = Vector3(1.0, 0.0, 0.0);
  ControllerConfig config{.chain = SerialChain(joints, {1, {}})};
  config.q_start = JointVector::Zero(2);
  config.limits = test::noLimits(2);
  config.weights = JointVector::Ones(2);
  config.task.components = {0};
  config.task.size = 1;
  config.tactile_modules.resize(2);
  for (int i = 0; i < 2; ++i) {
    config.tactile_modules[i].link.joint = i;
    config.tactile_modules[i].length_m = 0.5;
    config.tactile_modules[i].max_force_N = kNoLimit;
  }
  config.force_control.emplace();
  config.force_control->variant = Variant::kNullLimit;
  return config;
}

/// side: +1 for a post that the carriage comes to by +y; overlap_m: of post and cover at y = 0.
ObstacleConfig post(int module, double side, double overlap_m, double stiffness_N_per_m) {
  ObstacleConfig post;
  post.x_m = module + 0.25;
  post.y_m = side * (0.06 - overlap_m);
  post.stiffness_N_per_m = stiffness_N_per_m;
  return post;
}

PlantConfig worldOf(const std::vector<ObstacleConfig>& posts) {
  PlantConfig plant = test::crops9Plant(posts);
  plant.robot_stiffness_N_per_m = kNoLimit;
  plant.modules.push_back(plant.modules.front());
  return plant;
}

TEST(SeveralContacts, OfWhichOneVanishesLetTheOtherRestAtTheThreshold) {
  ControllerConfig config = slide();
  ObstacleConfig first = post(0, 1.0, 0.004, 3000.0);
  first.vanishes_s = 5.0;
  test::ClosedLoop loop(config, worldOf({first, post(1, 1.0, 0.002, 3000.0)}), kCycle_s);
  loop.runUntil(5.0);
  EXPECT_NEAR(loop.robot().trueForce_N(0), 1.2, 0.01) << "the deeper one rules";
  EXPECT_EQ(loop.robot().trueForce_N(1), 0.0);
  loop.runUntil(12.0);
  EXPECT_EQ(loop.robot().trueForce_N(0), 0.0);
  EXPECT_EQ(loop.robot().trueForce_N(1), 0.0) << "nothing that is remembered brings it back";
}

/// How fast the first module forgets a post in each of the pauses of 2 s in which none is there;
/// each stands where shift_m of k says.
std::vector<double> forgettingOf(const std::function<double(int)>& shift_m) {
  constexpr int kPosts = 4;
  std::vector<ObstacleConfig> posts;
  for (int k = 0; k < kPosts; ++k) {
    ObstacleConfig next = post(0, 1.0, 0.004 + 0.002 * k, 3000.0);
    next.x_m += shift_m(k);
    next.appears_s = 3.0 * k;
    next.vanishes_s = 3.0 * k + 1.0;
    posts.push_back(next);
  }
  test::ClosedLoop loop(slide(), worldOf(posts), kCycle_s);
  std::vector<double> rates;
  for (int k = 0; k < kPosts; ++k) {
    const ApproachLimitState& approach = loop.state().several.modules[0].approach;
    loop.runUntil(3.0 * k + 1.5);
    const double before = approach.memory_N_per_m;
    loop.runUntil(3.0 * k + 2.5);
    rates.push_back(std::log(before / approach.memory_N_per_m));
  }
  return rates;
}

/// It may have let the arm go to and fro.
TEST(SeveralContacts, AreForgottenHalfAsFastEachTimeTheyAreFoundAgain) {
  const std::vector<double> rates = forgettingOf([](int) { return 0.0; });
  EXPECT_GT(rates[0], 1.0);
  for (std::size_t k = 1; k < rates.size(); ++k)
    EXPECT_NEAR(rates[k], 0.5 * rates[k - 1], 0.1 * rates[k]) << k;
}

TEST(SeveralContacts, AreForgottenAsFastAsEverWhenFoundElsewhere) {
  const std::vector<double> rates = forgettingOf([](int k) { return k < 3 ? 0.0 : 0.15; });
  EXPECT_LT(rates[2], 0.5 * rates[0]);
  EXPECT_NEAR(rates[3], rates[0], 0.1 * rates[0]);
}

/// Both press with 15 N however the carriage stands between them: what is left is an equilibrium.
TEST(SeveralContacts, ThatJamTheArmBalanceTheirForces) {
  const std::pair<double, double> pairs[] = {{5e3, 5e3}, {5e3, 3e4}, {3e4, 3e4}, {3e4, 5e3}};
  for (const auto& [c_0, c_1] : pairs) {
    for (const double place_m : {-0.001, 0.0, 0.001}) {
      ControllerConfig config = slide();
      config.q_start[0] = place_m;
      config.gains.force.assumed_stiffness_N_per_m = 3e4;
      const PlantConfig plant =
          worldOf({post(0, 1.0, 15.0 / c_0, c_0), post(1, -1.0, 15.0 / c_1, c_1)});
      test::ClosedLoop loop(config, plant, kCycle_s);
      loop.runUntil(10.0);
      EXPECT_EQ(loop.output().fault, Fault::kNone);
      EXPECT_NEAR(loop.robot().trueForce_N(0), loop.robot().trueForce_N(1), 1.0)
          << c_0 << " " << c_1 << " " << place_m;
      EXPECT_NEAR(loop.robot().trueForce_N(0), 15.0, 1.0);
      EXPECT_LT(loop.output().velocity.cwiseAbs().maxCoeff(), 1e-3) << "at rest";
    }
  }
}

/// The task presses both on: neither passes F_act + F_th.
TEST(SeveralContacts, HoldTheTaskBackTogether) {
  ControllerConfig config = slide();
  config.task.components = {1};
  Waypoint line;
  line.displacement_m = Vector3(0.0, 0.1, 0.0);
  line.speed_m_per_s = 0.02;
  config.task.trajectory.waypoints = {line};
  const PlantConfig plant = worldOf({post(0, 1.0, -0.02, 2000.0), post(1, 1.0, -0.025, 7000.0)});
  test::ClosedLoop loop(config, plant, kCycle_s);
  double largest_N = 0.0;
  for (int i = 0; i < 20000; ++i) {
    loop.step();
    for (int module = 0; module < 2; ++module)
      largest_N = std::max(largest_N, loop.robot().trueForce_N(module));
  }
  EXPECT_LT(largest_N, 5.1);
  EXPECT_NEAR(largest_N, 5.0, 0.1);
}

TEST(SeveralContacts, TouchNoHeap) {
  const PlantConfig plant =
      worldOf({post(0, 1.0, 15.0 / 5e3, 5e3), post(1, -1.0, 15.0 / 5e3, 5e3)});
  for (const double friction : {0.0, 0.5}) {
    ControllerConfig config = slide();
    config.force_control->friction_coefficient = friction;
    test::ClosedLoop loop(config, plant, kCycle_s);
    const test::AllocationGuard guard;
    loop.runUntil(0.2);
  }
}

}  // namespace
}  // namespace tactus
