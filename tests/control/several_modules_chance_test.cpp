#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/random_clearance.h"
#include "tactus/control/several_contacts.h"

/// Whole controllers with contacts on several modules, of which some fall silent, stops by drives
/// and retreats at any time: no limit is left, no distance is undercut, and a retreat from one
/// module does not drive another one into what it touches.
namespace tactus {
namespace {

constexpr int kPushedModules = 2;

ControllerConfig pushedController(test::Random& random) {
  const int n = random.integer(4, kMaxJoints);
  ControllerConfig config = test::fullController(random, n, Variant::kNullLimit);
  config.tactile_modules.push_back(config.tactile_modules.front());
  config.tactile_modules.back().link = test::randomFrame(random, n / 2);
  config.module_loss = ModuleLossConfig{};
  config.force_control->friction_coefficient = random.chance(0.5) ? 0.5 : 0.0;
  config.force_control->limit_at = random.chance(0.5) ? LimitAt::kModuleEnds : LimitAt::kAuto;
  // Near enough to limits that some act.
  config.limits.lower = config.q_start - random.vector(n, 0.01, 0.6);
  config.limits.upper = config.q_start + random.vector(n, 0.01, 0.6);
  if (random.chance(0.4)) {  // or one alone, with any law
    config.tactile_modules.pop_back();
    config.module_loss.reset();
    config.force_control = ForceControlConfig{};
    config.force_control->variant = test::kAllVariants[random.index(std::size(test::kAllVariants))];
  }
  if (random.chance(0.7)) {
    config.clearance = test::randomBodies(random, n);
    test::leaveOutTouching(config.chain, config.q_start, *config.clearance);
  }
  return config;
}

/// Pushes that come and go, at times none of the module's samples.
class PushedModule {
 public:
  TactileSample next(test::Random& random, int cycle) {
    if (cycle % 4 != 0) return sample_;
    // Often, while nothing is felt, and for long.
    if (random.chance(is_silent_ ? 0.002 : 0.05))
      is_silent_ = !is_silent_ && sample_.force_y_N == 0.0;
    if (is_silent_) return sample_;
    const double swell = std::sin(0.02 * cycle + phase_) + random.uniform(-0.1, 0.1);
    sample_ = test::touchAt(random.uniform(0.1, 0.3), std::clamp(30.0 * swell, 0.0, 25.0),
                            0.7 + 0.001 * cycle, sample_.sequence + 1);
    return sample_;
  }
  explicit PushedModule(double phase) : phase_(phase) {}

 private:
  double phase_;
  bool is_silent_ = false;
  TactileSample sample_;
};

/// By its drives, by an order, or by a fault that retreats.
void befall(test::Random& random, const Controller& controller, ControllerState& state) {
  if (!random.chance(0.004)) return;
  const Gains& gains = controller.initialGains();
  if (state.is_stopping) {
    state.is_stopping = false;
    state.fault = Fault::kNone;
    if (random.chance(0.3)) {
      controller.restart(gains, state);
      controller.place(JointVector(state.q_desired), gains, state);
    }
    controller.goOn(gains, state);
    return;
  }
  state.is_stopping = true;
  if (random.chance(0.3)) return;
  state.retreat.velocity_at_fault = state.velocity_before;
  controller.beginRetreat(gains, state);
  state.retreat.is_under_way = true;
}

TEST(SeveralModulesByChance, LeaveNoLimitAndNoDistance) {
  test::Random random(431);
  int retreats = 0, losses = 0, limited = 0;
  for (int run = 0; run < 60; ++run) {
    const ControllerConfig config = pushedController(random);
    const Controller controller(config);
    std::optional<BodyDistances> distances;
    if (config.clearance) distances.emplace(config.chain, *config.clearance);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    std::vector<PushedModule> modules{PushedModule(0.0), PushedModule(random.uniform(0.0, 6.0))};
    double t_s = 0.0;
    for (int cycle = 0; cycle < 800 && output.fault == Fault::kNone; ++cycle) {
      befall(random, controller, state);
      RobotInput input{state.q_desired, {}};
      for (int i = 0; i < kPushedModules; ++i) input.tactile[i] = modules[i].next(random, cycle);
      const JointVector before = state.velocity_before;
      controller.update(input, config.gains, t_s, 0.001, state, output);
      if (!state.is_stopping) t_s += 0.001;
      ASSERT_TRUE(output.velocity.allFinite()) << run << " " << cycle;
      ASSERT_LE((output.velocity.cwiseAbs() - config.limits.max_velocity).maxCoeff(), 1e-12);
      const JointVector change = (output.velocity - before).cwiseAbs();
      ASSERT_LE((change - 0.001 * config.limits.max_acceleration).maxCoeff(), 1e-12);
      ASSERT_LE((state.q_desired - config.limits.upper).maxCoeff(), 1e-9);
      ASSERT_GE((state.q_desired - config.limits.lower).minCoeff(), -1e-9);
      retreats += state.retreat.has_push && state.retreat.is_under_way ? 1 : 0;
      losses += state.modules[0].is_lost || state.modules[1].is_lost ? 1 : 0;
      limited += output.contact.u_t != 0.0 ? 1 : 0;
      if (!distances) continue;
      ChainPose pose;
      config.chain.computePose(state.q_desired, pose);
      ASSERT_GE(nearestBody(*distances, pose).distance_m, config.clearance->safe_distance_m - 1e-12)
          << run << " cycle " << cycle;
    }
  }
  EXPECT_GT(retreats, 100);
  EXPECT_GT(losses, 100);
  EXPECT_GT(limited, 100);
}

}  // namespace
}  // namespace tactus
