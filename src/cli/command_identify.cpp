#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "tactus/analysis/cover_fit.h"
#include "tactus/cli/commands.h"
#include "tactus/record/log_continuity.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

struct IdentifyOptions {
  std::string what, log;
  int module = 0;
  bool json = false;
};

/// Of g - a in the module's frame, m/s^2: as it tilts by some two degrees.
constexpr double kMinChange = 0.3;
constexpr double kMaxRelativeDeviation = 0.1;

[[noreturn]] void refuse(const IdentifyOptions& options, const std::string& problem,
                         const std::string& expectation) {
  failAt({std::make_shared<std::string>(options.log), 1, 1}, "cover", problem,
         "expected " + expectation);
}

Scene loadLogged(const IdentifyOptions& options, const LogDescription& description) {
  if (description.sources.empty())
    refuse(options, "the log holds no scene", "the log of a run of this version");
  Scene scene = loadScene(description.sources, description.overrides, SceneUse::kSimulation);
  const int modules = static_cast<int>(scene.controller.tactile_modules.size());
  if (modules == 0) refuse(options, "no tactile module is read", "a scene with a controller");
  if (options.module >= modules)
    refuse(options, fmt::format("there is no tactile module {}", options.module),
           fmt::format("0 to {}", modules - 1));
  const int joints = scene.controller.chain.size();
  if (description.shape.joints != joints || description.shape.modules != modules)
    refuse(options, "the cycles are not of the log's scene", "the log of a run of its scene");
  return scene;
}

CoverEstimate fit(const IdentifyOptions& options, std::string& link, double& threshold_N) {
  std::ifstream in = openLog(options.log);
  UlogReader reader(in, options.log);
  const Scene scene = loadLogged(options, reader.description());
  link = scene.module_links[options.module];
  threshold_N = scene.controller.gains.force.contact_threshold_N;
  CoverFit fit(scene.controller, scene.controller.tactile_modules[options.module]);
  CycleRecord record;
  while (reader.next(record)) {
    const RobotInput input = recordedInput(record, scene.controller.chain.size());
    const double step_s = scene.period_s * (1.0 + static_cast<double>(record.missed_cycles));
    fit.add(input.q_measured, input.tactile[options.module], step_s);
  }
  return fit.estimate();
}

/// What the log does not tell, or not of a cover alone.
void judge(const IdentifyOptions& options, const CoverEstimate& estimate, double threshold_N) {
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
  if (!(estimate.residual_N <= threshold_N))
    refuse(options, fmt::format("{:.3g} N of the readings are of no cover", estimate.residual_N),
           fmt::format("no contact, and at most contact_threshold_N = {:g} N", threshold_N));
  const Fitted& mass = estimate.mass_kg;
  if (!(mass.deviation <= kMaxRelativeDeviation * mass.value))
    refuse(options, fmt::format("the mass is {:.3g} +- {:.2g} kg", mass.value, mass.deviation),
           fmt::format("a deviation of at most {} of it: a heavier cover, a longer log, or one "
                       "without contact",
                       kMaxRelativeDeviation));
}

std::string toText(const CoverEstimate& estimate, const std::string& link) {
  const auto& [x, y, z] = estimate.center_m;
  return fmt::format(
      "module    {}, {} s without contact\n"
      "mass      {:.4f} +- {:.4f} kg\n"
      "centre    x {:.4f} +- {:.4f}, y {:.4f} +- {:.4f}, z {:.4f} +- {:.4f} m\n"
      "left      {:.3g} N in root mean square\n"
      "cover: {{mass_kg: {:.4f}, center_m: [{:.4f}, {:.4f}, {:.4f}]}}\n",
      link, estimate.blocks, estimate.mass_kg.value, estimate.mass_kg.deviation, x.value,
      x.deviation, y.value, y.deviation, z.value, z.deviation, estimate.residual_N,
      estimate.mass_kg.value, x.value, y.value, z.value);
}

Json toJson(const CoverEstimate& estimate, const std::string& link) {
  Json center = Json::array(), deviation = Json::array();
  for (const Fitted& c : estimate.center_m) {
    center.push_back(c.value);
    deviation.push_back(c.deviation);
  }
  return {{"tactile_module", link},
          {"cover", {{"mass_kg", estimate.mass_kg.value}, {"center_m", center}}},
          {"deviation", {{"mass_kg", estimate.mass_kg.deviation}, {"center_m", deviation}}},
          {"residual_N", estimate.residual_N},
          {"duration_s", estimate.blocks}};
}

void identifyCover(const IdentifyOptions& options) {
  checkLog(options.log);
  std::string link;
  double threshold_N = 0.0;
  const CoverEstimate estimate = fit(options, link, threshold_N);
  judge(options, estimate, threshold_N);
  fmt::print("{}", options.json ? jsonText(toJson(estimate, link)) : toText(estimate, link));
}

}  // namespace

void addIdentifyCommand(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("identify", "Find what a robot.yaml has to say, from a log");
  const auto options = std::make_shared<IdentifyOptions>();
  command
      ->add_option("what", options->what,
                   "cover: mass and centre of a tactile module's cover, from a slow motion without "
                   "contact")
      ->required()
      ->check(CLI::IsMember({"cover"}));
  command->add_option("log", options->log, "Log of a run (run.ulg)")->required();
  command->add_option("--module", options->module, "Which of several tactile modules, from 0")
      ->check(CLI::NonNegativeNumber);
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    identifyCover(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
