#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tactus/analysis/cover_fit.h"
#include "tactus/cli/commands.h"
#include "tactus/record/fault_text.h"
#include "tactus/record/log_continuity.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

struct IdentifyOptions {
  std::string what, path;
  std::vector<std::string> settings;
  int module = 0;
  bool json = false;
};

/// Of g - a in the module's frame, m/s^2: as it tilts by some two degrees.
constexpr double kMinChange = 0.3;
constexpr double kMaxRelativeDeviation = 0.1;
constexpr double kMaxCenterDeviation = 0.05;  ///< by the module's length
/// What is faster, or more in all, is no channel that drifts: a contact that begins looks like it.
constexpr double kMaxDrift_N_per_s = 0.02;
constexpr double kMaxDrift_N = 0.3;

[[noreturn]] void refuse(const IdentifyOptions& options, const std::string& problem,
                         const std::string& expectation) {
  failAt(beginOf(options.path), "cover", problem, "expected " + expectation);
}

/// What there is to find out, and what was found.
struct Identified {
  CoverEstimate estimate;
  std::string link;
  double threshold_N = 0.0, length_m = 0.0;
  std::optional<CoverConfig> simulated;  ///< where it is known
};

void checkModule(const IdentifyOptions& options, const Scene& scene) {
  const int modules = static_cast<int>(scene.controller.tactile_modules.size());
  if (modules == 0) refuse(options, "no tactile module is read", "a scene with a controller");
  if (options.module >= modules)
    refuse(options, fmt::format("there is no tactile module {}", options.module),
           fmt::format("0 to {}", modules - 1));
}

/// The fit of what `run` hands to its sink.
template <typename Run>
Identified fit(const IdentifyOptions& options, const Scene& scene, const Run& run) {
  const ControllerConfig& config = scene.controller;
  CoverFit fit(config, config.tactile_modules[options.module]);
  double before_s = kNoLimit;
  run([&](const CycleRecord& record) {
    const RobotInput input = recordedInput(record, config.chain.size());
    const double step_s = scene.period_s * (1.0 + static_cast<double>(record.missed_cycles));
    if (record.t_s - before_s > 1.5 * step_s) fit.skip(record.t_s - before_s - step_s);
    before_s = record.t_s;
    fit.add(input.q_measured, input.tactile[options.module], step_s);
  });
  return {fit.estimate(), scene.module_links[options.module],
          config.gains.force.contact_threshold_N, config.tactile_modules[options.module].length_m,
          std::nullopt};
}

Scene loadLogged(const IdentifyOptions& options, const LogDescription& description) {
  if (description.sources.empty())
    refuse(options, "the log holds no scene", "the log of a run of this version");
  Scene scene = loadScene(description.sources, description.overrides, SceneUse::kSimulation);
  checkModule(options, scene);
  const int joints = scene.controller.chain.size();
  const int modules = static_cast<int>(scene.controller.tactile_modules.size());
  if (description.shape.joints != joints || description.shape.modules != modules)
    refuse(options, "the cycles are not of the log's scene", "the log of a run of its scene");
  return scene;
}

Identified fitLog(const IdentifyOptions& options) {
  if (!options.settings.empty())
    failAt(beginOf("--set"), "-", "a log says what its scene was", "expected a scene");
  checkLog(options.path);
  std::ifstream in = openLog(options.path);
  UlogReader reader(in, options.path);
  return fit(options, loadLogged(options, reader.description()), [&](const auto& sink) {
    CycleRecord record;
    while (reader.next(record)) sink(record);
  });
}

/// Simulates the scene's motion, in which it touches nothing.
Identified fitScene(const IdentifyOptions& options) {
  Scene scene = loadScene(options.path, parseOverrides(options.settings), SceneUse::kSimulation);
  checkModule(options, scene);
  scene.plant.obstacles.clear();
  const std::optional<CoverConfig>& cover = scene.plant.modules[options.module].cover;
  if (!cover)
    refuse(options, "the simulated module has none",
           "its mass, as by --set simulation.tactile_module.cover.mass_kg=0.4");
  Identified found = fit(options, scene, [&](const auto& sink) {
    const FaultReport end = simulate(scene, CycleSink(sink)).figures.end;
    if (end.fault != Fault::kNone)
      refuse(options, "the run ends by " + faultEvent(end, scene), "a motion that ends by itself");
  });
  found.simulated = cover;
  return found;
}

void judgeDeviations(const IdentifyOptions& options, const Identified& found) {
  const Fitted& mass = found.estimate.mass_kg;
  // Readings that are all zero are a mass of 0 +- 0.
  if (!(mass.value > 0.0 && mass.deviation <= kMaxRelativeDeviation * mass.value))
    refuse(options, fmt::format("the mass is {:.3g} +- {:.2g} kg", mass.value, mass.deviation),
           fmt::format("a deviation of at most {} of it: a heavier cover, a longer log, or one "
                       "without contact",
                       kMaxRelativeDeviation));
  const double most_m = kMaxCenterDeviation * found.length_m;
  for (int axis = 0; axis < 3; ++axis) {
    const Fitted& center = found.estimate.center_m[axis];
    if (center.deviation <= most_m) continue;
    refuse(
        options,
        fmt::format("the centre's {} is {:.4f} +- {:.2g} m", "xyz"[axis], center.value,
                    center.deviation),
        fmt::format("a deviation of at most {:.2g} m, {:g} of the module's length: a longer log, "
                    "or a motion that tilts it more along its axis",
                    most_m, kMaxCenterDeviation));
  }
}

