#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <numbers>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/cli/commission_run.h"
#include "tactus/cli/commission_terminal.h"
#include "tactus/daemon/number_within.h"
#include "tactus/record/run_error.h"
#include "tactus/rt/scheduling.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

/// As an engineer says them.
struct CommissionArguments {
  std::string scene;
  std::optional<std::string> joint;
  std::vector<std::string> settings;
  CommissionOptions options;
  double measuring_error_deg = 0.2;
};

int jointNamed(const Scene& scene, const std::string& name) {
  const auto found = std::ranges::find(scene.joint_names, name);
  if (found != scene.joint_names.end()) return static_cast<int>(found - scene.joint_names.begin());
  const std::string nearest = nearestWord(name, scene.joint_names);
  throw InputError(fmt::format("--joint: {} is no joint of the robot, expected {}one of {}",
                               inQuotes(name),
                               nearest.empty() ? "" : "perhaps " + escaped(nearest) + ", ",
                               escaped(fmt::format("{}", fmt::join(scene.joint_names, ", ")))));
}

/// A later cycle than expected is no hazard, as drives watch over heartbeat and setpoints.
void printTimeLimits() {
  const RealTimeRequest request{.priority = 70};
  for (const Refusal& refusal : realTimeRefusals(request, applyRealTime(request)))
    fmt::print(
        "goes on without {}: after a late cycle a drive may stop by itself, and its joint is begun "
        "anew; to grant it: {}\n",
        refusal.what, refusal.how_to_grant);
}

int commissionScene(CommissionArguments arguments) {
  const Scene scene = loadHardwareScene(arguments.scene, arguments.settings, "to commission");
  CommissionOptions& options = arguments.options;
  if (arguments.joint) options.joint = jointNamed(scene, *arguments.joint);
  for (const DriveConfig& drive : scene.hardware->drives) {
    if (drive.kind == DriveKind::kMoteus)
      throw InputError(
          fmt::format("{}: the drive of joint {} is a moteus, expected drives of CiA "
                      "402: see moteus_tool for its calibration",
                      escaped(arguments.scene), scene.joint_names[drive.joint]));
  }
  options.revolute.measuring_error = arguments.measuring_error_deg * std::numbers::pi / 180.0;
  const CommissionConfig config = commissionConfig(scene, options);
  try {
    if (!options.is_scan_alone) printTimeLimits();
    CommissionTerminal desk(config, !options.is_scan_alone);
    return runCommission(scene, options, desk);
  } catch (const std::logic_error&) {
    throw;
  } catch (const InputError&) {
    throw;
  } catch (const std::runtime_error& error) {  // what the operating system refuses
    throw RunError(error.what());
  }
}

void addBound(CLI::App& command, const char* name, double& value, double least, double most,
              const char* text) {
  command.add_option(name, value, text)->check(numberWithin(least, most))->capture_default_str();
}

}  // namespace

void addCommissionCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "commission", "Find out sign, counts, offset and ends of each drive, one joint at a time");
  const auto arguments = std::make_shared<CommissionArguments>();
  MotionBounds& turning = arguments->options.revolute;
  MotionBounds& sliding = arguments->options.prismatic;
  command->add_option("SCENE", arguments->scene, "Scene file")->required();
  command->add_option_function<std::string>(
      "--joint", [arguments](const std::string& name) { arguments->joint = name; },
      "This joint alone, also if it is finished");
  command->add_option("--set", arguments->settings, kSetHelp)->allow_extra_args(false);
  addBound(*command, "--travel", turning.max_travel, 1e-3, kMostTravel_rad,
           "rad, of one motion of a revolute joint");
  addBound(*command, "--speed", turning.max_speed, 1e-3, kMostSpeed_rad_per_s, "rad/s");
  addBound(*command, "--slide", sliding.max_travel, 1e-4, kMostTravel_m,
           "m, of one motion of a prismatic joint");
  addBound(*command, "--slide-speed", sliding.max_speed, 1e-4, kMostSpeed_m_per_s, "m/s");
  addBound(*command, "--error", arguments->measuring_error_deg, 0.01, 2.0,
           "deg, by which an angle that you measure is wrong at most");
  addBound(*command, "--slide-error", sliding.measuring_error, 1e-5, 5e-3,
           "m, likewise of prismatic joints");
  addBound(*command, "--margin", turning.margin, 0.0, 1.0, "rad, kept from the ends");
  addBound(*command, "--slide-margin", sliding.margin, 0.0, 1.0, "m, likewise");
  addBound(*command, "--file-factor", arguments->options.file_factor, 1.5, 1e4,
           "A joint has no fewer counts than the file says, divided by this");
  command->add_flag(
      "--scan", arguments->options.is_scan_alone,
      "Name the nodes that answer, and move nothing; all nodes become pre-operational");
  CLI::Option* scan = command->get_option("--scan");
  command->add_flag("--json", arguments->options.json, "Print the nodes as JSON")->needs(scan);
  command->callback([arguments, &exit_code] { exit_code = commissionScene(*arguments); });
}

}  // namespace tactus
