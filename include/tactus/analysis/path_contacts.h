#pragma once

#include <optional>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// Where a cover first touches an obstacle along a path that nothing disturbs.
struct PathTouch {
  int module = 0;
  double t_s = 0.0;
  double depth_m = 0.0;                   ///< of the obstacle in the cover, in that cycle
  double speed_m_per_s = 0.0;             ///< of the cover's surface into the obstacle, >= 0
  double deepest_m = 0.0;                 ///< of it in that cover on the whole path
  JointVector q;                          ///< in that cycle, m or rad
  Vector3 p_Base = Vector3::Zero();       ///< on the cover's axis, m
  Vector3 normal_Base = Vector3::Zero();  ///< unit vector out of the obstacle
};

/// Where a cover is fastest.
struct FastestCover {
  double speed_m_per_s = 0.0;  ///< of one of its ends; 0 where none moves
  double t_s = 0.0;
  int module = 0;
  JointVector q;                        ///< then, m or rad
  Vector3 p_Base = Vector3::Zero();     ///< of that end, m
  Vector3 direction = Vector3::Zero();  ///< of its motion, base frame, unit vector
};

/// An obstacle that touches a capsule, where no module feels it.
struct CapsuleTouch {
  int capsule = 0;
  int obstacle = 0;
  double t_s = 0.0;        ///< when it first does
  double depth_m = 0.0;    ///< then
  double deepest_m = 0.0;  ///< on the whole path
};

/// What the covers meet on the path of the task alone: no force control, no drives' lag.
struct PathContacts {
  std::vector<std::optional<PathTouch>> touches;  ///< one an obstacle
  std::vector<CapsuleTouch> unsensed;             ///< in the order of their first touch
  std::vector<FastestCover> fastest;              ///< one a module
  bool is_complete = false;                       ///< the path was followed for all of the duration
};

/// Of a long run its first kMaxFollowedCycles, so that a check stays quick.
inline constexpr double kMaxFollowedCycles = 3e5;
PathContacts followPath(const ControllerConfig& config, const PlantConfig& plant, double period_s,
                        double duration_s);

/// The motion without a contact, along a path that does not wait.
ControllerConfig undisturbed(ControllerConfig config);

}  // namespace tactus
