#include "tactus/daemon/running_log.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "tactus/daemon/run_status.h"
#include "tactus/record/run_error.h"
#include "tactus/record/run_log.h"
#include "tactus/scene/located_error.h"

namespace tactus {

std::string runningLog() {
  const std::string path = runtimePath(kStatusName);
  std::ifstream file(path, std::ios::binary);
  if (!file) throw RunError(fmt::format("{}: no daemon is running, or a log is to be named", path));
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const Json status = Json::parse(text, nullptr, false);
  const auto log = status.is_object() ? status.find("log") : status.end();
  if (log == status.end() || !log->is_object() || !log->contains("folder") ||
      !log->at("folder").is_string())
    throw RunError(fmt::format("{}: the daemon writes no log", escaped(path)));
  return log->at("folder").get<std::string>() + "/" + logName(0);
}

}  // namespace tactus