/// What the run does not tell, or not of a cover alone.
void judge(const IdentifyOptions& options, const Identified& found) {
  const CoverEstimate& estimate = found.estimate;
  const auto tooLittle = [&](double change, const char* where, const char* what) {
    if (change >= kMinChange) return;
    refuse(
        options,
        fmt::format("{} of the module gravity changes by {:.2g} m/s^2 alone, which does not "
                    "tell {}",
                    where, change, what),
        fmt::format("a slow motion that tilts it, for {} m/s^2 in root mean square", kMinChange));
  };
  if (estimate.blocks < CoverFit::kMinBlocks)
    refuse(options, fmt::format("{} s are too short", estimate.blocks),
           fmt::format("{} s or more", CoverFit::kMinBlocks));
  tooLittle(estimate.change_across, "across the axis", "the mass");
  tooLittle(estimate.change_along, "along the axis", "the centre");
  if (!(estimate.residual_N <= found.threshold_N))
    refuse(options, fmt::format("{:.3g} N of the readings are of no cover", estimate.residual_N),
           fmt::format("no contact, and at most contact_threshold_N = {:g} N", found.threshold_N));
  const double most_N_per_s = std::min(kMaxDrift_N_per_s, kMaxDrift_N / estimate.blocks);
  if (!(estimate.drift_N_per_s <= most_N_per_s))
    refuse(options, fmt::format("the readings drift by {:.3g} N/s", estimate.drift_N_per_s),
           fmt::format("no contact, a motion to and fro, and at most {:.3g} N/s: a module that is "
                       "warm",
                       most_N_per_s));
  judgeDeviations(options, found);
}

std::string toText(const Identified& found) {
  const CoverEstimate& estimate = found.estimate;
  const auto& [x, y, z] = estimate.center_m;
  std::string text = fmt::format(
      "module    {}, {} s without contact\n"
      "gravity   changes by {:.2g} m/s^2 across the axis, {:.2g} along\n",
      escaped(found.link), estimate.blocks, estimate.change_across, estimate.change_along);
  if (found.simulated) {
    const Vector3& center = found.simulated->p_ModuleCenter;
    text += fmt::format("simulated {:.4f} kg, centre x {:.4f}, y {:.4f}, z {:.4f} m\n",
                        found.simulated->mass_kg, center.x(), center.y(), center.z());
  }
  return text + fmt::format(
                    "mass      {:.4f} +- {:.4f} kg\n"
                    "centre    x {:.4f} +- {:.4f}, y {:.4f} +- {:.4f}, z {:.4f} +- {:.4f} m\n"
                    "left      {:.3g} N in root mean square, drift {:.2g} N/s\n"
                    "cover: {{mass_kg: {:.4f}, center_m: [{:.4f}, {:.4f}, {:.4f}]}}\n",
                    estimate.mass_kg.value, estimate.mass_kg.deviation, x.value, x.deviation,
                    y.value, y.deviation, z.value, z.deviation, estimate.residual_N,
                    estimate.drift_N_per_s, estimate.mass_kg.value, x.value, y.value, z.value);
}

Json toJson(const Identified& found) {
  const CoverEstimate& estimate = found.estimate;
  Json center = Json::array(), deviation = Json::array();
  for (const Fitted& c : estimate.center_m) {
    center.push_back(c.value);
    deviation.push_back(c.deviation);
  }
  Json simulated;
  if (found.simulated) {
    const Vector3& at = found.simulated->p_ModuleCenter;
    simulated = {{"mass_kg", found.simulated->mass_kg}, {"center_m", {at.x(), at.y(), at.z()}}};
  }
  return {{"tactile_module", found.link},
          {"cover", {{"mass_kg", estimate.mass_kg.value}, {"center_m", center}}},
          {"deviation", {{"mass_kg", estimate.mass_kg.deviation}, {"center_m", deviation}}},
          {"simulated", simulated},
          {"gravity_change_m_per_s2",
           {{"across", estimate.change_across}, {"along", estimate.change_along}}},
          {"residual_N", estimate.residual_N},
          {"drift_N_per_s", estimate.drift_N_per_s},
          {"duration_s", estimate.blocks}};
}

void identifyCover(const IdentifyOptions& options) {
  const std::filesystem::path extension = std::filesystem::path(options.path).extension();
  const bool is_scene = extension == ".yaml" || extension == ".yml";
  const Identified found = is_scene ? fitScene(options) : fitLog(options);
  judge(options, found);
  fmt::print("{}", options.json ? jsonText(toJson(found)) : toText(found));
}

}  // namespace

void addIdentifyCommand(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("identify", "Find what a robot.yaml has to say, from a log or a scene");
  const auto options = std::make_shared<IdentifyOptions>();
  command
      ->add_option("what", options->what,
                   "cover: mass and centre of a tactile module's cover, from a slow motion without "
                   "contact")
      ->required()
      ->check(CLI::IsMember({"cover"}));
  command
      ->add_option("run", options->path,
                   "Log of a run (run.ulg), or a scene (*.yaml, *.yml), which is simulated without "
                   "obstacles")
      ->required();
  command->add_option("--set", options->settings, kSetHelp)->allow_extra_args(false);
  command->add_option("--module", options->module, "Which of several tactile modules, from 0")
      ->check(CLI::Range(0, kMaxTactileModules - 1).description(""));
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    identifyCover(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
