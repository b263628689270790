#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/control/cover_load.h"
#include "tactus/control/tactile_channels.h"
#include "tactus/math/link_capsule.h"
#include "tactus/sim/arm_dynamics.h"
#include "tactus/sim/shape_config.h"

namespace tactus {

/// A layer of foam before the solid part: `stiffness_N_per_m` until the force reaches
/// `until_force_N`. Every slope is in series with the solid part and the robot.
struct FoamLayer {
  double stiffness_N_per_m = 0.0;
  double until_force_N = 0.0;
};

/// A motion of an obstacle around its place: way sin(2 pi frequency t), t since it appeared.
struct Swing {
  double x_m = 0.0;
  double y_m = 0.0;
  double frequency_hz = 0.0;
  double z_m = 0.0;
};

/// A vertical line at (x, y) in the base frame that pushes on the covers of the tactile modules,
/// horizontally, wherever it crosses one: a latex band, or a profile behind foam; or one of the
/// shapes below in its place, which push away from themselves. With friction it pulls along the
/// cover, too.
struct ObstacleConfig {
  double x_m = 0.0;
  double y_m = 0.0;
  double stiffness_N_per_m = 0.0;  ///< of the solid part
  std::vector<FoamLayer> foam;     ///< outermost first, forces rising
  double appears_s = 0.0;
  double vanishes_s = kNoLimit;
  Swing swing{};
  double friction_coefficient = 0.0;  ///< mu of the cover on it
  /// The largest force that it bears: beyond it its foot slides away, whichever cover pushes, and
  /// stays where it came to. Absent: it stands.
  std::optional<double> slide_force_N{};
  /// Of the bristle that sticks, in series with the robot; as the solid part if not given.
  std::optional<double> shear_stiffness_N_per_m{};
  std::optional<SphereConfig> sphere{};  ///< at most one of these
  std::optional<PlaneConfig> plane{};
  std::optional<LineConfig> line{};
  std::optional<PostConfig> post{};
};

/// Where the force is filtered.
enum class FilterPlace {
  kModule,  ///< in the module, at its own rate
  kReader,  ///< once a sample in who reads it, which is simulated, too
  kNone,    ///< in a reader that is not
};

/// A simulated tactile module: its cover and its electronics.
struct SimulatedModuleConfig {
  double cover_radius_m = 0.06;
  double filter_cutoff_hz = 15.0;  ///< 3rd-order Butterworth
  double filter_rate_hz = 1000.0;  ///< rate at which the module filters
  TactileChannels channels;
  bool quantised = true;
  FilterPlace filter_place = FilterPlace::kModule;
  double noise_N = 0.0;                        ///< standard deviation of one channel
  double lost_share = 0.0;                     ///< of the samples, each by chance
  double jitter_s = 0.0;                       ///< a sample comes late by up to that, by chance
  std::uint64_t seed = 1;                      ///< of noise, losses and jitter
  std::vector<double> channel_gains;           ///< of the eight channels; empty: 1
  std::vector<double> channel_drifts_N_per_s;  ///< likewise, since the start; empty: 0
  double direction_error_rad = 0.0;            ///< by which the cells are turned about x
  std::optional<CoverConfig> cover;            ///< absent: it weighs nothing
  bool tared = true;  ///< false: a module that leaves the tare to a reader that is not simulated
};

/// A velocity loop of second order.
struct VelocityLoopConfig {
  double bandwidth_hz = 0.0;  ///< > 0
  double damping_ratio = 0.7;
};

/// What drives do beside following.
struct DriveEffectsConfig {
  double dead_time_s = 0.0;                  ///< of setpoints
  JointVector max_acceleration{};            ///< the drive's own ramp, one a joint; empty: none
  std::optional<VelocityLoopConfig> loop{};  ///< in place of the lag, if given
  bool reports_links = false;                ///< of an arm with gears; false: where its motors are
};

struct PlantConfig {
  double drive_lag_s = 0.005;  ///< first-order lag of position; 0: ideal drives
  DriveEffectsConfig drives;
  std::optional<ArmDynamicsConfig> dynamics;   ///< in place of that lag, if given
  double robot_stiffness_N_per_m = kNoLimit;   ///< of the arm, in series with every obstacle
  Vector3 gravity_Base = Vector3::Zero();      ///< m/s^2; only covers feel it
  std::vector<SimulatedModuleConfig> modules;  ///< in the order of those that the controller reads
  std::vector<ObstacleConfig> obstacles;
  /// Parts of links that obstacles push on and nothing feels; none: contact on covers alone.
  std::vector<LinkCapsule> capsules;
  std::optional<SerialChain> chain{};  ///< the arm's, where it is not what the controller believes
};

}  // namespace tactus
