#include "tactus/scene/gain_keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <functional>

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

GainUse gainUse(const std::optional<ForceControlConfig>& force_control, std::size_t modules) {
  if (!force_control) return {};
  return {force_control->variant == Variant::kJointSpace, hasContactRows(force_control, modules)};
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
