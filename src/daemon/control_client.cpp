#include "tactus/daemon/control_client.h"

#include <fmt/format.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <system_error>
#include <thread>
#include <vector>

#include "tactus/daemon/run_status.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

/// Loading a scene and its margins take a daemon some tenths of a second.
constexpr double kPatience_s = 10.0;
constexpr std::chrono::milliseconds kAskAgain{100};
constexpr std::size_t kMaxAnswer = std::size_t{1} << 18;

const char* reasonText(int reason) {
  switch (reason) {
    case ENOENT:
    case ECONNREFUSED:
      return kNoDaemon;
    case EACCES:
      return "may not be written; it is for root and the group tactus-control";
    default:
      return std::strerror(reason);
  }
}

bool isOnItsWay(const Json& answer, bool until_kept) {
  const Json& state = answer.at("state");
  if (state == "ramping" || state == "going_back") return true;
  return until_kept && (state == "waiting" || state == "on_trial");
}

}  // namespace

ControlClient::ControlClient(const std::string& path) {
  try {
    socket_ = PacketSocket::connectTo(path, kPatience_s);
  } catch (const std::system_error& error) {
    throw RunError(fmt::format("{}: {}", escaped(path), reasonText(error.code().value())));
  }
}

Json ControlClient::ask(const Json& request) const {
  std::vector<char> answer(kMaxAnswer);
  // One that has too many clients refuses before it is asked: why has come, though nothing is sent.
  socket_.send(request.dump(-1, ' ', false, Json::error_handler_t::replace));
  const long size = socket_.receive(answer);
  if (size <= 0 || static_cast<std::size_t>(size) > answer.size())
    throw RunError("the daemon does not answer");
  const Json json = Json::parse(answer.begin(), answer.begin() + size, nullptr, false);
  if (!json.is_object() || !json.contains("done")) throw RunError("not the answer of a daemon");
  if (json.at("done") == true) return json;
  throw InputError(json.value("error", "refused"));
}

Json ControlClient::change(const Json& request, bool until_kept, double at_most_s) const {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const auto hasTime = [&] {
    return std::chrono::duration<double>(Clock::now() - begin).count() < at_most_s;
  };
  Json answer = ask(request);
  const Json number = answer.at("number");
  const Json changes = answer.at("changes");
  // Also an order in which nothing differs is on its way; a reload without one answers as it is.
  if (changes.empty() && answer.at("state") != "waiting") return answer;
  do {
    std::this_thread::sleep_for(kAskAgain);  // the loop takes an order within some cycles
    answer = ask({{"do", "show"}});
    if (answer.at("number") != number)  // what it tells is not of ours
      throw InputError(
          "another change has come meanwhile, which may have taken this one back; "
          "`tactus diff` shows what runs");
  } while (isOnItsWay(answer, until_kept) && hasTime());
  answer["changes"] = changes;
  return answer;
}

}  // namespace tactus
