#pragma once

#include <string>

#include "tactus/daemon/control_client.h"
#include "tactus/scene/json.h"

namespace tactus {

/// The gains of a scene file that are not those that run: each key with `file` and `running`, null
/// without a limit. Throws InputError for a file that is no scene.
Json gainDifferences(const std::string& path, const Json& running);

struct SavedGains {
  std::string path;     ///< of the daemon's scene file
  bool is_new = false;  ///< it was written; as it was is now path~
  std::string state;    ///< of the gains, as the daemon names it: "kept" once they stay
};

/// Writes the gains that run into the daemon's scene file, with the rights of who calls this.
/// Throws InputError if it was changed since the daemon read it, RunError if it cannot be written.
SavedGains saveGains(const ControlClient& daemon);

}  // namespace tactus
