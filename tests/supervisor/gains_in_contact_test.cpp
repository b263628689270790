#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "support/random.h"
#include "support/shipped_scene.h"
#include "tactus/control/controller.h"
#include "tactus/scene/gain_plan.h"
#include "tactus/scene/stability_check.h"
#include "tactus/sim/simulated_robot.h"
#include "tactus/supervisor/gain_change.h"

/// Gains of an arm in contact, in virtual time: controller, simulated robot, and what leads the
/// gains from one set to the next.
namespace tactus {
namespace {

using Settings = std::vector<Override>;

/// TACTUS_GAIN_PAIRS: for longer looks than each build's.
int pairs(int unless_told) {
  const char* const told = std::getenv("TACTUS_GAIN_PAIRS");
  return told ? std::atoi(told) : unless_told;
}

struct Outcome {
  double peak_N = 0.0;
  double largest_acceleration = 0.0;  ///< share of the joint's limit
  double first_contact_s = -1.0;
  double peak_s = 0.0;
  double final_N = 0.0;
  GainReport report;
};

/// What is ordered when; never: at a negative time.
struct Change {
  double at_s = -1.0;
  GainOrder order;
};

Outcome run(const Scene& scene, const Change& change) {
  const Controller controller(scene.controller);
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  GainChange gains(scene.controller.gains, scene.period_s);
  const JointLimits& limits = scene.controller.limits;
  JointVector before = JointVector::Zero(limits.max_velocity.size());
  Outcome outcome;
  const auto cycles = std::lround(scene.duration_s / scene.period_s);
  for (long i = 0; i < cycles; ++i) {
    const double t_s = static_cast<double>(i) * scene.period_s;
    if (i == std::lround(change.at_s / scene.period_s)) gains.order(change.order);
    robot.read(input);
    controller.update(input, gains.gains(), t_s, scene.period_s, state, output);
    robot.write(output.velocity);
    GainWatchInput seen;
    for (int k = 0; k < output.modules; ++k)
      seen.force_N = std::max(seen.force_N, output.sensed[k].force_N);
    seen.is_at_limit =
        (output.velocity.cwiseAbs().array() >= 0.999 * limits.max_velocity.array()).any();
    seen.has_fault = output.fault != Fault::kNone;
    gains.update(seen);
    if (seen.force_N > outcome.peak_N) outcome.peak_s = t_s;
    outcome.peak_N = std::max(outcome.peak_N, seen.force_N);
    outcome.final_N = seen.force_N;
    const JointVector share =
        (output.velocity - before).cwiseAbs().cwiseQuotient(limits.max_acceleration);
    outcome.largest_acceleration =
        std::max(outcome.largest_acceleration, share.maxCoeff() / scene.period_s);
    before = output.velocity;
    const double F_th = gains.gains().force.contact_threshold_N;
    if (outcome.first_contact_s < 0.0 && seen.force_N > F_th) outcome.first_contact_s = t_s;
  }
  outcome.report = gains.report();
  return outcome;
}

const std::vector<std::pair<std::string, std::string>> kScenes = {
    {"scenario2_estimated", "null_space"},
    {"scenario2_estimated", "task_space"},
    {"scenario2_estimated", "joint_space"},
    {"scenario2_estimated", "null_task"},
    {"scenario2_estimated", "null_joint"},
    {"scenario2_tactus", "null_limit"},
    {"whole_arm/crops9_skin_two_links", "null_limit"}};

std::string drawn(test::Random& random, double least, double most) {
  return std::to_string(random.logUniform(least, most));
}

Settings drawSettings(test::Random& random, const std::string& variant) {
  Settings settings = {{"controller.variant", variant},
                       {"controller.time_constant_s", drawn(random, 0.06, 0.4)},
                       {"controller.damping", drawn(random, 0.5, 2.0)},
                       {"task.drift_gain_per_s", drawn(random, 1.0, 8.0)},
                       {"stiffness.assumed_N_per_m", drawn(random, 3000.0, 20000.0)}};
  if (variant.starts_with("null_") && variant != "null_space")
    settings.push_back({"controller.activation_force_N", drawn(random, 2.0, 6.0)});
  return settings;
}

std::optional<GainPlan> accepted(const Scene& scene, const Settings& settings) {
  try {
    return planSettings(scene, settings, kMinPhaseMargin_deg);
  } catch (const InputError&) {
    return std::nullopt;
  }
}

/// How the pairs of a variant compare.
struct PairCount {
  int switched = 0, begun = 0, above = 0;  ///< above: by more than 2 %
  double worst = 0.0;                      ///< peak over the larger one of both alone
};

void add(const Outcome& both, double most_N, PairCount& count) {
  const double ratio = both.peak_N / most_N;
  ++count.switched;
  count.begun += both.report.state != GainState::kWaiting ? 1 : 0;
  count.above += ratio > 1.02 ? 1 : 0;
  count.worst = std::max(count.worst, ratio);
}

/// Until what is said at the path's end rests: a soft contact is still on its way to its limit, and
/// there sooner with gains that change.
constexpr double kRest_s = 10.0;

/// The second of two sets of gains is ordered in contact: the force is hardly above what it is with
/// one of them alone, and no joint accelerates faster than it may. What waits for a moment without
/// contact does so here, too.
TEST(GainsInContact, SwitchingPushesNoHarderThanEither) {
  test::Random random(1931);
  int switched = 0;
  std::map<std::string, PairCount> counts;
  for (int i = 0; switched < pairs(14) && i < 100 * pairs(14); ++i) {
    const auto& [name, variant] = kScenes[static_cast<std::size_t>(i) % kScenes.size()];
    const Settings one = drawSettings(random, variant), other = drawSettings(random, variant);
    Scene scene = test::shippedScene(name, one);
    if (phaseMargin_deg(scene) < 30.0) continue;
    std::optional<GainPlan> changed = accepted(scene, Settings(other.begin() + 1, other.end()));
    if (!changed) continue;
    const double last_s = scene.duration_s - 2.0;
    scene.duration_s += kRest_s;
    changed->scene.duration_s += kRest_s;
    const Outcome first = run(scene, {}), second = run(changed->scene, {});
    if (first.first_contact_s < 0.0) continue;
    ++switched;
    Change change;
    change.order = {.number = 1,
                    .gains = changed->scene.controller.gains,
                    .waits_for_free = changed->waits_for_free};
    change.at_s = random.uniform(first.first_contact_s, last_s);
    const Outcome both = run(scene, change);
    const double most_N = std::max(first.peak_N, second.peak_N);
    add(both, most_N, counts[variant]);
    EXPECT_LE(both.peak_N, 1.15 * most_N) << name << " " << variant << " draw " << i;
    EXPECT_LE(both.largest_acceleration, 1.0 + 1e-9) << name << " " << variant;
  }
  EXPECT_EQ(switched, pairs(14));
  for (const auto& [variant, count] : counts) {
    EXPECT_LE(count.above, count.switched / 200) << variant;
    std::printf(
        "%s: %d of %d pairs push more than 2 %% harder, at most %.3f times; %d have begun\n",
        variant.c_str(), count.above, count.switched, count.worst, count.begun);
  }
}

/// Past all checks, gains that make the loop unstable: they are taken back before the force is
/// twice what the arm would leave its task for.
TEST(GainsInContact, UnstableOnesAreTakenBackInTime) {
  test::Random random(1932);
  int unstable = 0, taken_back = 0;
  std::map<std::string, PairCount> counts;
  for (int i = 0; unstable < pairs(10) && i < 100 * pairs(10); ++i) {
    const auto& [name, variant] = kScenes[static_cast<std::size_t>(i) % kScenes.size()];
    const Scene scene = test::shippedScene(name, {{"controller.variant", variant}});
    Scene wild = scene;
    wild.controller.gains.force.time_constant_s *= random.logUniform(0.02, 0.5);
    wild.controller.gains.force.damping *= random.logUniform(0.1, 1.0);
    wild.controller.gains.force.assumed_stiffness_N_per_m *= random.logUniform(0.05, 1.0);
    if (phaseMargin_deg(wild) > 0.0) continue;
    const Outcome alone = run(scene, {});
    if (alone.first_contact_s < 0.0) continue;
    ++unstable;
    Change change;
    change.order = {
        .number = 1,
        .gains = wild.controller.gains,
        .waits_for_free =
            planSettings(scene, {{"controller.time_constant_s", "0.2"}}, 0.0).waits_for_free};
    change.at_s =
        random.uniform(alone.peak_s + 0.2, std::max(alone.peak_s + 0.3, scene.duration_s - 3.0));
    const Outcome both = run(scene, change);
    const double F_act = scene.controller.gains.force.activation_force_N;
    const double F_rest = F_act + scene.controller.gains.force.contact_threshold_N;
    taken_back += both.report.trouble != GainTrouble::kNone ? 1 : 0;
    const double F_most = std::max(alone.peak_N, 2.0 * F_act);
    counts[variant].switched += 1;
    counts[variant].begun += both.report.state != GainState::kWaiting ? 1 : 0;
    counts[variant].above += both.peak_N > F_most ? 1 : 0;
    counts[variant].worst = std::max(counts[variant].worst, both.peak_N);
    EXPECT_LE(both.peak_N, F_most) << name << " " << variant;
    if (both.report.trouble == GainTrouble::kNone) continue;
    EXPECT_LE(both.final_N, 1.02 * std::max(alone.final_N, F_rest)) << name << " " << variant;
  }
  EXPECT_EQ(unstable, pairs(10));
  EXPECT_GT(taken_back, 0);
  std::printf("%d of %d unstable sets taken back\n", taken_back, unstable);
  for (const auto& [variant, count] : counts)
    std::printf("%s: %d of %d push harder than 2 F_act and before, at most %.1f N; %d have begun\n",
                variant.c_str(), count.above, count.switched, count.worst, count.begun);
}

}  // namespace
}  // namespace tactus
