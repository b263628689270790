#pragma once

#include <cstring>
#include <limits>
#include <type_traits>

/// What an engineer may tune while the arm runs: an input of each cycle like those of the sensors,
/// and logged like them. What a scene decides once is in controller_config.h. The members of a
/// stage that does not exist count for nothing.
namespace tactus {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// See TaskConfig for the equations; kNoLimit: neither limited nor waiting.
struct TaskGains {
  double drift_gain_per_s = 5.0;                 ///< beta in (2)
  double max_return_speed_m_per_s = kNoLimit;    ///< v_max of position, > 0
  double max_return_speed_rad_per_s = kNoLimit;  ///< v_max of rotation, > 0
  double wait_beyond_m = kNoLimit;               ///< > 0
  double wait_beyond_rad = kNoLimit;             ///< > 0, for the orientation
};

/// dH/dq_i of (1): zero in the middle of the range, rising linearly over the outer
/// `active_fraction` of each half range to `gradient_at_limit`.
struct JointLimitAvoidanceGains {
  double gain = 1.0;                ///< alpha in (1)
  double gradient_at_limit = 3.52;  ///< m/s or rad/s
  double active_fraction = 0.507;   ///< of the half range, 0 < f <= 1
};

/// How the null space leads the joints to a posture; see posture.h.
struct PostureGains {
  double gain_per_s = 0.5;        ///< k
  double max_speed_share = 0.05;  ///< of the largest velocity of each joint, > 0, at most 1
};

/// What happens to feedforward and integral when contact is lost and found; see
/// contact_transition.h, and for joint space joint_space_transition.h, for the equations.
struct ContactTransitionGains {
  double max_time_constant_s = 1.0;  ///< T_t,max
  double distance_m = 0.05;          ///< d_t
  double engage_force_N = 0.0;       ///< F_eng: F_p over which the feedforward engages; 0: at once
  /// F_rel: F_sen at which contact is lost in joint space and for null_limit, and above which an
  /// arm that goes on after a stop is in contact.
  double release_force_N = 0.3;
  double search_speed_m_per_s = 0.01;  ///< v_search: joint space only, speed of the return
};

/// Algorithm 1; see stiffness_estimator.h. For null_limit see approach_estimator.h.
struct StiffnessEstimatorGains {
  double min_force_change_N = 0.2;       ///< F_est,min
  double filter_time_constant_s = 0.03;  ///< T_est
  double min_N_per_m = 10.0;
  double max_N_per_m = 1e6;
};

struct ForceGains {
  double time_constant_s = 0.1;           ///< T
  double damping = 0.5;                   ///< d, second order only
  double contact_threshold_N = 1.2;       ///< F_th
  double activation_force_N = 3.8;        ///< F_act, multi-space variants and null_limit only
  double max_null_speed_m_per_s = 5.0;    ///< limit of u_n,q for prismatic joints
  double max_null_speed_rad_per_s = 5.0;  ///< and for revolute joints
  double pull_gain_per_s = 500.0;         ///< beta of the pull, joint space only
  double min_approach_stiffness_N_per_m = 300.0;  ///< c_floor, null_limit only
  double velocity_gain_per_s = 200.0;             ///< k_v, acceleration level only
  double assumed_stiffness_N_per_m = 7000.0;      ///< c_0
  ContactTransitionGains transition;
  StiffnessEstimatorGains estimator;
};

struct Gains {
  TaskGains task;
  JointLimitAvoidanceGains joint_limit_avoidance;
  PostureGains posture;
  ForceGains force;
};

static_assert(std::is_trivially_copyable_v<Gains> && std::is_standard_layout_v<Gains>);
static_assert(
    sizeof(Gains) == 8 * (5 + 3 + 2 + 10 + 5 + 4),
    "no padding, for gains are compared as bytes; a new one gets a row in scene_keys.cpp");

/// Of any of the above, to the bit.
template <typename T>
bool isSame(const T& a, const T& b) noexcept {
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits are what is asked for
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

}  // namespace tactus
