#pragma once

#include <array>
#include <limits>
#include <optional>

#include "tactus/math/serial_chain.h"
#include "tactus/math/trajectory.h"
#include "tactus/math/types.h"

/// Everything a controller is told before it starts. A stage whose section is absent
/// (std::nullopt) does not exist: it costs nothing and keeps no state.
namespace tactus {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Limits of the last gate, one entry a joint; +-kNoLimit where there is none.
struct JointLimits {
  JointVector lower, upper;      ///< m or rad
  JointVector max_velocity;      ///< m/s or rad/s, > 0
  JointVector max_acceleration;  ///< m/s^2 or rad/s^2, > 0
};

/// What the tool shall do. After a contact, optional keys say how it gets back to its path; e, v
/// and p below have the task's components alone.
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
///   so it goes on as planned up to wait_beyond_m and stands still from twice that on.
struct TaskConfig {
  std::array<int, kMaxTaskSize> components{};  ///< 0..5: x, y, z, rx, ry, rz of the tool
  int size = 0;
  double drift_gain_per_s = 5.0;                     ///< beta in (2)
  std::optional<double> max_return_speed_m_per_s;    ///< v_max of position, > 0
  std::optional<double> max_return_speed_rad_per_s;  ///< v_max of rotation, > 0
  std::optional<double> wait_beyond_m;               ///< > 0
  TrajectoryConfig trajectory;
};

/// dH/dq_i of (1): zero in the middle of the range, rising linearly over the outer
/// `active_fraction` of each half range to `gradient_at_limit`.
struct JointLimitAvoidanceConfig {
  double gain = 1.0;                ///< alpha in (1)
  double gradient_at_limit = 3.52;  ///< m/s or rad/s
  double active_fraction = 0.507;   ///< of the half range, 0 < f <= 1
};

struct TactileModuleConfig {
  AttachedFrame link;              ///< frame of the module: x along the link
  double length_m = 0.0;           ///< contact lies at 0 <= x <= length
  double max_force_N = 100.0;      ///< a larger reading is a sensor fault
  double max_sample_age_s = 0.02;  ///< an older sample is a sensor fault
  double filter_cutoff_hz = 15.0;  ///< of the module's 3rd-order Butterworth filter
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

/// What happens to feedforward and integral when contact is lost and found; see
/// contact_transition.h, and for joint space joint_space_transition.h, for the equations.
struct ContactTransitionConfig {
  double max_time_constant_s = 1.0;  ///< T_t,max
  double distance_m = 0.05;          ///< d_t
  double engage_force_N = 0.0;       ///< F_eng: F_p over which the feedforward engages; 0: at once
  /// F_rel: F_sen at which contact is lost in joint space, and above which an arm that goes on
  /// after a stop is in contact.
  double release_force_N = 0.3;
  double search_speed_m_per_s = 0.01;  ///< v_search: joint space only, speed of the return
};

/// Algorithm 1; see stiffness_estimator.h. For null_limit see approach_estimator.h.
struct StiffnessEstimatorConfig {
  double min_force_change_N = 0.2;       ///< F_est,min
  double filter_time_constant_s = 0.03;  ///< T_est
  double min_N_per_m = 10.0;
  double max_N_per_m = 1e6;
};

struct ForceControlConfig {
  Variant variant = Variant::kNullSpace;
  int order = 2;                          ///< of the target dynamics (4): 1 or 2
  double time_constant_s = 0.1;           ///< T
  double damping = 0.5;                   ///< d, second order only
  double contact_threshold_N = 1.2;       ///< F_th
  double activation_force_N = 3.8;        ///< F_act, multi-space variants and null_limit only
  double max_null_speed_m_per_s = 5.0;    ///< limit of u_n,q for prismatic joints
  double max_null_speed_rad_per_s = 5.0;  ///< and for revolute joints
  double pull_gain_per_s = 500.0;         ///< beta of the pull, joint space only
  double min_approach_stiffness_N_per_m = 300.0;  ///< c_floor, null_limit only
  double assumed_stiffness_N_per_m = 7000;        ///< c_0
  ContactTransitionConfig transition;
  std::optional<StiffnessEstimatorConfig> estimator;
};

struct ControllerConfig {
  SerialChain chain;
  JointVector q_start{};
  JointLimits limits{};
  TaskConfig task{};
  JointVector weights{};  ///< diagonal of W, > 0
  std::optional<JointLimitAvoidanceConfig> joint_limit_avoidance{};
  std::optional<TactileModuleConfig> tactile_module{};
  double drive_lag_s = 0.005;  ///< nominal first-order lag of position; only null_limit asks
  std::optional<ForceControlConfig> force_control{};  ///< absent also for `variant: none`
};

}  // namespace tactus
