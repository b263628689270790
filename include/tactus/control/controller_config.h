#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include "tactus/control/clearance_config.h"
#include "tactus/control/cover_load.h"
#include "tactus/control/gains.h"
#include "tactus/control/link_observer.h"
#include "tactus/math/serial_chain.h"
#include "tactus/math/tool_motion.h"
#include "tactus/math/trajectory.h"
#include "tactus/math/types.h"

/// What a controller is told before it starts and cannot change while it runs: its structure. A
/// stage that is absent here does not exist: it costs nothing and keeps no state. Numbers to be
/// tuned are in gains.h.
namespace tactus {

/// Limits of the last gate, one entry a joint; +-kNoLimit where there is none.
struct JointLimits {
  JointVector lower, upper;      ///< m or rad
  JointVector max_velocity;      ///< m/s or rad/s, > 0
  JointVector max_acceleration;  ///< m/s^2 or rad/s^2, > 0
};

/// Of a tool that is told where to go while it runs.
struct TaskCommandsConfig {
  ToolMotionLimits limits;
  double arrival_m = 0.001;       ///< so close to its target it has arrived
  double arrival_rad = 0.005;     ///< and so close in orientation
  double give_up_after_s = 10.0;  ///< of being held off its way
  double stream_timeout_s = 0.1;  ///< a stream's next target has to come within this
  bool start_measured = false;    ///< tactusd begins where it finds the arm
};

/// What the tool shall do. After a contact, TaskGains say how it gets back to its path; e, v and p
/// below have the task's components alone.
///   Return speed, of position and of rotation each by itself: the correction v = beta (w_d - w) of
///   (2) becomes
///     v min(1, max(0, v_max - p v / |v|) / |v|)
///   p = 0 but in the multi-space variants: there it is how fast the law's second space moved the
///   tool in the cycle before. In contact it holds v off, and a limit of v alone would take the
///   tool's restoring pull out of that loop, which then bounces off stiff obstacles. What is left
///   of v_max is the limit of joint space's pull, too. Point and direction of a contact that is
///   lost stay as they were, so that what is left of the law's answer adds nothing to the return.
///   Waiting: while the tool lags by e = |p_d - p|, the reference has a slower clock t_path,
///     dt_path/dt = s(e),   w_dot_d = s(e) dw_d/dt_path
///     s = 1 - 3 x^2 + 2 x^3 with x = e / wait_beyond_m - 1, clamped to 0..1
///   so it goes on as planned up to wait_beyond_m and stands still from twice that on. The same for
///   the orientation and wait_beyond_rad; the reference has the lesser s of both.
/// Orientation: its error is the rotation vector phi of R_d R^T, in the base frame. A task with one
/// or two of rx, ry, rz keeps those components of phi at zero, while the tool turns about the rest
/// as the null space likes; their rows are those of phi_dot, see rotation.h:
///   J = Jl^-T(phi) J_omega,   w_dot_d = Jl^-1(phi) omega_d
/// With all three phi is small, and both matrices are taken as I. Where a tool has turned by half a
/// turn about the rest phi changes its sign, and its rows do, too: what they ask for does not, as
/// long as nothing holds the tool off. Held off by 0.2 rad just there it jumps by some 0.1 rad/s.
struct TaskConfig {
  std::array<int, kMaxTaskSize> components{};  ///< 0..5: x, y, z, rx, ry, rz of the tool
  int size = 0;
  TrajectoryConfig trajectory;
  /// The reference is ControllerState::tool_motion instead; it rests at the start until it is
  /// changed.
  std::optional<TaskCommandsConfig> commands{};

