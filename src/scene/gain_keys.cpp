#include "tactus/scene/gain_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>

#include "tactus/scene/number_text.h"
#include "tactus/scene/scene_config.h"

namespace tactus {
namespace {

/// The keys whose target lies in these gains; `owner` has the rows of `specs`.
void collect(const std::vector<KeySpec>& specs, const std::string& prefix, void* owner,
             const Gains& gains, std::vector<GainKey>& keys) {
  const char* const begin = reinterpret_cast<const char*>(&gains);
  for (const KeySpec& spec : specs) {
    if (spec.enter) {
      collect(spec.keys, prefix + spec.key + ".", spec.enter(owner), gains, keys);
      continue;
    }
    const Target target = spec.target(owner);
    const auto* const number = std::get_if<double*>(&target);
    if (!number) continue;
    const char* const place = reinterpret_cast<const char*>(*number);
    const bool is_gain =
        !std::less<>()(place, begin) && std::less<>()(place, begin + sizeof(Gains));
    if (is_gain) keys.push_back({prefix + spec.key, spec, static_cast<std::size_t>(place - begin)});
  }
}

bool isWithin(const Range& range, double value) {
  return value >= range.lower && value <= range.upper &&
         !(range.lower_open && value == range.lower);
}

double narrowestRange(const ControllerConfig& config) {
  double narrowest = 0.0;
  for (Eigen::Index i = 0; i < config.weights.size(); ++i) {
    const double half = 0.5 * (config.limits.upper[i] - config.limits.lower[i]);
    if (half > 0.0) narrowest = std::max(narrowest, 1.0 / (half * config.weights[i]));
  }
  return narrowest;
}

/// In its zone a joint moves by -alpha period W^-1/2 N W^-1/2 dH/dq a cycle. The curvature of H is
/// diagonal, gradient_at_limit / (f half), and no eigenvalue of N is above 1: where alpha times
/// period times curvature / w is at most 1 for each joint, none of these linear steps overshoots.
std::optional<GainProblem> findSteepLimits(const JointLimitAvoidanceGains& gains,
                                           const GainUse& use, double period_s) {
  const double share_per_gain =
      period_s * gains.gradient_at_limit / gains.active_fraction * use.narrowest_range;
  if (gains.gain * share_per_gain <= 1.0) return std::nullopt;
  return GainProblem{
      "redundancy.joint_limit_avoidance.gain",
      fmt::format("{} is too steep: joints would overshoot in a cycle on the way off their limits",
                  gains.gain),
      fmt::format("at most {:.4g} with this gradient_at_limit, active_fraction and period_s",
                  kInsideLimit / share_per_gain)};
}

}  // namespace

double gainAt(const Gains& gains, std::size_t offset) noexcept {
  double value;
  std::memcpy(&value, reinterpret_cast<const char*>(&gains) + offset, sizeof(value));
  return value;
}

const std::vector<GainKey>& gainKeys() {
  static const std::vector<GainKey> keys = [] {
    std::vector<GainKey> found;
    SceneConfig config;
    collect(sceneKeys(), "", &config, config.gains, found);
    std::ranges::sort(found, {}, &GainKey::offset);
    return found;
  }();
  return keys;
}

GainUse gainUse(const ControllerConfig& config) {
  GainUse use;
  if (config.has_joint_limit_avoidance) use.narrowest_range = narrowestRange(config);
  if (!config.force_control) return use;
  use.is_joint_space = config.force_control->variant == Variant::kJointSpace;
  use.has_contact_rows = hasContactRows(config);
  return use;
}

std::optional<GainProblem> findGainProblem(const Gains& gains, const GainUse& use,
                                           double period_s) {
  for (const GainKey& key : gainKeys()) {
    const double value = gainAt(gains, key.offset);
    // What an absent key means may lie outside: no limit.
    if (isWithin(key.spec.range, value) || value == gainAt(Gains{}, key.offset)) continue;
    return GainProblem{key.path, fmt::format("{} is out of range", value),
                       describeExpectation(key.spec)};
  }
  return findGainConflict(gains, use, period_s);
}

std::optional<GainProblem> findGainConflict(const Gains& gains, const GainUse& use,
                                            double period_s) {
  // One explicit step of the drift term, or of the pull, must not overshoot.
  const auto tooHigh = [period_s](const char* path, double gain_per_s) {
    return GainProblem{path, fmt::format("{} is too high", gain_per_s),
                       fmt::format("at most 1 / period_s = {}", 1.0 / period_s)};
  };
  if (gains.task.drift_gain_per_s * period_s > 1.0)
    return tooHigh("task.drift_gain_per_s", gains.task.drift_gain_per_s);
  if (auto problem = findSteepLimits(gains.joint_limit_avoidance, use, period_s)) return problem;
  const ForceGains& force = gains.force;
  if ((use.is_joint_space || use.has_contact_rows) &&
      force.transition.release_force_N >= force.contact_threshold_N) {
    return GainProblem{
        "controller.transition.release_force_N",
        fmt::format("{} N is not below the contact threshold", force.transition.release_force_N),
        fmt::format("less than contact_threshold_N = {}", force.contact_threshold_N)};
  }
  if (use.is_joint_space && force.pull_gain_per_s * period_s > 1.0)
    return tooHigh("controller.pull_gain_per_s", force.pull_gain_per_s);
  if (force.estimator.min_N_per_m >= force.estimator.max_N_per_m) {
    return GainProblem{"stiffness.estimate.max_N_per_m",
                       fmt::format("{} is not above min_N_per_m", force.estimator.max_N_per_m),
                       fmt::format("more than {}", force.estimator.min_N_per_m)};
  }
  return std::nullopt;
}

}  // namespace tactus
