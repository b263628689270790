#include <gtest/gtest.h>

#include "support/allocation_guard.h"
#include "support/closed_loop.h"
#include "support/random.h"
#include "support/random_robot.h"
#include "tactus/control/several_contacts.h"

/// Two contacts on one module, before an arm that can go and turn.
namespace tactus {
namespace {

constexpr double kPairPeriod_s = 0.001;
constexpr double kSpeed_m_per_s = 0.01;

/// A carriage along y with a link that turns about z and a tool at its end, which goes along y.
ControllerConfig turningLink() {
  std::vector<Joint> joints(2);
  joints[0].type = JointType::kPrismatic;
  joints[0].axis = Vector3::UnitY();
  joints[1].axis = Vector3::UnitZ();
  ControllerConfig config{
      .chain = SerialChain(joints, {1, {Matrix3::Identity(), Vector3(0.6, 0.0, 0.0)}})};
  config.q_start = JointVector::Zero(2);
  config.limits = test::noLimits(2);
  config.weights = JointVector::Ones(2);
  config.task.components = {1};
  config.task.size = 1;
  config.task.trajectory.start_s = 0.1;
  Waypoint line;
  line.displacement_m = Vector3(0.0, 0.06, 0.0);
  line.speed_m_per_s = kSpeed_m_per_s;
  config.task.trajectory.waypoints = {line};
  config.tactile_modules.resize(1);
  config.tactile_modules[0].link.joint = 1;
  config.tactile_modules[0].length_m = 0.5;
  config.tactile_modules[0].max_force_N = kNoLimit;
  config.gains.task.max_return_speed_m_per_s = 0.5 * kSpeed_m_per_s;
  config.force_control.emplace();
  config.force_control->variant = Variant::kNullLimit;
  config.force_control->has_estimator = true;
  return config;
}

/// Before the cover at x, met after gap_m.
ObstacleConfig before(double x_m, double gap_m, double stiffness_N_per_m) {
  ObstacleConfig post;
  post.x_m = x_m;
  post.y_m = 0.06 + gap_m;
  post.stiffness_N_per_m = stiffness_N_per_m;
  return post;
}

std::vector<ObstacleConfig> drawPosts(test::Random& random) {
  return {
      before(random.uniform(0.03, 0.2), random.uniform(0.002, 0.02), random.logUniform(200.0, 5e3)),
      before(random.uniform(0.3, 0.45), random.uniform(0.002, 0.02),
             random.logUniform(200.0, 5e3))};
}

PlantConfig among(const std::vector<ObstacleConfig>& posts) {
  PlantConfig plant = test::crops9Plant(posts);
  plant.robot_stiffness_N_per_m = kNoLimit;
  plant.modules.push_back(plant.modules.front());
  return plant;
}

/// The nine-joint arm of config/scenes/whole_arm/crops9_skin_one_link.yaml, without its covers'
/// weight: a stiff post, stiffer here, near the start of link 4, a soft one near its end.
struct Held {
  double peak_N = 0.0, least_at_rest_N = 1e9;

  explicit Held(LimitAt at) {
    ControllerConfig config = test::crops9Controller(Variant::kNullLimit, true);
    PlantConfig plant = test::crops9Plant({});
    const std::pair<int, double> covers[] = {
        {2, 0.22}, {3, 0.38}, {5, 0.17}};  // joint, length in m
    config.tactile_modules.assign(3, TactileModuleConfig(config.tactile_modules.front()));
    plant.modules.resize(3, plant.modules.front());
    for (std::size_t i = 0; i < 3; ++i) {
      config.tactile_modules[i].link.joint = covers[i].first;
      config.tactile_modules[i].length_m = covers[i].second;
    }
    plant.obstacles.resize(2);
    plant.obstacles[0].post = PostConfig{{0.68, 0.07, 0.2}, Vector3::UnitZ(), 0.7, 0.02};
    plant.obstacles[0].stiffness_N_per_m = 800.0;
    plant.obstacles[1].post = PostConfig{{0.5, 0.015, 0.2}, Vector3::UnitZ(), 0.7, 0.02};
    plant.obstacles[1].stiffness_N_per_m = 60000.0;
    config.force_control->limit_at = at;
    test::ClosedLoop loop(config, plant, kPairPeriod_s);
    for (int i = 0; i < 13000; ++i) {
      loop.step();
      const double force_N = loop.robot().trueForce_N(1);
      peak_N = std::max(peak_N, force_N);
      if (i > 11000) least_at_rest_N = std::min(least_at_rest_N, force_N);
    }
    EXPECT_EQ(loop.output().fault, Fault::kNone);
  }
};

TEST(TwoContactsOnAModule, AreHeldTogether) {
  for (const LimitAt at : {LimitAt::kAuto, LimitAt::kStiffnessCentre, LimitAt::kModuleEnds}) {
    const Held held(at);
    EXPECT_LT(held.peak_N, 5.5) << "the law's 5 N, and the blow before it is felt";
    EXPECT_GT(held.least_at_rest_N, 4.9);
  }
}

/// Else the above would say nothing.
TEST(TwoContactsOnAModule, AreNotByTheResultantAlone) {
  EXPECT_GT(Held(LimitAt::kResultant).peak_N, 7.0);
}

/// One contact has no centre of its own: the motion is that of the resultant, to the bit.
TEST(OneContactOnAModule, MovesAsIfNoSecondWereLookedFor) {
  test::Random random(62);
  int learnt = 0;
  for (const double noise_N : {0.0, 0.05}) {
    for (const double friction : {0.0, 0.5}) {
      for (int draw = 0; draw < 4; ++draw) {
        ControllerConfig config = turningLink();
        config.tactile_modules.push_back(config.tactile_modules.front());
        config.force_control->friction_coefficient = friction;
        PlantConfig plant = among({drawPosts(random)[draw % 2]});
        plant.modules.front().noise_N = noise_N;
        plant.modules.back().noise_N = noise_N;
        plant.obstacles.front().friction_coefficient = 0.6 * friction;
        ControllerConfig resultant = config;
        resultant.force_control->limit_at = LimitAt::kResultant;
        test::ClosedLoop loop(config, plant, kPairPeriod_s), other(resultant, plant, kPairPeriod_s);
        double highest_N = 0.0;
        for (int i = 0; i < 8000; ++i) {
          loop.step();
          other.step();
          highest_N = std::max(highest_N, loop.robot().trueForce_N());
          ASSERT_EQ(loop.output().velocity, other.output().velocity)
              << noise_N << " " << friction << " " << draw << " " << i;
        }
        EXPECT_GT(highest_N, 0.9);
        for (const ModuleContactState& module : loop.state().several.modules)
          learnt += module.centre.weight > 0.0;
      }
    }
  }
  EXPECT_GT(learnt, 4) << "else nothing was looked for";
}

TEST(TwoContactsOnAModule, TouchNoHeap) {
  test::Random random(63);
  const PlantConfig plant = among(drawPosts(random));
  for (const LimitAt at : {LimitAt::kStiffnessCentre, LimitAt::kModuleEnds}) {
    ControllerConfig config = turningLink();
    config.force_control->limit_at = at;
    test::ClosedLoop loop(config, plant, kPairPeriod_s);
    const test::AllocationGuard guard;
    loop.runUntil(3.0);
  }
}

}  // namespace
}  // namespace tactus
