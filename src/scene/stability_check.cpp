#include "tactus/scene/stability_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tactus/analysis/variant_loops.h"
#include "tactus/scene/judged_plant.h"
#include "tactus/scene/number_text.h"
#include "tactus/scene/yaml_tree.h"
#include "tactus/sim/obstacle.h"

namespace tactus {
namespace {

/// A contact and the key that says how stiff it is; no key where the assumed stiffness stands for
/// it.
struct StiffestContact {
  double stiffness_N_per_m;
  std::string key;
};

StiffestContact stiffestContact(const Scene& scene) {
  StiffestContact stiffest{scene.controller.gains.force.assumed_stiffness_N_per_m, ""};
  if (scene.stiffest_N_per_m > 0.0)
    stiffest = {scene.stiffest_N_per_m, "stiffness.stiffest_N_per_m"};
  for (std::size_t i = 0; i < scene.plant.obstacles.size(); ++i) {
    const double stiffness_N_per_m =
        inSeries(scene.plant.obstacles[i].stiffness_N_per_m, scene.plant.robot_stiffness_N_per_m);
    if (stiffness_N_per_m <= stiffest.stiffness_N_per_m) continue;
    stiffest = {stiffness_N_per_m, fmt::format("simulation.obstacles[{}].stiffness_N_per_m", i)};
  }
  return stiffest;
}

/// A good estimate is the stiffness itself, within the estimator's range.
double stiffnessOfLaw(const ControllerConfig& config, double stiffest_N_per_m) {
  const ForceGains& gains = config.gains.force;
  if (!config.force_control->has_estimator) return gains.assumed_stiffness_N_per_m;
  return std::clamp(stiffest_N_per_m, gains.estimator.min_N_per_m, gains.estimator.max_N_per_m);
}

[[noreturn]] void fail(const Scene& scene, const std::string& key, const std::string& problem,
                       const std::string& expectation) {
  failAt(scene.tree ? locate(*scene.tree, key) : SourcePosition{}, key, problem,
         "expected " + expectation);
}

constexpr double kMinPhaseMargin_rad = kMinPhaseMargin_deg * std::numbers::pi / 180.0;

/// The c_e/c up to which all loops have this phase margin; 0: with none.
double largestRatio(const std::vector<VariantLoop>& loops, double phase_margin_rad) {
  double ratio = std::numeric_limits<double>::infinity();
  for (const VariantLoop& loop : loops)
    ratio = std::min(ratio, largestStiffnessRatio(loop.loop, phase_margin_rad));
  return ratio;
}

/// The T from which on they have it, s; infinite: from none.
double smallestT_s(const std::vector<VariantLoop>& loops, double ratio, double phase_margin_rad) {
  double T_s = 0.0;
  for (const VariantLoop& loop : loops)
    T_s = std::max(T_s, smallestTimeConstant(loop.loop, ratio, phase_margin_rad));
  return T_s;
}

std::string timeConstantExpectation(const std::vector<VariantLoop>& loops, double ratio) {
  const auto rounded = [](double T_s) { return std::ceil(1e4 * T_s) / 1e4; };
  const std::string margin = fmt::format("a phase margin of {:g} degrees", kMinPhaseMargin_deg);
  const double good_s = smallestT_s(loops, ratio, kMinPhaseMargin_rad);
  if (std::isfinite(good_s))
    return fmt::format("at least {:g} s for {} with this damping and these delays", rounded(good_s),
                       margin);
  const double stable_s = smallestT_s(loops, ratio, 0.0);
  if (std::isfinite(stable_s))
    return fmt::format("at least {:g} s, and more damping for {}", rounded(stable_s), margin);
  return "more damping, or less delay in filter and drives";
}

/// Where a contact as stiff as the law takes it has not the phase margin the gains are wrong, for
/// what may be met is taken for no softer, else the stiffness is.
[[noreturn]] void failUnstable(const Scene& scene, const StabilityReport& report,
                               const std::string& stiffest_key,
                               const std::vector<VariantLoop>& loops, const LoopReport& unstable) {
  const std::string contact = fmt::format("unstable ({}{}) in a contact of {:g} N/m", unstable.name,
                                          ofModule(scene, report.module), report.stiffest_N_per_m);
  const double ratio = largestRatio(loops, kMinPhaseMargin_rad);
  if (ratio < 1.0) {
    fail(scene, "controller.time_constant_s",
         fmt::format("{} s is {}", scene.controller.gains.force.time_constant_s, contact),
         timeConstantExpectation(loops, report.ratio()));
  }
  const std::string rule = fmt::format("c_e/c at most {:.3f} for a phase margin of {:g} degrees",
                                       ratio, kMinPhaseMargin_deg);
  const double least_N_per_m = report.stiffest_N_per_m / (kInsideLimit * ratio);
  if (scene.controller.force_control->has_estimator) {
    fail(scene, "stiffness.estimate.max_N_per_m",
         fmt::format("{:g} N/m is {}", report.stiffness_N_per_m, contact),
         fmt::format("at least {:g} N/m ({})", least_N_per_m, rule));
  }
  fail(scene, stiffest_key, contact + ", obstacle and arm in series",
       fmt::format("at most {:g} N/m, or stiffness.assumed_N_per_m of at least {:g} N/m ({})",
                   kInsideLimit * ratio * report.stiffness_N_per_m, least_N_per_m, rule));
}

/// So that what is less than the least does not show as it.
double roundedDown(double deg) { return std::floor(10.0 * deg) / 10.0; }

/// Keeps the smallest phase margin of all modules, and whose it is.
void noteNearest(const std::vector<LoopReport>& loops, int module, StabilityReport& report) {
  for (const LoopReport& loop : loops) {
    if (report.nearest && report.nearest->phaseMargin_deg() <= loop.phaseMargin_deg()) continue;
    report.nearest = loop;
    report.module_of_nearest = module;
  }
}

std::vector<std::string> warningsOf(const Scene& scene, const StabilityReport& report,
                                    double largest_ratio) {
  std::vector<std::string> warnings;
  const LoopReport& nearest = *report.nearest;
  if (nearest.phaseMargin_deg() < kMinPhaseMargin_deg) {
    warnings.push_back(fmt::format(
        "phase margin of {:.1f} degrees ({}{}): overshoots and rings, better {:g} or more",
        roundedDown(nearest.phaseMargin_deg()), nearest.name,
        ofModule(scene, report.module_of_nearest), kMinPhaseMargin_deg));
  }
  const double assumed_N_per_m = scene.controller.gains.force.assumed_stiffness_N_per_m;
  const double needed_N_per_m = report.stiffest_N_per_m / largest_ratio;
  if (assumed_N_per_m < needed_N_per_m) {
    warnings.push_back(
        fmt::format("unstable in the stiffest contact until the estimate has risen from {:g} to "
                    "{:g} N/m",
                    assumed_N_per_m, needed_N_per_m));
  }
  if (const std::string warning = leftOut(scene.plant); !warning.empty())
    warnings.push_back(warning);
  return warnings;
}

std::vector<LoopReport> marginsOf(const std::vector<VariantLoop>& loops, double ratio) {
  std::vector<LoopReport> reports;
  for (const VariantLoop& loop : loops)
    reports.push_back({loop.name, computeMargins(loop.loop, ratio)});
  return reports;
}

const LoopReport& leastStable(const std::vector<LoopReport>& loops) {
  return *std::ranges::min_element(
      loops, {}, [](const LoopReport& loop) { return loop.margins.largest_stiffness_ratio; });
}

/// Keeps the smallest ratio of all modules, and whose it is.
void noteGears(const std::vector<VariantLoop>& loops, int module, StabilityReport& report) {
  for (std::size_t i = 0; i < loops.size(); ++i) {
    if (!loops[i].loop.geared) continue;
    const double ratio = largestStiffnessRatio(loops[i].loop, 0.0);
    LoopReport& noted = report.loops[i];
    const GearedContact& contact = *loops[i].loop.geared;
    report.gear_mode_hz = gearModes_hz(contact.M, contact.arm.gear_stiffness).minCoeff();
    if (noted.ratio_with_gears && *noted.ratio_with_gears <= ratio) continue;
    noted.ratio_with_gears = ratio;
    noted.module_with_gears = module;
  }
}

/// An assumption stands for it only where nothing else is said.
double judgedBeforeGears(const Scene& scene, const StabilityReport& report) {
  const double said_N_per_m = std::max(scene.stiffest_N_per_m, stiffestBeforeGears(scene));
  return said_N_per_m > 0.0 ? said_N_per_m : report.stiffest_N_per_m;
}

}  // namespace

std::string ofModule(const Scene& scene, int module) {
  return scene.module_links.size() > 1 ? " of " + scene.module_links[module] : "";
}

std::optional<StabilityReport> checkStability(const Scene& scene) {
  const PlantConfig plant = judgedPlant(scene);
  if (variantLoops(scene.controller, plant, scene.period_s).empty()) return std::nullopt;
  const StiffestContact stiffest = stiffestContact(scene);
  StabilityReport report;
  report.stiffest_N_per_m = stiffest.stiffness_N_per_m;
  report.stiffness_N_per_m = stiffnessOfLaw(scene.controller, stiffest.stiffness_N_per_m);
  double largest_ratio = std::numeric_limits<double>::infinity();
  std::vector<VariantLoop> loops;
  for (int i = 0; i < static_cast<int>(scene.controller.tactile_modules.size()); ++i) {
    std::vector<VariantLoop> of_module = variantLoops(scene.controller, plant, scene.period_s, i);
    if (stepsOfCommonPeriod(of_module.front().loop) == 0) {
      report.loops.clear();
      report.nearest.reset();
      report.warnings = {"margins not computed: cycle and samples hardly ever coincide"};
      return report;
    }
    std::vector<LoopReport> margins = marginsOf(of_module, report.ratio());
    noteNearest(margins, i, report);
    const double ratio = leastStable(margins).margins.largest_stiffness_ratio;
    if (i > 0 && ratio >= largest_ratio) continue;
    largest_ratio = ratio;
    report.module = i;
    report.loops = std::move(margins);
    loops = std::move(of_module);
  }
  const LoopReport& worst = leastStable(report.loops);
  if (worst.margins.phase_margin_rad == 0.0)
    failUnstable(scene, report, stiffest.key, loops, worst);
  report.warnings = warningsOf(scene, report, largest_ratio);
  return report;
}

double phaseMargin_deg(const Scene& scene) {
  try {
    const std::optional<StabilityReport> report = checkStability(scene);
    if (!report || !report->nearest) return std::numeric_limits<double>::infinity();
    return report->nearest->phaseMargin_deg();
  } catch (const InputError&) {
    return 0.0;
  }
}

void requirePhaseMargin(const Scene& scene, double least_deg) {
  const std::optional<StabilityReport> report = checkStability(scene);
  if (!report || !report->nearest) return;
  const LoopReport& nearest = *report->nearest;
  if (nearest.phaseMargin_deg() >= least_deg) return;
  const std::vector<VariantLoop> loops =
      variantLoops(scene.controller, judgedPlant(scene), scene.period_s, report->module_of_nearest);
  fail(scene, "controller.time_constant_s",
       fmt::format("{:.4g} s leaves a phase margin of {:.1f} degrees ({}{})",
                   scene.controller.gains.force.time_constant_s,
                   roundedDown(nearest.phaseMargin_deg()), nearest.name,
                   ofModule(scene, report->module_of_nearest)),
       timeConstantExpectation(loops, report->ratio()));
}

double stiffestBeforeGears(const Scene& scene) {
  double stiffest_N_per_m = 0.0;
  for (const ObstacleConfig& obstacle : scene.plant.obstacles)
    stiffest_N_per_m = std::max(stiffest_N_per_m, inSeries(obstacle.stiffness_N_per_m,
                                                           scene.arm->contact_stiffness_N_per_m));
  return stiffest_N_per_m;
}

void addGearMargins(const Scene& scene, StabilityReport& report) {
  if (!scene.arm || !scene.arm->has_gears || report.loops.empty()) return;
  const double stiffest_N_per_m = judgedBeforeGears(scene, report);
  const double law_N_per_m =
      stiffnessOfLaw(scene.controller, std::max(report.stiffest_N_per_m, stiffest_N_per_m));
  const PlantConfig plant = judgedPlant(scene);
  for (int i = 0; i < static_cast<int>(scene.controller.tactile_modules.size()); ++i) {
    std::vector<VariantLoop> loops = variantLoops(scene.controller, plant, scene.period_s, i);
    addGears(scene.controller, scene.arm->dynamics, law_N_per_m, loops, i);
    noteGears(loops, i, report);
  }
  for (const LoopReport& loop : report.loops) {
    if (!loop.ratio_with_gears || *loop.ratio_with_gears * law_N_per_m > stiffest_N_per_m) continue;
    report.warnings.push_back(fmt::format(
        "unstable with the arm's gears at its start ({}{}): in front of them stable to {:.0f} N/m, "
        "not in {:.0f} N/m; more time_constant_s, or a larger c",
        loop.name, ofModule(scene, loop.module_with_gears), *loop.ratio_with_gears * law_N_per_m,
        stiffest_N_per_m));
  }
}

}  // namespace tactus
