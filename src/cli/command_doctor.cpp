#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactus/canopen/bus_load.h"
#include "tactus/cli/commands.h"
#include "tactus/cli/doctor_report.h"
#include "tactus/cli/scene_step.h"
#include "tactus/daemon/number_within.h"
#include "tactus/doctor/inspection.h"
#include "tactus/doctor/loop_measurement.h"
#include "tactus/io/can_socket.h"
#include "tactus/record/run_error.h"
#include "tactus/record/ulog_writer.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

struct DoctorOptions {
  std::string scene;
  std::string log_folder = ".";
  double duration_s = 60.0;
  bool json = false;
};

/// Without a scene: what the keys' defaults are, and the longest record.
constexpr RecordShape kLargestShape{kMaxJoints, kMaxTaskSize, true, kMaxTactileModules, true};

MachineNeeds needsOf(const std::optional<Scene>& scene, const DoctorOptions& options) {
  MachineNeeds needs;
  std::error_code problem;  // a folder that nobody may look into has no other name
  needs.log_folder = std::filesystem::weakly_canonical(options.log_folder, problem);
  if (problem) needs.log_folder = options.log_folder;
  const double period_s = scene ? scene->period_s : kDefaultPeriod_s;
  const RecordShape shape = scene ? describeLog(*scene).shape : kLargestShape;
  const LogConfig log = scene ? scene->log : LogConfig{};
  needs.log.bytes_per_s = static_cast<double>(logBytesACycle(shape)) / period_s;
  needs.log.reserve_bytes = log.min_free_bytes;
  if (log.max_bytes > 0.0) needs.log.most_bytes = (log.keep + 1) * log.max_bytes;
  if (!scene || !scene->hardware) return needs;
  needs.real_time = scene->hardware->real_time;
  needs.buses = scene->hardware->buses;
  needs.gpio = scene->hardware->gpio;
  return needs;
}

/// What a cycle has for waking late and the step: frames need the rest on the busiest bus, if all
/// feedback is to arrive within the cycle. Without buses, half of it.
double budget_s(const std::optional<Scene>& scene) {
  const double period_s = scene ? scene->period_s : kDefaultPeriod_s;
  if (!scene || !scene->hardware) return 0.5 * period_s;
  double share = 0.0;
  for (const BusLoad& load : busLoads(*scene->hardware, period_s))
    share = std::max(share, load.share());
  return (1.0 - share) * period_s;
}

/// Two loops of one priority would disturb each other, and one of them moves an arm.
std::vector<std::unique_ptr<InterfaceLock>> lockBuses(const std::vector<BusConfig>& buses) {
  std::vector<std::unique_ptr<InterfaceLock>> locks;
  try {
    for (const BusConfig& bus : buses)
      locks.push_back(std::make_unique<InterfaceLock>(bus.interface));
  } catch (const std::runtime_error& error) {
    throw RunError(error.what());
  }
  return locks;
}

LoopMeasurement measure(const std::optional<Scene>& scene, const RealTimeConfig& real_time,
                        double duration_s) {
  if (!scene) return measureLoop(real_time, kDefaultPeriod_s, duration_s, [] {});
  SceneStep step(*scene);
  return measureLoop(real_time, scene->period_s, duration_s, [&] { step.run(); });
}

bool runDoctor(const DoctorOptions& options) {
  std::optional<Scene> scene;
  if (!options.scene.empty()) scene = loadScene(options.scene, {});
  const MachineNeeds needs = needsOf(scene, options);
  const auto locks = lockBuses(needs.buses);
  std::vector<Finding> findings = inspectMachine("/", needs);
  if (!options.json) fmt::print(stderr, "running the loop for {:g} s ...\n", options.duration_s);
  const LoopMeasurement measured = measure(scene, needs.real_time, options.duration_s);
  findings.insert(findings.end(), measured.grants.begin(), measured.grants.end());
  const std::vector<Finding> times = judgeLoop(measured, budget_s(scene));
  findings.insert(findings.end(), times.begin(), times.end());
  const std::string report =
      options.json ? jsonText(doctorJson(findings, measured)) : doctorText(findings, measured);
  std::fputs(report.c_str(), stdout);
  return isFit(findings);
}

}  // namespace

void addDoctorCommand(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("doctor", "Is this machine fit for hard real time? Inspects and measures");
  const auto options = std::make_shared<DoctorOptions>();
  command->add_option("SCENE", options->scene, "Scene file whose robot and cycle are meant");
  command->add_option("--duration", options->duration_s, "Seconds that the loop runs; default 60")
      ->check(numberWithin(0.01, 1e6));
  command->add_option("-o,--output", options->log_folder, "Folder of the logs; default: this one");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback(
      [options, &exit_code] { exit_code = runDoctor(*options) ? kExitDone : kExitFault; });
}

}  // namespace tactus
