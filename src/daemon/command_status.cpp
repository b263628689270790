#include <fmt/format.h>
#include <unistd.h>
#include <yaml-cpp/yaml.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <thread>

#include "tactus/daemon/commands.h"
#include "tactus/daemon/located_error.h"
#include "tactus/daemon/run_error.h"
#include "tactus/daemon/run_status.h"

namespace tactus {
namespace {

/// Where the unit's RuntimeDirectory= is.
constexpr const char* kServiceFolder = "/run/tactus";
/// The daemon writes each half second.
constexpr double kMaxAge_s = 2.0;
constexpr std::chrono::seconds kWatchPeriod{1};

struct StatusOptions {
  bool watch = false;
  bool json = false;
};

std::string statusPath() {
  const char* folder = std::getenv("RUNTIME_DIRECTORY");
  return fmt::format("{}/{}", folder && *folder ? folder : kServiceFolder, kStatusName);
}

std::string readStatus(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    const char* reason = errno == ENOENT ? "no daemon is running" : std::strerror(errno);
    throw RunError(fmt::format("{}: {}", escaped(path), reason));
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string timesLine(const char* name, const YAML::Node& times) {
  const auto microseconds = [&](const char* figure) { return 1e-3 * times[figure].as<double>(); };
  return fmt::format("{:<8} {:.1f} us, 99 % below {:.1f} us, at worst {:.1f} us\n", name,
                     microseconds("median"), microseconds("p99"), microseconds("max"));
}

std::string motionText(const YAML::Node& motion) {
  const auto number = [&](const char* name) { return motion[name].as<double>(); };
  return fmt::format(
      "force    {:.2f} N, at most {:.2f} N so far; stiffness {:.0f} N/m\n"
      "tool     {:.1f} mm off its path, at most {:.1f} mm\n",
      number("force_N"), number("peak_force_N"), number("stiffness_N_per_m"),
      1e3 * number("tcp_error_m"), 1e3 * number("tcp_error_max_m"));
}

std::string statusText(const YAML::Node& status) {
  const auto text = [&](const char* name) { return escaped(status[name].as<std::string>()); };
  std::string shown = fmt::format("{} ({}), process {}\n{}\n", text("scene"), text("variant"),
                                  text("pid"), text("description"));
  if (status["motion"]) shown += motionText(status["motion"]);
  shown += fmt::format("cycles   {}, {} missed, {} not logged\n", text("cycles"),
                       text("missed_cycles"), text("dropped_records"));
  return shown + timesLine("wakes", status["wake_latency_ns"]) +
         timesLine("step", status["control_ns"]);
}

/// True: the daemon lives, and has no fault.
bool showStatus(const StatusOptions& options) {
  const std::string path = statusPath();
  const std::string json = readStatus(path);
  try {
    const YAML::Node status = YAML::Load(json);  // JSON is YAML, too
    const double age_s = monotonicTime_s() - status["monotonic_s"].as<double>();
    const std::string shown = options.json ? json : statusText(status);
    std::fputs(shown.c_str(), stdout);
    std::fflush(stdout);
    if (age_s <= kMaxAge_s) return status["fault"].as<std::string>() == "none";
    throw RunError(fmt::format("{}: no word from the daemon for {:.0f} s", escaped(path), age_s));
  } catch (const YAML::Exception&) {
    throw RunError(fmt::format("{}: not the status of a daemon", escaped(path)));
  }
}

[[noreturn]] void watchStatus(const StatusOptions& options) {
  const bool clears = !options.json && ::isatty(STDOUT_FILENO) == 1;
  for (;;) {
    if (clears) std::fputs("\033[H\033[J", stdout);
    showStatus(options);
    if (!clears) std::fputs("\n", stdout);
    std::this_thread::sleep_for(kWatchPeriod);
  }
}

}  // namespace

void addStatusCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("status", "Show the running daemon");
  const auto options = std::make_shared<StatusOptions>();
  command->add_flag("--watch", options->watch, "Show it each second until the daemon ends");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    if (options->watch) watchStatus(*options);
    exit_code = showStatus(*options) ? kExitDone : kExitFault;
  });
}

}  // namespace tactus
