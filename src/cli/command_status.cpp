#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>

#include "tactus/cli/commands.h"
#include "tactus/daemon/run_status.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr std::chrono::seconds kWatchPeriod{1};

struct StatusOptions {
  bool watch = false;
  bool json = false;
};

std::string readStatus(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    const char* reason = errno == ENOENT ? kNoDaemon : std::strerror(errno);
    const char* help = errno == EACCES ? "; it is for root and the group tactus" : "";
    throw RunError(fmt::format("{}: {}{}", escaped(path), reason, help));
  }
  if (!std::filesystem::is_regular_file(path))
    throw RunError(fmt::format("{}: not a file", escaped(path)));
  return {std::istreambuf_iterator<char>(file), {}};
}

/// null stands for what JSON has no number for.
double numberAt(const Json& parent, const char* name) {
  const Json& value = parent.at(name);
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

std::string textAt(const Json& parent, const char* name) {
  return escaped(parent.at(name).get<std::string>());
}

long long countAt(const Json& parent, const char* name) { return parent.at(name).get<long long>(); }

std::string timesLine(const char* name, const Json& times) {
  const auto microseconds = [&](const char* figure) { return 1e-3 * numberAt(times, figure); };
  return fmt::format("{:<8} {:.1f} us, 99 % below {:.1f} us, at worst {:.1f} us\n", name,
                     microseconds("median"), microseconds("p99"), microseconds("max"));
}

std::string motionText(const Json& motion) {
  const auto of = [&](const char* name) { return numberAt(motion, name); };
  return fmt::format(
      "force    {:.2f} N, at most {:.2f} N so far; obstacle taken for {:.0f} N/m\n"
      "tool     {:.1f} mm off its path, at most {:.1f} mm\n",
      of("force_N"), of("peak_force_N"), of("stiffness_N_per_m"), 1e3 * of("tcp_error_m"),
      1e3 * of("tcp_error_max_m"));
}

std::string lostText(const Json& links) {
  std::string text;
  for (const Json& link : links) text += " " + escaped(link.get<std::string>());
  return text.empty() ? "" : "lost    " + text + ": goes on slowly without\n";
}

std::string logText(const Json& log) {
  const long long files = countAt(log, "files");
  std::string shown = "log      " + textAt(log, "state");
  if (log.contains("reason")) shown += ": " + textAt(log, "reason");
  return shown + fmt::format("; {} file{}\n", files, files == 1 ? "" : "s");
}

std::string statusText(const Json& status) {
  std::string shown =
      fmt::format("{} ({}), process {}\n{}\n", textAt(status, "scene"), textAt(status, "variant"),
                  countAt(status, "pid"), textAt(status, "description"));
  // What one of an older version does not say.
  const auto sayIfThere = [&](const char* label, const char* name) {
    const std::string text = status.contains(name) ? textAt(status, name) : "";
    if (!text.empty()) shown += label + text + "\n";
  };
  sayIfThere("waits    for ", "waits_for");
  sayIfThere("do       ", "remedy");
  if (status.contains("modules_lost")) shown += lostText(status.at("modules_lost"));
  if (status.contains("motion")) shown += motionText(status.at("motion"));
  shown += fmt::format("cycles   {}, {} missed, {} not logged\n", countAt(status, "cycles"),
                       countAt(status, "missed_cycles"), countAt(status, "dropped_records"));
  if (status.contains("log")) shown += logText(status.at("log"));
  return shown + timesLine("wakes", status.at("wake_latency_ns")) +
         timesLine("step", status.at("control_ns"));
}

struct Shown {
  std::string text;
  bool is_well = false;  ///< the daemon has no fault
  double age_s = 0.0;
};

Shown readShown(const std::string& path, bool as_json) {
  const std::string json = readStatus(path);
  try {
    const Json status = Json::parse(json);
    Shown shown;
    status.at("monotonic_s").get_to(shown.age_s);  // throws where there is none
    shown.age_s = statusAge_s(status);
    shown.is_well = textAt(status, "fault") == faultName(Fault::kNone);
    shown.text = statusText(status);  // also to see that all is there
    if (as_json) shown.text = json;
    return shown;
  } catch (const Json::exception&) {
    throw RunError(fmt::format("{}: not the status of a daemon", escaped(path)));
  }
}

/// True: the daemon lives, and has no fault.
bool showStatus(const StatusOptions& options) {
  const bool clears = options.watch && !options.json && ::isatty(STDOUT_FILENO) == 1;
  const std::string path = runtimePath(kStatusName);
  const Shown shown = readShown(path, options.json);
  const std::string problem = ageProblem(shown.age_s);
  const bool is_new = problem.empty();
  if (clears) std::fputs("\033[H\033[J", stdout);
  // The last word is worth knowing to people; a program would take it for that of now.
  if (is_new || !options.json) std::fputs(shown.text.c_str(), stdout);
  if (std::fflush(stdout) != 0) throw RunError("standard output: cannot be written");
  if (is_new) return shown.is_well;
  throw RunError(fmt::format("{}: {}", escaped(path), problem));
}

[[noreturn]] void watchStatus(const StatusOptions& options) {
  for (;;) {
    showStatus(options);
    std::this_thread::sleep_for(kWatchPeriod);
  }
}

}  // namespace

void addStatusCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("status", "Show what the service does");
  const auto options = std::make_shared<StatusOptions>();
  command->add_flag("--watch", options->watch, "Show it each second until the daemon ends");
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    if (options->watch) watchStatus(*options);
    exit_code = showStatus(*options) ? kExitDone : kExitFault;
  });
}

}  // namespace tactus
