#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/daemon/loop_link.h"
#include "tactus/daemon/tool_requests.h"
#include "tactus/scene/gain_plan.h"
#include "tactus/scene/json.h"

namespace tactus {

/// The time after which a change goes back by itself.
inline constexpr double kMinFor_s = 1e-3;
inline constexpr double kMaxFor_s = 86400.0;

/// Answers what is asked of a running daemon, as docs/control.md has it: one JSON object a request
/// and an answer, whatever the bytes are. Not for the loop; one thread.
class ControlRequests {
 public:
  /// scene: of the start.
  ControlRequests(const Scene& scene, LoopLink& link);

  /// The tool is told nothing for an asker who has left, or has been overtaken by a hold.
  std::string answer(std::string_view request, const Asker& asker = {});

  /// Looks what the loop has made of the last order. Returns a line for the journal, empty if
  /// nothing is new.
  std::string look();

 private:
  /// What a change is to those before it.
  struct Place {
    std::optional<std::size_t> steps_back{};  ///< an undo: of before_; 0: of what was on trial
    bool waits_for_free = false;              ///< begins at a moment without contact
  };
  /// Gains that were ordered, and are not kept yet.
  struct Trial {
    std::uint32_t number;
    Scene scene;
    Place place;
    bool is_for_a_time;
  };

  Json dispatch(const Json& request, const Asker& asker);
  Json set(const Json& request);
  Json reload(const Json& request);
  Json undo(const Json& request);
  Json tell(const std::string& what, const Json& request, const Asker& asker);
  Json showGains();
  Json show(const Json& request);
  std::string lookAtGains();
  Json order(GainPlan plan, const Json& request, Place place, std::uint32_t over = 0);
  void notice();
  void settle(std::uint32_t kept_number);
  std::ptrdiff_t keep(Trial trial);
  std::size_t nextStepsBack() const;
  double leastMargin();
  std::vector<Override> settingsThatHold();
  void refuseOthers(const GainPlan& plan);
  bool isTrying() const;
  bool isWaiting() const;
  void refuseUntilBack(bool waits_for_free) const;
  Scene& newest() { return isTrying() ? trials_.back().scene : kept_; }

  LoopLink& link_;
  const Scene started_;
  std::vector<Override> settings_;          ///< of the start, without those that a save replaced
  std::optional<double> least_margin_deg_;  ///< takes a while to know
  ToolRequests tool_;
  std::uint64_t read_hash_;  ///< of the scene file as it was last read
  Scene kept_;
  std::vector<Trial> trials_;  ///< as ordered; the loop knows first which is kept
  std::vector<Scene> before_;  ///< what was kept, the newest last
  std::uint32_t number_ = 0;
  GainReport report_;
  std::string news_;
};

}  // namespace tactus
