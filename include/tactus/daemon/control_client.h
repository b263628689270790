#pragma once

#include <string>

#include "tactus/control/gains.h"
#include "tactus/io/packet_socket.h"
#include "tactus/scene/json.h"

namespace tactus {

/// A connection to the running daemon.
class ControlClient {
 public:
  /// Throws RunError: no daemon runs, or may not be asked.
  explicit ControlClient(const std::string& path);

  /// The answer of docs/control.md. Throws InputError with what the daemon refuses, and RunError if
  /// it does not answer.
  Json ask(const Json& request) const;

  /// The last answer to a change, with its `changes`: when the gains are there, or wait for a
  /// moment without contact; with `until_kept` when they are kept, or have gone back; after
  /// `at_most_s` in any case, with the `state` of then. Throws as ask(), and InputError where
  /// another change comes before that: answers then tell of that one.
  Json change(const Json& request, bool until_kept, double at_most_s = kNoLimit) const;

 private:
  PacketSocket socket_;
};

}  // namespace tactus