  bool controls(int component) const noexcept {
    const auto end = components.begin() + size;
    return std::find(components.begin(), end, component) != end;
  }
  bool hasPosition() const noexcept { return controls(0) || controls(1) || controls(2); }
  bool hasRotation() const noexcept {
    return std::any_of(components.begin(), components.begin() + size,
                       [](int component) { return component >= 3; });
  }
  bool hasPartOfRotation() const noexcept {
    return hasRotation() && !(controls(3) && controls(4) && controls(5));
  }
};

struct TactileModuleConfig {
  AttachedFrame link;                  ///< frame of the module: x along the link
  double length_m = 0.0;               ///< contact lies at 0 <= x <= length
  double cover_radius_m = 0.06;        ///< around x
  double max_force_N = 100.0;          ///< a larger reading is a sensor fault
  double max_sample_age_s = 0.02;      ///< an older sample is a sensor fault
  double filter_cutoff_hz = 15.0;      ///< of the module's 3rd-order Butterworth filter
  bool feels_moment_x = false;         ///< its samples have M_x, by which the normal is known
  std::optional<CoverConfig> cover{};  ///< whose weight and inertia are taken out of its samples
};

enum class Variant {
  kNone,
  kNullSpace,
  kJointSpace,
  kTaskSpace,
  kNullTask,
  kNullJoint,
  kNullLimit,  ///< not the paper's: null space, and the approach-speed limit of approach_limit.h
};

/// The paper's, in which a second space gives way above F_act + F_th.
constexpr bool isOfTwoSpaces(Variant variant) {
  return variant == Variant::kNullTask || variant == Variant::kNullJoint;
}

/// In contact the arm rests at F_act + F_th at most, where the null space cannot do more.
constexpr bool hasActivationForce(Variant variant) {
  return isOfTwoSpaces(variant) || variant == Variant::kNullLimit;
}

/// What the law answers a contact with.
enum class ControlLevel {
  kVelocity,      ///< the paper's: control_law.h
  kAcceleration,  ///< acceleration_law.h; null space, null_task and null_limit only
};

/// Where on a tactile module null_limit limits the approach, as two contacts may press on one.
enum class LimitAt {
  kAuto,             ///< kResultant with one module, kStiffnessCentre with several
  kResultant,        ///< M / F alone
  kStiffnessCentre,  ///< there, and where changes of the force act: stiffness_centre.h
  kModuleEnds,       ///< at both ends, each with the whole force
};

struct ForceControlConfig {
  Variant variant = Variant::kNullSpace;
  ControlLevel level = ControlLevel::kVelocity;
  int order = 2;                      ///< of the target dynamics (4): 1 or 2
  bool has_estimator = false;         ///< of the stiffness; else it is as assumed
  double friction_coefficient = 0.0;  ///< mu_max that contacts may have; null_limit only
  LimitAt limit_at = LimitAt::kAuto;  ///< null_limit only
};

/// What an arm does that loses one of several tactile modules (silent, or no numbers) while nothing
/// pushes on that: it goes on at this share of its speed. The reference's clock, what brings the
/// tool back to its path and joints out of their limits' zones, and the largest speeds of the
/// joints are slowed alike; answers to the contacts of other modules are only bounded by the last.
/// Lost in a contact, or as the last good one, a module is a fault, which ends at rest.
struct ModuleLossConfig {
  double speed_share = 0.25;  ///< > 0, at most 1
};

struct ControllerConfig {
  SerialChain chain;
  JointVector q_start{};
  JointLimits limits{};
  TaskConfig task{};
  JointVector weights{};  ///< diagonal of W, > 0, with a median of 1: see redundancy.weights
  bool has_joint_limit_avoidance = false;
  /// That the null space leads to. Without joint-limit avoidance it would press joints against
  /// their limits, and what these keep it from doing drag the tool along.
  std::optional<JointVector> q_posture{};
  std::vector<TactileModuleConfig> tactile_modules{};  ///< at most kMaxTactileModules
  std::optional<ModuleLossConfig> module_loss{};       ///< absent: every loss is a fault
  Vector3 gravity_Base = Vector3::Zero();              ///< m/s^2; only covers ask
  std::optional<GearedLinks> geared_links{};  ///< only covers ask; absent: links are measured
  double drive_lag_s = 0.005;  ///< nominal first-order lag of position; only null_limit asks
  std::optional<ForceControlConfig> force_control{};  ///< absent also for `variant: none`
  std::optional<ClearanceConfig> clearance{};
  Gains gains{};  ///< no structure: what the first cycle is given, and all where nobody tunes
};

/// Whether contacts have rows of their own, see several_contacts.h; else a law answers one.
inline bool hasContactRows(const std::optional<ForceControlConfig>& force_control,
                           std::size_t modules) {
  if (modules > 1) return true;
  return force_control && (force_control->limit_at == LimitAt::kStiffnessCentre ||
                           force_control->limit_at == LimitAt::kModuleEnds);
}
inline bool hasContactRows(const ControllerConfig& config) {
  return hasContactRows(config.force_control, config.tactile_modules.size());
}

}  // namespace tactus
