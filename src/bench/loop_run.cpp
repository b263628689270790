#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "tactus/bench/closed_loop_study.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

constexpr double kRippleWindow_s = 2.0;

struct ForceSample {
  double t_s, force_N;
};

/// The last 2 s of the last contact, from the samples of the whole run.
Ripple lastRipple(const std::vector<ForceSample>& samples, const RunFigures& figures,
                  double period_s) {
  if (figures.contacts.empty()) return {};
  const double end_s = figures.contacts.back().end_s;
  std::vector<double> values;
  for (const ForceSample& sample : samples) {
    if (sample.t_s > end_s - kRippleWindow_s && sample.t_s <= end_s)
      values.push_back(sample.force_N);
  }
  return rippleOf(values, period_s);
}

}  // namespace

Ripple rippleOf(const std::vector<double>& values, double step_s) {
  if (values.size() < 3) return {};
  const auto count = static_cast<double>(values.size());
  const double middle = 0.5 * (count - 1.0);
  double mean = 0.0, slope = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    mean += values[i] / count;
    slope += (static_cast<double>(i) - middle) * values[i];
  }
  slope /= count * (count * count - 1.0) / 12.0;
  double squares = 0.0, before = 0.0;
  int crossings = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double rest = values[i] - mean - slope * (static_cast<double>(i) - middle);
    squares += rest * rest;
    crossings += before < 0.0 && rest >= 0.0;
    before = rest;
  }
  return {std::sqrt(squares / count), crossings / (count * step_s)};
}

double rmsDifference(const std::vector<double>& a, const std::vector<double>& b) {
  const std::size_t count = std::min(a.size(), b.size());
  double squares = 0.0;
  for (std::size_t i = 0; i < count; ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return count == 0 ? kNotMeasured : std::sqrt(squares / static_cast<double>(count));
}

LoopRun runWithPeriod(const Scene& original, double period_s) {
  Scene scene = original;
  scene.period_s = period_s;
  // A sample that is not new is a period old at once: no fault by that alone.
  for (TactileModuleConfig& module : scene.controller.tactile_modules)
    module.max_sample_age_s = std::max(module.max_sample_age_s, 1.5 * period_s);
  const auto modules = static_cast<int>(scene.controller.tactile_modules.size());
  LoopRun run;
  run.period_s = period_s;
  std::vector<ForceSample> samples;
  const SimulationResult result = simulate(scene, [&](const CycleRecord& record) {
    samples.push_back({record.t_s, largestForce_N(record, modules)});
    const double next_s = static_cast<double>(run.force_N.size()) * kTraceStep_s;
    if (record.t_s < next_s - 0.5 * scene.period_s) return;
    run.force_N.push_back(largestForce_N(record, modules));
    run.tool_error_m.push_back(Eigen::Map<const Vector3>(record.tool_error_m).norm());
  });
  run.figures = result.figures;
  const auto cycles = static_cast<double>(result.figures.cycles);
  run.control_time_s = 1e-9 * cycles * static_cast<double>(result.figures.step_time_ns->median);
  run.run_time_s = cycles * scene.period_s / result.real_time_factor;
  const Ripple ripple = lastRipple(samples, result.figures, scene.period_s);
  run.ripple_N = ripple.deviation;
  run.ripple_Hz = ripple.frequency_Hz;
  if (result.figures.end.fault != Fault::kNone) {
    run.outcome = faultName(result.figures.end.fault);
  } else {
    run.outcome = ripple.deviation > kMaxRipple_N ? "limit cycle" : "stable";
  }
  return run;
}

std::string refusedKey(const std::string& scene_path, double period_s) {
  try {
    loadScene(scene_path, {{"period_s", fmt::format("{}", period_s)}}, SceneUse::kSimulation);
    return "";
  } catch (const InputError& error) {
    const std::string text = error.what();  // file:line:col: key: problem, expected ...
    const std::size_t key = text.find(": ") + 2;
    return text.substr(key, text.find(": ", key) - key);
  }
}

}  // namespace tactus
