#pragma once

#include <optional>
#include <string>

#include "tactus/panel/log_follower.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What a change of the running gains would do, as the daemon will judge it, before it is sent.
class GainCheck {
 public:
  /// start: of the daemon's run; without one its scene file, as it is now, stands for it. shown: an
  /// answer of the daemon to "show". values: keys and texts, as typed; none: of what runs. The
  /// answer has
  ///   - refused: why; empty: it is not,
  ///   - margin_deg: the phase margin; null: none can be computed, or needs none; and running_deg
  ///     of the gains as they are ordered,
  ///   - least_deg: below which a change is refused,
  ///   - warnings, and waits_for_free: begins at the next moment without contact.
  /// Throws InputError if the scene that runs is not to be had.
  Json check(const std::optional<RunStart>& start, const Json& shown, const Json& values);

 private:
  void load(const std::optional<RunStart>& start, const Json& shown);

  std::string loaded_;  ///< of which daemon and gains all this is
  std::optional<Scene> running_;
  double least_deg_ = 0.0, running_deg_ = 0.0;
};

}  // namespace tactus
