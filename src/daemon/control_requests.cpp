#include "tactus/daemon/control_requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "tactus/daemon/gain_save.h"
#include "tactus/daemon/gain_text.h"
#include "tactus/daemon/request_refusal.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/source_hash.h"

namespace tactus {
namespace {

constexpr std::size_t kKeptForUndo = 16;
constexpr std::size_t kMaxTrials = 16;  ///< that the loop has not told of

std::string valueText(const std::string& key, const Json& value) {
  if (value.is_null()) return "~";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number() || value.is_boolean()) return value.dump();
  refuseRequest(fmt::format("{} is no single value", inQuotes(key)), "a number, a word or null");
}

std::vector<Override> settingsOf(const Json& request) {
  const auto values = request.find("values");
  if (values == request.end() || !values->is_object() || values->empty())
    refuseRequest("no values", "an object of keys and values");
  std::vector<Override> settings;
  for (const auto& [key, value] : values->items()) settings.push_back({key, valueText(key, value)});
  return settings;
}

double duration_s(const Json& request) {
  const auto found = request.find("for_s");
  return found == request.end() ? kNoLimit : numberOf(*found, "for_s", kMinFor_s, kMaxFor_s);
}

Json gainsJson(const Gains& gains) {
  Json json = Json::object();
  for (const GainKey& key : gainKeys()) json[key.path] = gainAt(gains, key.offset);
  return json;
}

Json changesJson(const Gains& from, const Gains& to, const std::vector<std::string>& keys) {
  Json json = Json::object();
  for (const GainKey& key : gainKeys()) {
    if (std::ranges::find(keys, key.path) == keys.end()) continue;
    json[key.path] = {{"from", gainAt(from, key.offset)}, {"to", gainAt(to, key.offset)}};
  }
  return json;
}

std::string compact(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

ControlRequests::ControlRequests(const Scene& scene, LoopLink& link)
    : link_(link),
      started_(scene),
      settings_(scene.overrides),
      tool_(started_, link),
      read_hash_(sourceHash(scene.sources.front().text)),
      kept_(scene) {
  before_.reserve(kKeptForUndo);  // so that keep() never ends halfway
}

std::string ControlRequests::answer(std::string_view request, const Asker& asker) {
  try {
    const Json parsed = Json::parse(request, nullptr, false);
    if (!parsed.is_object()) refuseRequest("no JSON object", "one a message");
    return compact(dispatch(parsed, asker));
  } catch (const std::exception& error) {
    return compact({{"done", false}, {"error", error.what()}});
  }
}

Json ControlRequests::dispatch(const Json& request, const Asker& asker) {
  notice();  // what is planned is laid over what runs now
  const std::string what = wishOf(request);
  if (what == "set") return set(request);
  if (what == "reload") return reload(request);
  if (what == "undo") return undo(request);
  if (what == "show") return show(request);
  return tell(what, request, asker);
}

Json ControlRequests::tell(const std::string& what, const Json& request, const Asker& asker) {
  Json task;
  if (what == "move" || what == "stream") {
    task = tool_.move(request, asker);
  } else if (what == "follow") {
    task = tool_.follow(request, asker);
  } else if (what == "hold") {
    task = tool_.hold(request);
  } else {
    refuseRequest(fmt::format("do is {}", inQuotes(what)),
                  "one of set, reload, undo, show, move, follow, hold, stream");
  }
  return {{"done", true}, {"task", std::move(task)}};
}

/// False: what runs is what was kept, or is on its way there.
bool ControlRequests::isTrying() const {
  return !trials_.empty() && report_.trouble == GainTrouble::kNone;
}

/// For a moment without contact: nothing of it has begun.
bool ControlRequests::isWaiting() const {
  return isTrying() && trials_.back().place.waits_for_free && report_.state == GainState::kWaiting;
}

Json ControlRequests::set(const Json& request) {
  refuseUnknown(request, {"do", "values", "for_s"});
  const std::uint32_t over = isTrying() ? trials_.back().number : 0;
  if (over != 0 && trials_.back().is_for_a_time && duration_s(request) == kNoLimit)
    refuseRequest("gains are set for a time, which this would keep", "for_s, or undo before");
  return order(planSettings(newest(), settingsOf(request), leastMargin()), request,
               {.waits_for_free = isWaiting()}, over);
}

Json ControlRequests::reload(const Json& request) {
  refuseUnknown(request, {"do", "for_s", "only_read"});
  duration_s(request);  // a request that is refused has read nothing
  const bool only_read = flagOf(request, "only_read");
  std::vector<Override> settings = only_read ? settingsThatHold() : settings_;
  GainPlan plan = planReload(newest(), settings, leastMargin());
  if (only_read) refuseOthers(plan);
  if (!plan.keys.empty()) refuseUntilBack(isWaiting() || plan.waits_for_free);
  settings_ = std::move(settings);
  read_hash_ = sourceHash(plan.scene.sources.front().text);
  if (!plan.keys.empty()) return order(std::move(plan), request, {.waits_for_free = isWaiting()});
  newest() = std::move(plan.scene);  // comments may differ
  Json json = showGains();
  if (trials_.empty()) json["trouble"] = "";  // that of a change before is not this one's
  json["changes"] = Json::object();
  return json;
}

/// Without those of the start whose gains are others by now: what is saved takes their place. Of a
/// whole section that was set the gain is set behind it.
std::vector<Override> ControlRequests::settingsThatHold() {
  std::vector<Override> settings = settings_;
  const Gains &started = started_.controller.gains, &now = newest().controller.gains;
  for (const GainKey& key : gainKeys()) {
    const double gain = gainAt(now, key.offset);
    if (gainAt(started, key.offset) == gain) continue;
    std::erase_if(settings, [&](const Override& setting) { return setting.key == key.path; });
    const bool is_in_section = std::ranges::any_of(settings_, [&](const Override& setting) {
      return key.path.starts_with(setting.key + ".");
    });
    if (is_in_section) settings.push_back({key.path, Json(gain).dump()});
  }
  return settings;
}

/// Also what the settings of the start hide: the file alone has to say what was ordered.
void ControlRequests::refuseOthers(const GainPlan& plan) {
  std::string key = plan.keys.empty() ? "" : plan.keys.front();
  const Json differing =
      gainDifferences(newest().sources.front().path, gainsJson(newest().controller.gains));
  if (key.empty() && !differing.empty()) key = differing.items().begin().key();
  if (!key.empty())
    throw InputError(fmt::format("{} in the scene file is not what was ordered", key));
}

std::size_t ControlRequests::nextStepsBack() const {
  if (trials_.empty()) return 1;
  const auto& steps = trials_.back().place.steps_back;
  return steps ? *steps + 1 : 0;
}

Json ControlRequests::undo(const Json& request) {
  refuseUnknown(request, {"do"});
  if (!trials_.empty() && !isTrying()) throw InputError("undo: gains go back already");
  const std::size_t steps = nextStepsBack();
  if (steps > before_.size()) throw InputError("undo: nothing was changed before");
  const Scene& target = steps == 0 ? kept_ : before_[before_.size() - steps];
  GainPlan plan = planChange(newest(), target, leastMargin());
  // To what was kept gains go at once, as they do by themselves.
  plan.waits_for_free = steps > 0 && (plan.waits_for_free || isWaiting());
  return order(std::move(plan), request, {.steps_back = steps});
}

double ControlRequests::leastMargin() {
  if (!least_margin_deg_) least_margin_deg_ = leastMargin_deg(started_);
  return *least_margin_deg_;
}

Json ControlRequests::show(const Json& request) {
  refuseUnknown(request, {"do"});
  Json json = showGains();
  json["task"] = tool_.show();
  return json;
}

Json ControlRequests::showGains() {
  return {{"done", true},
          {"number", number_},
          {"state", gainStateName(report_.state)},
          {"trouble", gainTroubleText(report_)},
          {"is_for_a_time", isTrying() && trials_.back().is_for_a_time},
          {"scene", std::filesystem::absolute(newest().sources.front().path).string()},
          {"scene_hash", fmt::format("{:016x}", read_hash_)},
          {"kept", gainsJson(kept_.controller.gains)},
          {"ordered", gainsJson(newest().controller.gains)}};
}

/// Else gains that go back would stay half way.
void ControlRequests::refuseUntilBack(bool waits_for_free) const {
  if (waits_for_free && !trials_.empty() && !isTrying())
    refuseRequest("a key that waits for a moment without contact, while gains go back",
                  "it once they are back");
}

Json ControlRequests::order(GainPlan plan, const Json& request, Place place, std::uint32_t over) {
  GainOrder order{.number = number_ + 1, .gains = plan.scene.controller.gains};
  order.for_s = duration_s(request);  // may refuse, so before anything changes
  order.over = over;
  order.waits_for_free = place.waits_for_free = place.waits_for_free || plan.waits_for_free;
  refuseUntilBack(order.waits_for_free);
  const Json changes = changesJson(newest().controller.gains, order.gains, plan.keys);
  if (trials_.size() == kMaxTrials) trials_.erase(trials_.begin());
  trials_.push_back({order.number, std::move(plan.scene), place, order.for_s < kNoLimit});
  number_ = order.number;
  link_.gain_orders.put(order);
  report_ = {.number = number_, .state = GainState::kWaiting};
  Json json = showGains();
  json["changes"] = changes;
  return json;
}

std::string ControlRequests::look() {
  notice();
  return news_.empty() ? tool_.look() : std::exchange(news_, "");
}

void ControlRequests::notice() {
  const std::string news = lookAtGains();
  if (!news.empty()) news_ += (news_.empty() ? "" : "\ntactusd: ") + news;
  tool_.use(newest().controller.gains);
}

std::string ControlRequests::lookAtGains() {
  GainReport report;
  if (!link_.gain_reports.take(report)) return "";
  settle(report.kept_number);
  if (report.number != number_) return "";
  const bool is_new = report.state != report_.state || report.trouble != report_.trouble;
  if (!is_new) return "";
  report_ = report;
  if (report.state == GainState::kKept) trials_.clear();
  const std::string trouble = gainTroubleText(report);
  const bool has_gone_back = report.state == GainState::kKept && !trouble.empty();
  return fmt::format("gains: change {} {}{}{}", report.number,
                     has_gone_back ? "gone back" : gainStateName(report.state),
                     trouble.empty() ? "" : ": ", trouble);
}

/// Later orders may be on their way when one is kept: an undo among them then leads over more steps
/// or fewer, or, where it leads to what is no longer among those before, is a change as all others.
void ControlRequests::settle(std::uint32_t kept_number) {
  const auto kept = std::ranges::find(trials_, kept_number, &Trial::number);
  if (kept == trials_.end()) return;
  const std::ptrdiff_t more = keep(std::move(*kept));
  trials_.erase(trials_.begin(), std::next(kept));
  for (Trial& later : trials_) {
    auto& steps = later.place.steps_back;
    if (!steps) continue;
    const std::ptrdiff_t left = static_cast<std::ptrdiff_t>(*steps) + more;
    steps = left < 0 ? std::nullopt : std::optional<std::size_t>(left);
  }
}

/// Returns by how many those before have become more.
std::ptrdiff_t ControlRequests::keep(Trial trial) {
  const std::size_t steps = std::min(trial.place.steps_back.value_or(0), before_.size());
  if (steps == 0 && isSame(trial.scene.controller.gains, kept_.controller.gains)) return 0;
  std::swap(kept_, trial.scene);
  if (steps > 0) {
    before_.erase(before_.end() - static_cast<std::ptrdiff_t>(steps), before_.end());
    return -static_cast<std::ptrdiff_t>(steps);
  }
  if (before_.size() == kKeptForUndo) before_.erase(before_.begin());
  before_.push_back(std::move(trial.scene));
  return 1;
}

}  // namespace tactus
