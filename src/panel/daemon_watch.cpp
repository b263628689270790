#include "tactus/panel/daemon_watch.h"

#include <fmt/format.h>

#include <chrono>

#include "tactus/daemon/control_client.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/daemon/run_status.h"
#include "tactus/daemon/running_log.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/gain_keys.h"

namespace tactus {
namespace {

constexpr std::chrono::milliseconds kLook{100};
constexpr std::chrono::milliseconds kAsk{200};
/// The daemon answers at once.
constexpr double kMaxAnswerAge_s = 2.0;

/// Null where there is none.
Json entry(const Json& object, const char* name) {
  const auto found = object.is_object() ? object.find(name) : object.end();
  return found == object.end() ? Json() : *found;
}

/// What `show` says. Throws RunError of a daemon that says it in another way.
Json shownBy(const ControlClient& daemon) {
  Json shown = daemon.ask({{"do", "show"}});
  for (const char* name : {"ordered", "kept"})
    if (!entry(shown, name).is_object())
      throw RunError(fmt::format("the daemon is of another version: its gains have no {}", name));
  return shown;
}

/// Why the daemon writes no more of its log; empty: it does. Who follows it would wait for ever.
std::string logStop(const Json& status) {
  const Json log = entry(status, "log");
  if (entry(log, "state") != "stopped") return "";
  const Json reason = entry(log, "reason");
  return "the daemon's log has stopped: " + (reason.is_string() ? reason.get<std::string>() : "");
}

/// Gains on their way, where they are.
Json gainsNow(const LogNews& news, const Json& ordered) {
  Json now = Json::object();
  if (!news.gains || !news.is_live || !news.problem.empty()) return now;
  for (const GainKey& key : gainKeys()) {
    const Json value = gainAt(*news.gains, key.offset);
    if (ordered.contains(key.path) && value.dump() != ordered.at(key.path).dump())
      now[key.path] = value;
  }
  return now;
}

/// What a page shows of the status: with more that changes, each page is told all of it each time.
Json shortStatus(const Json& status) {
  Json shown = Json::object();
  for (const char* name :
       {"scene", "variant", "mode", "fault", "description", "waits_for", "remedy", "modules_lost"})
    if (status.contains(name)) shown[name] = status.at(name);
  return shown;
}

std::string textOf(Json event) {
  event["now_s"] = monotonicTime_s();
  return event.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

DaemonWatch::DaemonWatch(EventFeed& feed)
    : feed_(feed),
      asking_([this](const std::stop_token& stop) { ask(stop); }),
      watching_([this](const std::stop_token& stop) { watch(stop); }) {}

/// In a thread of its own: a daemon that hangs takes its time.
void DaemonWatch::ask(const std::stop_token& stop) {
  std::optional<ControlClient> daemon;
  while (!stop.stop_requested()) {
    Said said{nullptr, "", monotonicTime_s()};
    try {
      if (!daemon) daemon.emplace(controlPath());
      said.shown = shownBy(*daemon);
    } catch (const std::exception& error) {
      daemon.reset();
      said.problem = error.what();
    }
    said.at_s = monotonicTime_s();
    {
      const std::lock_guard lock(mutex_);
      said_ = std::move(said);
    }
    std::this_thread::sleep_for(kAsk);
  }
}

void DaemonWatch::watch(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    try {
      look();
    } catch (const std::exception& error) {
      tellProblem(error.what());
    }
    std::this_thread::sleep_for(kLook);
  }
}

/// Of what nobody foresaw, from a daemon of another version: the page goes on.
void DaemonWatch::tellProblem(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  const Json state = {
      {"run", run_},           {"is_there", false}, {"problem", "cannot be read: " + problem},
      {"control_problem", ""}, {"log_problem", ""}, {"links", Json::array()},
      {"is_reading", false}};
  publish(panel_.update(state, LogNews{}));
}

void DaemonWatch::publish(const Json& event) {
  if (!event.is_null()) feed_.publish(textOf(event));
}

void DaemonWatch::look() {
  const Json status = readRunStatus();
  const double age_s = statusAge_s(status);
  const std::lock_guard lock(mutex_);
  if (age_s <= kMaxStatusAge_s) followLog(status);
  LogNews news = log_ ? log_->news() : LogNews{};
  if (news.problem.empty()) news.problem = logStop(status);
  publish(panel_.update(state(status, age_s, news), news));
}

void DaemonWatch::followLog(const Json& status) {
  const std::string path = logOf(status);
  const Json cycles = entry(status, "cycles");
  if (cycles < cycles_) ++restarts_;  // in a container each daemon has the same pid
  cycles_ = cycles;
  const std::string run = fmt::format("{} {} {}", entry(status, "pid").dump(), restarts_, path);
  if (run == run_) return;
  run_ = run;
  log_.reset();
  if (!path.empty()) log_ = std::make_unique<LogFollower>(path);
}

bool DaemonWatch::isSaid() const {
  return !said_.shown.is_null() && monotonicTime_s() - said_.at_s <= kMaxAnswerAge_s;
}

/// Why there is no status; empty: there is one.
std::string DaemonWatch::problem(const Json& status, double age_s) const {
  if (age_s <= kMaxStatusAge_s) return "";
  if (const std::string refusal = statusRefusal(); !refusal.empty()) return "its status " + refusal;
  if (isSaid()) return "the daemon writes no status";
  const bool is_of_before = status.is_null() || age_s == kNoLimit;
  return is_of_before ? "no daemon is running" : "no word from the daemon";
}

Json DaemonWatch::state(const Json& status, double age_s, const LogNews& news) const {
  const bool is_fresh = age_s <= kMaxStatusAge_s;
  const bool may_be_there = is_fresh || isSaid() || !statusRefusal().empty();
  Json state = {{"run", run_}, {"is_there", may_be_there}, {"problem", problem(status, age_s)}};
  if (is_fresh) state["status"] = shortStatus(status);
  state["control_problem"] = isSaid() ? std::string() : said_.problem;
  if (isSaid()) {
    Json gains = said_.shown;
    state["task"] = entry(gains, "task");
    gains.erase("task");
    gains.erase("done");
    state["now"] = gainsNow(news, gains.at("ordered"));
    state["gains"] = std::move(gains);
  }
  state["links"] = news.links;
  state["log_problem"] = log_ ? news.problem : std::string("the daemon writes no log");
  state["is_reading"] = log_ && news.problem.empty() && !news.is_live;
  return state;
}

std::pair<std::string, std::uint64_t> DaemonWatch::all() const {
  const std::lock_guard lock(mutex_);
  return {textOf(panel_.all()), feed_.number()};
}

std::optional<RunStart> DaemonWatch::start() const {
  const std::lock_guard lock(mutex_);
  return log_ ? log_->start() : std::nullopt;
}

std::string DaemonWatch::signOfLife() { return textOf(Json::object()); }

}  // namespace tactus
