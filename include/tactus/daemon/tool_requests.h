#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "tactus/daemon/loop_link.h"
#include "tactus/daemon/tool_target.h"
#include "tactus/scene/json.h"
#include "tactus/scene/reach_check.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// Who asks, as far as the answer depends on it.
struct Asker {
  std::function<bool()> waits = nullptr;       ///< still for the answer; nullptr: yes
  std::function<bool()> hold_comes = nullptr;  ///< waits for the answer to this; nullptr: no
  bool is_overtaken = false;                   ///< a hold was answered before, though it came later
  /// Of the loop: when the request had not come yet. None: it has come just now.
  std::optional<std::int64_t> came_after_cycle{};
};

/// The part of ControlRequests that tells the tool where to go. Requests that are refused throw an
/// InputError, and nothing of them happens.
class ToolRequests {
 public:
  ToolRequests(const Scene& scene, LoopLink& link)
      : scene_(scene), link_(link), gains_(scene.controller.gains) {}

  /// The gains that the arm has, or is about to have.
  void use(const Gains& gains) { gains_ = gains; }

  Json move(const Json& request, const Asker& asker);  ///< also for `stream`
  Json follow(const Json& request, const Asker& asker);
  /// A stream that is under way is refused from then on, until it has paused for its timeout: else
  /// its next target would lead the tool on a moment later.
  Json hold(const Json& request);

  /// The member "task" of `show`: null for a task that nobody tells.
  Json show();

  /// As ControlRequests::look().
  std::string look();

 private:
  void requireCommands() const;
  void requireArm();
  void hearStream(const Asker& asker);
  void requireNoHold() const;
  bool isStreamAlive(const Asker& asker) const;
  Json postureJson() const;
  ToolTarget asked(const std::string& what, const Json& waypoint, const Pose& from,
                   ToolOrder::Kind kind) const;
  JointVector jointsOf(const ToolSight& sight) const;
  Reach reach(const std::string& what, const JointVector& q, const ToolTarget& target) const;
  Json order(const ToolOrder& order, double duration_s);
  void refresh();
  std::string eventText() const;
  int leaning() const;

  const Scene& scene_;
  LoopLink& link_;
  Gains gains_;
  ToolSight sight_;
  std::uint32_t number_ = 0;
  bool is_streaming_ = false;
  /// Of the loop, when a stream's last target was answered.
  std::int64_t streamed_cycle_ = std::numeric_limits<std::int64_t>::min() / 2;
  std::uint32_t stream_run_ = 0;  ///< of the last order, as ToolSight has it
  bool is_stream_held_ = false;   ///< a hold or a stop has come since it paused
  ToolReport told_;               ///< to whoever asks, until the loop has reported
  ToolReport looked_;             ///< as told to the journal
};

}  // namespace tactus
