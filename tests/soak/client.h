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

/// Who talks to the daemon by its control socket, and comes and goes: gains set, reloaded and
/// undone, targets, holds, and what is no request.
class Client {
 public:
  /// scene_path: of the file that the daemon was started with, which is written anew.
  Client(test::Random& random, std::string scene_path, std::string variant, RequestCounts& counts);

  void tell();  ///< a target or a hold
  void changeGains();
  void talkNonsense();

 private:
  void ask(const Json& request, long long& accepted);
  Json target();

  test::Random& random_;
  std::string scene_path_, variant_;
  RequestCounts& counts_;
  std::optional<ControlClient> connection_;
};

/// The scene of a soak: tasks by command, a log of few and small files. more: further lines of the
/// controller's section.
void writeScene(const std::string& path, const std::string& variant, const std::string& more = "");

}  // namespace tactus::soak
