#pragma once

#include <cstdint>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/robot.h"
#include "tactus/math/tool_motion.h"

namespace tactus {

/// What a tool is told. It was checked: all of it is finite, and limits are above zero.
struct ToolOrder {
  enum class Kind : std::uint8_t {
    kGo,      ///< to rest at a pose, in place of all that was ordered before
    kGoNext,  ///< behind that
    kStream,  ///< as kGo; comes again and again, and if not, the tool is held
    kHold,    ///< stops, and forgets what was ordered
  };

  std::uint32_t number = 0;  ///< of whoever orders, to know the report by; not 0
  std::uint32_t run = 0;     ///< as ToolSight had it: after a stop it is another one
  Kind kind = Kind::kHold;
  double p_BaseTool_m[3] = {};
  double R_BaseTool[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< by columns
  ToolMotionLimits limits;
  double pause_s = 0.0;  ///< after arrival, before the next one
};

/// Of the reference's clock: from here on the tool is not held off, less is rounding.
inline constexpr double kFreeProgress = 1.0 - 1e-9;

/// What the loop sees of the tool.
struct ToolWatch {
  double passed_s = 0.0;     ///< since the last time, with cycles that were missed
  double path_time_s = 0.0;  ///< the reference's, in the next cycle
  double progress = 1.0;     ///< of its clock; less than 1 where the tool is held off
  double lag_m = 0.0, lag_rad = 0.0;
  /// To its reference, of the task's components; zero unless it is this that the reference waits
  /// for.
  Vector3 turn_waited_for_rad = Vector3::Zero();
  Pose X_BaseTool;  ///< of the desired configuration
  bool is_running = false;
  std::uint32_t run = 0;  ///< how often it has begun to
};

enum class ToolState : std::uint8_t {
  kHolding,  ///< told nothing
  kMoving,
  kBlocked,  ///< held off its way
  kArrived,
  kGivenUp,  ///< was blocked for too long
  kLate,     ///< a stream's next target did not come
  kStopped,  ///< the arm did not run, or no longer does
};

struct ToolReport {
  std::uint32_t number = 0;  ///< of the order that it speaks of
  ToolState state = ToolState::kHolding;
  int waiting = 0;  ///< orders behind it

  bool operator==(const ToolReport&) const = default;
};

/// Where the tool is, for those who tell it where to go.
struct ToolSight {
  ToolReport report;
  bool is_running = false;
  std::uint32_t run = 0;
  double q[kMaxJoints] = {};    ///< desired, m or rad
  double p_BaseTool_m[3] = {};  ///< where a motion told now would start
  double R_BaseTool[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  double force_N[kMaxTactileModules] = {};
  double position_m[kMaxTactileModules] = {};
};

/// Leads a tool from order to order. Where the tool is held off its way (see TaskConfig on
/// waiting), a new way begins where the tool is, as one from the reference would have to wait, too.
/// Once the arm stops, all orders are forgotten. Pure, and bounded.
class ToolOrders {
 public:
  static constexpr std::size_t kMaxWaiting = 256;

  explicit ToolOrders(const TaskCommandsConfig& config);

  /// An order for which there is no room, with all that it belongs to, ends in a hold.
  void order(const ToolOrder& order) noexcept;
  /// Once a cycle, before it.
  void update(const ToolWatch& seen, ToolMotion& motion) noexcept;
  const ToolReport& report() const noexcept { return report_; }

 private:
  void forget() noexcept;
  bool isGivenUp(const ToolOrder& order) const noexcept;
  bool isReplaced() const noexcept;
  void begin(const ToolOrder& order, const ToolWatch& seen, ToolMotion& motion) noexcept;
  void watch(const ToolWatch& seen, ToolMotion& motion) noexcept;
  void rest(const ToolWatch& seen, ToolState state, ToolMotion& motion) noexcept;
  bool isThere(const ToolWatch& seen, const ToolMotion& motion) const noexcept;

  TaskCommandsConfig config_;
  std::vector<ToolOrder> waiting_;  ///< a ring
  std::size_t first_ = 0, count_ = 0;
  ToolOrder current_;
  ToolReport report_;
  std::uint32_t refused_ = 0;  ///< number of orders for which there was no room
  double blocked_s_ = 0.0, paused_s_ = 0.0, silent_s_ = 0.0;
};

}  // namespace tactus
