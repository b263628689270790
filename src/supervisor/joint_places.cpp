#include "tactus/supervisor/joint_places.h"

#include <cmath>

namespace tactus {
namespace {

JointVector maxFollowingErrors(const HardwareConfig& hardware) {
  JointVector errors(static_cast<int>(hardware.drives.size()));
  for (int joint = 0; joint < errors.size(); ++joint)
    errors[joint] = hardware.drives[joint].max_following_error;
  return errors;
}

}  // namespace

JointPlaces::JointPlaces(const JointVector& q_start, const HardwareConfig& hardware)
    : places_(q_start),
      q_released_(q_start),
      max_following_error_(maxFollowingErrors(hardware)),
      stop_way_(JointVector::Zero(q_start.size())),
      stop_deadline_s_(hardware.canopen.stop_deadline_s),
      tolerance_(hardware.start_tolerance) {}

void JointPlaces::command(const JointVector& q, const JointVector& velocity) noexcept {
  places_.command(q);
  stop_way_ = stop_deadline_s_ * velocity.cwiseAbs() + max_following_error_;
  is_held_.fill(true);
}

void JointPlaces::observe(int joint, double q_measured, bool is_holding, bool is_let_go) noexcept {
  is_held_[joint] = is_held_[joint] && !is_let_go;
  const double way = distanceFrom(places_.at(joint), q_measured);
  if (is_held_[joint] && is_holding && way <= stop_way_[joint]) q_released_[joint] = q_measured;
}

void JointPlaces::doubt(int joint) noexcept {
  is_held_[joint] = false;
  q_released_[joint] = commanded()[joint];
}

int JointPlaces::outOfPlace(const JointVector& q_measured) const noexcept {
  const JointVector from_command = (q_measured - commanded()).cwiseAbs();
  const JointVector from_release = (q_measured - q_released_).cwiseAbs();
  const JointVector distance = from_command.cwiseMin(from_release);
  if ((distance.array() <= tolerance_).all()) return -1;
  Eigen::Index joint = 0;
  distance.maxCoeff(&joint);
  return static_cast<int>(joint);
}

}  // namespace tactus
