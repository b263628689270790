#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tactus/commission/joint_commission.h"

/// What is known of a joint: how many counts it has at least, which bounds the next motion, and
/// what all marks tell in the end.
namespace tactus {
namespace {

/// A shorter motion is lost in the noise of an encoder. Objects by which the first one would be as
/// short were never set.
constexpr double kLeastMotion_counts = 10.0;

}  // namespace

JointCommission::ToldCounts JointCommission::toldCounts(int joint) const noexcept {
  double file = std::numeric_limits<double>::infinity();
  for (const DriveConfig& drive : config_->hardware.drives)
    if (drive.joint == joint) file = drive.counts_per_unit;
  const bool turns = !config_->is_prismatic[joint];
  if (!turns || !node_->counts_per_turn) return {file, file};
  const double drive = *node_->counts_per_turn / (2.0 * std::numbers::pi);
  const double travel = config_->bounds(joint).max_travel;
  if (drive / config_->file_factor * travel < kLeastMotion_counts) return {file, file};
  return {std::min(file, drive), std::max(file, drive)};
}

/// A unit of this joint has at least so many, if this drive moves it; before anything was measured.
double JointCommission::assumedCounts(int joint) const noexcept {
  const double assumed = toldCounts(joint).fewest / config_->file_factor;
  return std::max(assumed, unseen_counts_ / config_->bounds(joint).unseen);
}

double JointCommission::fewestCounts(int joint) const noexcept {
  return std::max(assumedCounts(joint), joint == joint_ ? fewest_ : 0.0);
}

/// In this joint's unit, but kept for each joint that this drive may turn out to move, and against
/// the last motion of the drive.
StrokeBounds JointCommission::bounds() const noexcept {
  const MotionBounds& mine = allowed();
  CountBounds most = uses_->lastBounds(*node_);
  for (double* const value : {&most.travel, &most.speed, &most.acceleration, &most.error})
    *value *= kMostGrowth;
  for (int joint = 0; joint < config_->joints(); ++joint) {
    const bool is_possible = joint == joint_ || (!is_identified_ && !uses_->isKnown(joint));
    if (!is_possible) continue;
    const MotionBounds& bounds = config_->bounds(joint);
    const double counts = fewestCounts(joint);
    most.travel = std::min(most.travel, counts * bounds.max_travel);
    most.speed = std::min(most.speed, counts * bounds.max_speed);
    most.acceleration = std::min(most.acceleration, counts * bounds.max_acceleration);
    most.error = std::min(most.error, counts * bounds.max_following_error);
  }
  constexpr double kJerkTime_s = 0.1;  // to reach the acceleration
  const double unit = most.travel / mine.max_travel;
  const double a = most.acceleration / unit;
  return {unit, mine.max_travel, {most.speed / unit, a, a / kJerkTime_s}, most.error / unit};
}

void JointCommission::finish() {
  const auto measured = this->scale();
  if (!measured) return fail({.kind = JointTroubleKind::kStillOpen, .value = 1.0 * scale_strokes_});
  chooseScale(*measured);
  const JointScale& scale = findings_.scale;
  if (scale.sign != seen_sign_) return fail({.kind = JointTroubleKind::kSignsDisagree});
  const double most = kMostMisfit_errors * allowed().measuring_error;
  findings_.misfit = largestMisfit(marks_, scale);
  if (findings_.misfit > most)
    return fail({.kind = JointTroubleKind::kCannotTell, .value = findings_.misfit, .limit = most});
  findings_.bus = node_->bus;
  findings_.node_id = node_->node_id;
  findings_.places = uses_->known();
  const double margin = allowed().margin;
  if (upper_counts_) findings_.upper = scale.position(*upper_counts_) - margin;
  if (lower_counts_) findings_.lower = scale.position(*lower_counts_) + margin;
  findings_.following_error = error_counts_ / scale.counts_per_unit;
  findings_.acceleration = acceleration_counts_ / scale.counts_per_unit;
  question_.reset();
  step_ = Step::kFinished;
}

/// A number that somebody computed from gears and encoder is better than one that was measured by
/// hand, if the measured one confirms it.
void JointCommission::chooseScale(const JointScale& measured) {
  findings_.scale = measured;
  findings_.source = ScaleSource::kMeasured;
  const auto confirm = [&](double counts_per_unit, ScaleSource source) {
    const double share = std::abs(counts_per_unit / measured.counts_per_unit - 1.0);
    const bool is_free = findings_.source == ScaleSource::kMeasured;
    if (!is_free || share > measured.uncertainty) return;
    findings_.scale = fitOffset(marks_, measured.sign, counts_per_unit);
    findings_.scale.uncertainty = measured.uncertainty;
    findings_.source = source;
  };
  if (!config_->is_prismatic[joint_] && node_->counts_per_turn) {
    findings_.drive_counts_per_unit = *node_->counts_per_turn / (2.0 * std::numbers::pi);
    confirm(*findings_.drive_counts_per_unit, ScaleSource::kDrive);
  }
  for (const DriveConfig& drive : config_->hardware.drives)
    if (drive.joint == joint_) confirm(drive.counts_per_unit, ScaleSource::kFile);
}

}  // namespace tactus
