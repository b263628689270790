#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <vector>

#include "tactus/panel/log_follower.h"
#include "tactus/scene/json.h"

namespace tactus {

/// What a page shows. An event is an object of what is new: "state" as a whole, "force" as
/// forceJson(), "contacts" that are over, "lasting" contacts; a page that begins gets one of all.
class PanelState {
 public:
  /// Takes over what is new, and tells it; null: nothing is. state: as DaemonWatch makes it, with
  /// the member "run"; with another run all that was is forgotten, and "begins" is true.
  Json update(const Json& state, const LogNews& news);

  Json all() const;

 private:
  Json takeForce(const LogNews& news);
  Json pastForce() const;
  int modules() const noexcept { return static_cast<int>(links_.size()); }

  Json state_;
  std::vector<std::string> links_;
  bool is_live_ = false;
  std::deque<ForceBin> past_;
  std::deque<Json> contacts_;
  Json lasting_ = Json::array();
};

}  // namespace tactus
