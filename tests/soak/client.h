#pragma once

#include <optional>
#include <string>

#include "support/random.h"
#include "tactus/daemon/control_client.h"

namespace tactus::soak {

/// Of all clients so far.
struct RequestCounts {
  long long sent = 0;
  long long refused = 0;
  long long gains = 0;    ///< changes of gains that were accepted
  long long targets = 0;  ///< and of targets
};

/// A scene of config/scenes with another variant, and a log of few and small files.
struct SoakScene {
  std::string base, variant;
  bool has_posture = false;
};
/// more: further lines of the controller's section.
void writeScene(const std::string& path, const SoakScene& scene, const std::string& more = "");

/// Who talks to the daemon by its control socket, and comes and goes: gains set, reloaded and
/// undone, targets, holds, and what is no request.
class Client {
 public:
  /// scene_path: of the file that the daemon was started with, which is written anew.
  Client(test::Random& random, std::string scene_path, SoakScene scene, RequestCounts& counts);

  void tell();  ///< a target or a hold
  void changeGains();
  void talkNonsense();

 private:
  void ask(const Json& request, long long& accepted);
  Json target();

  test::Random& random_;
  std::string scene_path_;
  SoakScene scene_;
  RequestCounts& counts_;
  std::optional<ControlClient> connection_;
};

}  // namespace tactus::soak
