#include "tactus/panel/panel_requests.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include "tactus/daemon/control_client.h"
#include "tactus/daemon/control_socket.h"
#include "tactus/daemon/gain_save.h"
#include "tactus/daemon/run_status.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/gain_keys.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/key_docs.h"

namespace tactus {
namespace {

constexpr int kBadRequest = 400, kRefused = 422, kNoDaemon = 503, kOwnFault = 500;
constexpr double kMaxLateness_s = 5.0;
constexpr std::array<std::string_view, 4> kPassedOn = {"set", "undo", "move", "hold"};

PanelAnswer failure(int status, const std::string& error) {
  return {status, {{"done", false}, {"error", error}}};
}

/// Whatever goes wrong is an answer.
PanelAnswer answerTo(const std::string& body, const std::function<Json(const Json&)>& answer) {
  const Json request = Json::parse(body, nullptr, false);
  if (!request.is_object()) return failure(kBadRequest, "expected one JSON object");
  try {
    Json json = answer(request);
    json["done"] = true;
    return {200, std::move(json)};
  } catch (const InputError& error) {
    return failure(kRefused, error.what());
  } catch (const RunError& error) {
    return failure(kNoDaemon, error.what());
  } catch (const std::exception& error) {
    return failure(kOwnFault, error.what());
  }
}

std::string wishOf(const Json& request) {
  const auto found = request.find("do");
  return found != request.end() && found->is_string() ? found->get<std::string>() : "";
}

/// A panel that was stopped, or a tunnel that stood, brings what its page has long given up: the
/// arm would move later, unasked. What a page knows of the clock is late, too, never early.
void refuseLate(const Json& request) {
  const auto asked = request.find("asked_s");
  const double age_s = asked != request.end() && asked->is_number()
                           ? monotonicTime_s() - asked->get<double>()
                           : -kNoLimit;
  if (age_s > kMaxLateness_s) throw InputError("came late, and nobody waits for it any more");
  if (!(age_s >= -kMaxLateness_s))
    throw InputError("asked_s: expected when it was asked, by the clock now_s of the events");
}

Json ask(Json request) {
  const std::string what = wishOf(request);
  if (what != "hold") refuseLate(request);
  request.erase("asked_s");
  if (what == "save") {
    const SavedGains saved = saveGains(ControlClient(controlPath()));
    return {{"scene", saved.path}, {"written", saved.is_new}};
  }
  if (std::ranges::find(kPassedOn, what) == kPassedOn.end())
    throw InputError("do: expected one of set, undo, save, move, hold");
  return ControlClient(controlPath()).ask(request);
}

}  // namespace

Json PanelRequests::keys() {
  Json keys = Json::array();
  for (const GainKey& key : gainKeys()) {
    keys.push_back({{"key", key.path},
                    {"unit", key.spec.unit},
                    {"symbol", key.spec.symbol},
                    {"meaning", key.spec.doc},
                    {"facts", keyFacts(key.spec)},
                    {"begins", contextName(key.spec.context)}});
  }
  return keys;
}

PanelAnswer PanelRequests::check(const std::string& body) {
  return answerTo(body, [this](const Json& request) {
    const Json shown = ControlClient(controlPath()).ask({{"do", "show"}});
    const std::lock_guard lock(mutex_);
    return check_.check(watch_.start(), shown, request.value("values", Json::object()));
  });
}

PanelAnswer PanelRequests::act(const std::string& body) { return answerTo(body, ask); }

}  // namespace tactus
