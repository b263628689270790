#pragma once

#include <deque>
#include <string>

#include "tactus/cli/braille_canvas.h"
#include "tactus/cli/scope_trace.h"

namespace tactus {

/// What is on the screen of the scope.
struct ScopeView {
  std::string log;
  TriggerCondition condition;
  double pre_s = 0.0, post_s = 0.0;
  std::deque<ScopeTrace> traces;  ///< the newest last
};

struct ScopeScreen {
  int columns = 80;  ///< 40 at least
  bool has_colour = false;
};

/// The range of the time, and of forces or of the trigger's signal, that all traces fit into.
PlotRange forceRange(const ScopeView& view);
PlotRange signalRange(const ScopeView& view);

/// In braille characters. No line is longer than the screen, but for a path that is.
std::string scopeText(const ScopeView& view, const ScopeScreen& screen);

}  // namespace tactus
