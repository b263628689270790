#include "tactus/scene/scene_checks.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/analysis/channel_range.h"
#include "tactus/math/filter.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/key_words.h"
#include "tactus/scene/obstacle_checks.h"
#include "tactus/scene/tactile_loader.h"
#include "tactus/scene/task_checks.h"

namespace tactus {
namespace {

void checkJointSpace(const CheckedScene& c) {
  if (!c.scene.has_joint_limit_avoidance) {
    c.fail(
        "redundancy.joint_limit_avoidance", "is missing",
        "a section with the variant joint_space, whose pull would drive joints onto their limits");
  }
}

/// Without a cost at its limits the null space, led to the posture, would press a joint against
/// one, and what the limit keeps it from doing would drag the tool along.
void checkPosture(const CheckedScene& c) {
  if (!c.scene.posture) return;
  if (c.scene.task.size == static_cast<int>(c.q_start.size()))
    c.fail("redundancy.posture", "the task takes all joints, so that nothing leads to it",
           "fewer task.components, or no such section");
  if (c.scene.has_joint_limit_avoidance) return;
  c.fail("redundancy.joint_limit_avoidance", "is missing",
         "a section beside a posture, which would press joints against their limits");
}

/// What the sensor shows at rest: F_th, or F_act + F_th.
struct ShownAtRest {
  double force_N;
  std::string keys;
};

ShownAtRest shownAtRest(const CheckedScene& c) {
  const ForceGains& gains = c.scene.gains.force;
  if (!hasActivationForce(c.scene.controller->variant))
    return {gains.contact_threshold_N, "contact_threshold_N"};
  return {gains.contact_threshold_N + gains.activation_force_N,
          "activation_force_N + contact_threshold_N"};
}

/// What it cannot show is a fault.
void checkSensorRange(const CheckedScene& c) {
  const ShownAtRest rest = shownAtRest(c);
  for (std::size_t i = 0; i < c.robot.config.tactile_modules.size(); ++i) {
    const TactileModuleSection& module = c.robot.config.tactile_modules[i];
    const auto fail = [&](const std::string& name, const std::string& problem,
                          const std::string& expectation) {
      const std::string key = moduleKey(c.robot.root, i) + "." + name;
      failAt(locate(c.robot.root, key), key, problem, "expected " + expectation);
    };
    if (module.config.max_force_N <= rest.force_N) {
      fail("max_force_N",
           fmt::format("{:g} N is no more than where the arm rests", module.config.max_force_N),
           fmt::format("more than {:g} N, the scene's {}", rest.force_N, rest.keys));
    }
    const double rail_N = railForce_N(module.channels, module.config.length_m);
    if (rail_N <= rest.force_N) {
      const double counts_per_N = module.channels.counts_per_N;
      fail("counts_per_N",
           fmt::format("with {:g} and this calibration a channel is at its end at {:.3g} N",
                       counts_per_N, rail_N),
           fmt::format("less than {:.3g}, so that more than {:g} N are shown, the scene's {}",
                       counts_per_N * rail_N / rest.force_N, rest.force_N, rest.keys));
    }
  }
}

/// The paper's laws answer one contact.
void checkModules(const CheckedScene& c) {
  const std::size_t modules = c.robot.config.tactile_modules.size();
  if (modules == 0) {
    c.fail("controller", "the robot has no tactile_modules", "no controller, or such a robot");
  }
  const Variant variant = c.scene.controller->variant;
  if (modules > 1 && variant != Variant::kNone && variant != Variant::kNullLimit) {
    c.fail("controller.variant",
           fmt::format("{} answers the contact of one tactile module, the robot has {}",
                       wordOf(kVariantWords, variant), modules),
           "null_limit, none, or a robot with one");
  }
}

/// What acceleration_law.h has no law for.
void checkLevel(const CheckedScene& c) {
  const ForceControlConfig& control = *c.scene.controller;
  const Variant variant = control.variant;
  const bool is_velocity = control.level == ControlLevel::kVelocity;
  if (control.limit_at != LimitAt::kAuto && (variant != Variant::kNullLimit || !is_velocity))
    c.fail("controller.limit_at", "is of null_limit at the level velocity", "auto");
  if (is_velocity) return;
  const std::string at_level = " with the level acceleration";
  if (variant != Variant::kNullSpace && variant != Variant::kNullTask &&
      variant != Variant::kNullLimit) {
    c.fail("controller.level", "acceleration has no variant " + wordOf(kVariantWords, variant),
           "velocity, or the variant null_space, null_task or null_limit");
  }
  if (c.robot.config.tactile_modules.size() > 1) {
    c.fail("controller.level", "acceleration answers the contact of one tactile module",
           "velocity, or a robot with one");
  }
  if (control.order != 2)
    c.fail("controller.order", fmt::format("{}{}", control.order, at_level), "2");
  if (control.friction_coefficient > 0.0) {
    c.fail("controller.friction_coefficient",
           fmt::format("{:g}{}", control.friction_coefficient, at_level),
           "0, or the level velocity");
  }
}

void checkController(const CheckedScene& c) {
  if (!c.scene.controller) return;
  checkModules(c);
  checkLevel(c);
  const Variant variant = c.scene.controller->variant;
  const std::string name = wordOf(kVariantWords, variant);
  if (hasActivationForce(variant) && !findGiven(c.root, "controller.activation_force_N")) {
    c.fail("controller.activation_force_N", "is missing",
           fmt::format("a number > 0 in N with the variant {}", name));
  }
  if (c.scene.controller->friction_coefficient > 0.0 && variant != Variant::kNullLimit) {
    c.fail("controller.friction_coefficient", name + " does not bear friction",
           "0, or the variant null_limit");
  }
  if (variant == Variant::kJointSpace) checkJointSpace(c);
  if (variant != Variant::kNone) checkSensorRange(c);
  if (variant != Variant::kNone && !c.scene.stiffness) {
    c.fail("stiffness", "is missing", fmt::format("a section with the variant {}", name));
  }
}

/// A run takes a few bytes of memory and some hundred of its log for every cycle.
void checkDuration(const CheckedScene& c) {
  constexpr double kMaxCycles = 1e8;
  const std::string key = "simulation.duration_s";
  if (c.scene.simulation.duration_s < c.scene.period_s) {
    c.fail(key, fmt::format("{} s is shorter than a cycle", c.scene.simulation.duration_s),
           fmt::format("at least period_s = {}", c.scene.period_s));
  }
  if (c.scene.simulation.duration_s > kMaxCycles * c.scene.period_s) {
    c.fail(key,
           fmt::format("{} s is more than {:g} cycles", c.scene.simulation.duration_s, kMaxCycles),
           fmt::format("at most {} s with period_s = {}", kMaxCycles * c.scene.period_s,
                       c.scene.period_s));
  }
}

void checkSimulatedModule(const CheckedScene& c) {
  const std::optional<double>& cutoff_hz = c.scene.simulation.filter_cutoff_hz;
  const std::vector<TactileModuleSection>& modules = c.robot.config.tactile_modules;
  if (!cutoff_hz || modules.empty()) return;
  const std::string key = "simulation.tactile_module.filter_cutoff_hz";
  if (std::ranges::all_of(modules, &TactileModuleSection::filter_in_daemon))
    c.fail(key, "has no filter: the daemon has it, with filter_in_daemon",
           "filter_cutoff_hz of robot.yaml in its place");
  for (const TactileModuleSection& module : modules) {
    if (module.filter_in_daemon) continue;
    const double limit_hz = 0.5 * module.simulated.filter_rate_hz;
    const double least_hz = kLeastCutoff * module.simulated.filter_rate_hz;
    if (*cutoff_hz >= limit_hz)
      c.fail(key, fmt::format("{} Hz is too high", *cutoff_hz),
             fmt::format("less than half the filter's rate, {} Hz", limit_hz));
    if (*cutoff_hz < least_hz)
      c.fail(key, fmt::format("{} Hz is too low", *cutoff_hz),
             fmt::format("at least {} Hz, 1e-4 of the filter's rate", least_hz));
  }
}

void checkPeriodOfModule(const CheckedScene& c, std::size_t index) {
  const TactileModuleSection& module = c.robot.config.tactile_modules[index];
  const double filter_rate_hz = module.simulated.filter_rate_hz;
  const std::string key = moduleKey(c.robot.root, index);
  if (!fitsModule(c.scene.period_s, filter_rate_hz)) {
    c.fail("period_s", fmt::format("{} s does not fit the tactile module", c.scene.period_s),
           fmt::format("a multiple or a whole part of its filter period of {} s",
                       1.0 / filter_rate_hz));
  }
  // A sample that is not new is a period old at once.
  const double max_sample_age_s = module.config.max_sample_age_s;
  if (max_sample_age_s < c.scene.period_s) {
    const std::string age_key = key + ".max_sample_age_s";
    failAt(locate(c.robot.root, age_key), age_key,
           fmt::format("{} s is shorter than a cycle", max_sample_age_s),
           fmt::format("expected at least the scene's period_s = {}", c.scene.period_s));
  }
}

/// The simulation steps by the shortest of all periods, of which the others are multiples.
void checkFilterPeriods(const CheckedScene& c) {
  const std::vector<TactileModuleSection>& modules = c.robot.config.tactile_modules;
  double shortest_s = c.scene.period_s;
  for (const TactileModuleSection& module : modules)
    shortest_s = std::min(shortest_s, 1.0 / module.simulated.filter_rate_hz);
  for (std::size_t i = 0; i < modules.size(); ++i) {
    const double filter_rate_hz = modules[i].simulated.filter_rate_hz;
    if (fitsModule(shortest_s, filter_rate_hz)) continue;
    const std::string key = moduleKey(c.robot.root, i) + ".filter_rate_hz";
    failAt(locate(c.robot.root, key), key,
           fmt::format("{} Hz does not fit the other modules", filter_rate_hz),
           fmt::format("expected {} Hz over a whole number", 1.0 / shortest_s));
  }
}

void checkPeriod(const CheckedScene& c) {
  if (!c.scene.controller) return;
  for (std::size_t i = 0; i < c.robot.config.tactile_modules.size(); ++i) checkPeriodOfModule(c, i);
  checkFilterPeriods(c);
}

}  // namespace

bool fitsModule(double period_s, double filter_rate_hz) {
  const double filter_steps = period_s * filter_rate_hz;
  const double ratio = std::max(filter_steps, 1.0 / filter_steps);
  constexpr double kTolerance = 1e-7;
  return std::abs(ratio - std::round(ratio)) <= kTolerance;
}

void checkScene(const YamlNode& root, const SceneConfig& scene, const LoadedRobot& robot,
                const JointVector& q_start) {
  const CheckedScene checked{root, scene, robot, q_start};
  checkTask(checked);
  checkPosture(checked);
  checkController(checked);
  checkDuration(checked);
  checkPeriod(checked);
  checkSimulatedModule(checked);
  checkObstacles(root, scene.simulation.obstacles, scene.period_s);
}

void checkGains(const YamlNode& root, const ControllerConfig& controller, double period_s) {
  const auto problem = findGainConflict(controller.gains, gainUse(controller), period_s);
  if (!problem) return;
  failAt(locate(root, problem->path), problem->path, problem->problem,
         "expected " + problem->expectation);
}

}  // namespace tactus
