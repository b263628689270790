#pragma once

#include <cstdio>
#include <functional>
#include <string>

#include "tactus/analysis/calibration_fit.h"
#include "tactus/cli/module_listener.h"

namespace tactus {

/// What the engineer says of a push: "5 +y 0.1" or "0 5 0 0.1" (N in the link's frame, m), with the
/// moment about x in Nm behind it where there is one. False: problem says why it is none.
bool parsePush(const std::string& line, double length_m, KnownPush& push, std::string& problem);

/// Why what the channels said while a push was held tells nothing; empty: it does.
std::string pushProblem(const ChannelWindow& held, const ChannelFigures& zero);

/// A recording, wherever the frames and the answers come from.
struct RecordSession {
  ListenedModule module;
  std::string link;
  CalibratedModule shape;
  FrameSource frames;
  std::function<bool(std::string& line)> answer;  ///< the next line; false: there is none any more
  std::FILE* out;                                 ///< for questions, and what was measured
  std::string path;                               ///< of the pushes; one that is there is continued
  /// What was typed before a question answers nothing; empty: of a file or a pipe, it does.
  std::function<void()> forget_typed{};
};

inline constexpr double kZero_s = 5.0, kHeld_s = 1.0;

/// Asks for the zero and for one push after the other, and appends each to the file, until there
/// are no more answers or an empty one. Throws InputError for a file that cannot be continued, and
/// RunError.
void recordPushes(const RecordSession& session);

}  // namespace tactus
