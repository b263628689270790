#include "tactus/cli/scope_run.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <istream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "tactus/cli/scope_page.h"
#include "tactus/cli/scope_text.h"
#include "tactus/daemon/running_log.h"
#include "tactus/record/growing_file.h"
#include "tactus/record/log_parts.h"
#include "tactus/record/logged_scene.h"
#include "tactus/record/output_file.h"
#include "tactus/record/touch_fit.h"
#include "tactus/record/ulog_reader.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

/// As it is now: who follows a run may make its window wider.
ScopeScreen ownScreen() {
  ScopeScreen screen;
  const bool is_terminal = ::isatty(STDOUT_FILENO) == 1;
  const char* const no_colour = std::getenv("NO_COLOR");
  screen.has_colour = is_terminal && (no_colour == nullptr || *no_colour == '\0');
  winsize size{};
  if (is_terminal && ::ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
    screen.columns = size.ws_col;
  return screen;
}

/// The condition and what the window follows from it: noise about F_th makes no contact.
struct ScopeTrigger {
  TriggerCondition condition;
  CaptureWindow window;
};

ScopeTrigger scopeTrigger(const ScopeOptions& options, const Scene& scene,
                          const RecordShape& shape) {
  const ForceGains& gains = scene.controller.gains.force;
  const bool is_default = options.trigger.empty();
  const std::string text =
      is_default ? fmt::format("force_N > {}", gains.contact_threshold_N) : options.trigger;
  ScopeTrigger trigger{parseTrigger(text, shape), {options.pre_s, options.post_s}};
  const double least_N = std::min(gains.transition.release_force_N, gains.contact_threshold_N);
  trigger.window.hysteresis =
      options.hysteresis.value_or(is_default ? gains.contact_threshold_N - least_N : 0.0);
  trigger.window.holdoff_s = options.holdoff_s.value_or(0.0);
  trigger.window.lead_s = kBeforeTouch_s;  // c_e is of all that led to F_th, however much is shown
  return trigger;
}

/// Takes cycles, shows captures.
class Scope {
 public:
  Scope(const ScopeOptions& options, Scene scene, const ScopeTrigger& trigger)
      : options_(options),
        scene_(std::move(scene)),
        ring_(trigger.condition, trigger.window),
        view_{options.log, trigger.condition, options.pre_s, options.post_s, {}} {}

  /// True: that was all. has_caught_up: it is to be shown at once, as all that comes later.
  bool add(const CycleRecord& record, bool has_caught_up) {
    if (has_caught_up && !is_live_) goLive(record.t_s);
    const std::optional<Capture> capture = ring_.add(record);
    if (capture && isWanted(*capture)) {
      keep(*capture);
      if (is_live_) show();
      return options_.is_single;
    }
    const bool is_late = record.t_s > shown_s_ + options_.pre_s + options_.post_s;
    if (is_live_ && options_.is_auto && is_late && !ring_.isWaiting()) showNewest();
    return false;
  }

  const Gains& gains() const { return scene_.controller.gains; }

  /// At the end of the run.
  void finish() {
    const std::optional<Capture> capture = ring_.unfinished();
    if (capture && isWanted(*capture)) {
      keep(*capture);
      has_new_ = true;
    }
    if (view_.traces.empty() && options_.is_auto) {
      const Capture newest = ring_.newest();
      if (!newest.records.empty()) keep(newest);
    }
    if (view_.traces.empty()) return showNone();
    if (has_new_) show();
  }

 private:
  /// What came before is shown once, but not to who waits for one.
  void goLive(double t_s) {
    is_live_ = true;
    live_s_ = shown_s_ = t_s;
    if (!view_.traces.empty() && !options_.is_single) show();
  }

  bool isWanted(const Capture& capture) const {
    return !options_.is_single || !options_.follows || capture.trigger_s >= live_s_;
  }

  void keep(const Capture& capture) {
    std::erase_if(view_.traces, [](const ScopeTrace& trace) { return !trace.is_triggered; });
    view_.traces.push_back(scopeTrace(scene_, view_.condition, capture));
    while (view_.traces.size() > static_cast<std::size_t>(options_.keep)) view_.traces.pop_front();
    shown_s_ = capture.records.back().t_s;
    unprinted_ = std::min(unprinted_ + 1, view_.traces.size());
    has_new_ = true;
  }

  void showNewest() {
    const Capture newest = ring_.newest();
    const std::deque<ScopeTrace> kept = std::exchange(view_.traces, {});
    keep(newest);
    show();
    view_.traces = kept;
  }

  void show() {
    has_new_ = false;
    if (!options_.output.empty()) writeWhole(options_.output, scopePage(view_));
    if (options_.json) {
      printJson();
    } else {
      const bool clears = options_.follows && ::isatty(STDOUT_FILENO) == 1;
      const std::string text = scopeText(view_, ownScreen());
      std::fputs(((clears ? "\033[H\033[2J" : "") + text).c_str(), stdout);
    }
    std::fflush(stdout);
  }

  void showNone() const {
    if (!options_.output.empty())
      failAt(beginOf(options_.output), "-o",
             "is not written: no trigger " + inQuotes(view_.condition.text),
             "expected a condition that the run meets, or --auto");
    if (options_.json) {
      if (!options_.follows) std::fputs("[]\n", stdout);
      return;
    }
    const std::string text = fmt::format("no trigger: {}\n", escaped(view_.condition.text));
    std::fputs(text.c_str(), stdout);
  }

  /// Of a run that is followed each trace once, the newest last.
  void printJson() {
    const std::size_t printed = options_.follows ? view_.traces.size() - unprinted_ : 0;
    Json all = Json::array();
    for (std::size_t i = printed; i < view_.traces.size(); ++i)
      all.push_back(scopeJson(view_.traces[i]));
    unprinted_ = 0;
    if (!options_.follows) std::fputs(jsonText(all).c_str(), stdout);
    for (const Json& trace : all)
      if (options_.follows) std::fputs((trace.dump() + "\n").c_str(), stdout);
  }

  const ScopeOptions& options_;
  Scene scene_;
  CaptureRing ring_;
  ScopeView view_;
  bool is_live_ = false, has_new_ = false;
  double live_s_ = kNoLimit, shown_s_ = 0.0;
  std::size_t unprinted_ = 0;  ///< of the traces the newest
};

Scope makeScope(const ScopeOptions& options) {
  std::ifstream in = openLog(options.log);
  const UlogReader reader(in, options.log);
  Scene scene = loggedScene(reader, options.log);
  ScopeTrigger trigger = scopeTrigger(options, scene, reader.description().shape);
  const std::string_view field = trigger.condition.columns.front().field;
  if (!reader.has(field)) {
    failAt(beginOf(options.log), field, "is not in this log, which is of an older version",
           "expected another field");
  }
  return {options, std::move(scene), trigger};
}

/// True: no more is wanted.
template <class IsLive>
bool scopeCycles(UlogReader& reader, const ScopeOptions& options, const Gains& gains, Scope& scope,
                 const IsLive& is_live) {
  reader.assumeGains(gains);
  CycleRecord record;
  while (reader.next(record))
    if (scope.add(record, is_live())) return true;
  if (reader.cutOff() && !options.follows)
    fmt::print(stderr, "{}: the log was cut off\n", escaped(options.log));
  return false;
}

}  // namespace

void runScope(ScopeOptions options) {
  if (options.log.empty()) {
    options.log = runningLog();
    options.follows = true;
  }
  if (options.output == "-")
    failAt(beginOf("-"), "-o", "standard output has the drawing", "expected a file for the page");
  if (!options.output.empty()) refuseOverwriting(options.log, options.output);
  if (!options.follows) checkLog(options.log);
  Scope scope = makeScope(options);
  const Gains gains = scope.gains();
  if (!options.follows) {
    std::ifstream in = openLog(options.log);
    UlogReader reader(in, options.log);
    scopeCycles(reader, options, gains, scope, [] { return false; });
  }
  std::optional<std::string> run;
  bool has_caught_up = false;
  for (bool goes_on = options.follows; goes_on;) {
    GrowingFile file(options.log);
    std::istream in(&file);
    UlogReader reader(in, options.log);
    if (!isOfRun(reader.description(), options.log, run)) break;
    const auto look = [&] { return has_caught_up = has_caught_up || file.isLive(); };
    if (scopeCycles(reader, options, gains, scope, look)) return;
    look();
    goes_on = file.goesOn();
  }
  scope.finish();
}

}  // namespace tactus
