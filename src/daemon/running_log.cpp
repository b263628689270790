#include "tactus/daemon/running_log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tactus/daemon/run_status.h"
#include "tactus/record/run_error.h"
#include "tactus/record/run_log.h"
#include "tactus/scene/located_error.h"

namespace tactus {

Json readRunStatus() {
  std::ifstream file(runtimePath(kStatusName), std::ios::binary);
  if (!file) return nullptr;
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  Json status = Json::parse(text, nullptr, false);
  return status.is_object() ? status : Json();
}

std::string statusRefusal() {
  const bool is_refused = ::access(runtimePath(kStatusName).c_str(), R_OK) != 0 && errno == EACCES;
  return is_refused ? "may not be read; it is for root and the group tactus" : "";
}

std::string logOf(const Json& status) {
  const auto log = status.is_object() ? status.find("log") : status.end();
  if (log == status.end() || !log->is_object() || !log->contains("folder") ||
      !log->at("folder").is_string())
    return "";
  return log->at("folder").get<std::string>() + "/" + logName(0);
}

std::string runningLog() {
  const std::string path = runtimePath(kStatusName);
  if (!std::filesystem::exists(path))
    throw RunError(fmt::format("{}: {}; a log may be named, too", escaped(path), kNoDaemon));
  if (const std::string refusal = statusRefusal(); !refusal.empty())
    throw RunError(fmt::format("{}: {}", escaped(path), refusal));
  const Json status = readRunStatus();
  if (status.is_null())
    throw RunError(fmt::format("{}: not the status of a daemon", escaped(path)));
  // One that was killed leaves its status. Who followed its log would wait for ever.
  if (const std::string problem = ageProblem(statusAge_s(status)); !problem.empty())
    throw RunError(fmt::format("{}: {}; a log may be named, too", escaped(path), problem));
  const std::string log = logOf(status);
  if (log.empty()) throw RunError(fmt::format("{}: the daemon writes no log", escaped(path)));
  return log;
}

}  // namespace tactus
