#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tactus/commission/joint_scale.h"
#include "tactus/commission/stroke.h"

namespace tactus {

/// Where counts per unit come from.
enum class ScaleSource : std::uint8_t {
  kMeasured,  ///< from the marks alone
  kDrive,     ///< the drive's own objects, which the marks confirm
  kFile,      ///< robot.yaml, which the marks confirm
};

/// Which drive moves a joint.
struct JointPlace {
  int joint = 0, bus = 0, node_id = 0;
};

/// All that is known of a joint that was commissioned.
struct JointFindings {
  int joint = 0, bus = 0, node_id = 0;
  JointScale scale;
  ScaleSource source = ScaleSource::kMeasured;
  std::optional<double> drive_counts_per_unit;  ///< by 608F and 6091; of revolute joints
  double misfit = 0.0;                          ///< of the marks, m or rad
  std::optional<double> lower, upper;           ///< the margin is taken off; absent: not reached
  double following_error = 0.0;                 ///< the largest, m or rad
  double lag_s = 0.0;
  double acceleration = 0.0;       ///< the largest measured, m/s^2 or rad/s^2
  std::vector<JointPlace> places;  ///< of all joints of which it is known by then
};

/// Why a joint could not be finished.
enum class JointTroubleKind : std::uint8_t {
  kNone,
  kStopped,        ///< by the engineer
  kNoNode,         ///< no drive is left that could be this joint's
  kNodeSilent,     ///< its drive no longer answers
  kTwoDevices,     ///< two answer to one node id: they would move together
  kOtherHasPower,  ///< another drive has power
  kOtherSilent,    ///< another drive no longer answers, so that nobody knows that it is off
  kStroke,         ///< a motion ended otherwise than it should: see the stroke's report
  kMovedBetween,   ///< it moved, or its counts jumped, while it had no power
  kMovedShort,     ///< it did not go as far as it was told, though its drive said nothing
  kFewerCounts,    ///< by the measured places it has fewer than all motions rely on
  kStillOpen,      ///< after many motions the measured places still do not tell
  kSignsDisagree,  ///< what was seen and what was measured go opposite ways
  kCannotTell,     ///< the measured places contradict each other
};

struct JointTrouble {
  JointTroubleKind kind = JointTroubleKind::kNone;
  StrokeReport stroke{};     ///< of the last motion
  int bus = 0, node_id = 0;  ///< of whom it speaks
  /// Counts; a unit for kFewerCounts; m or rad for kCannotTell; motions for kStillOpen.
  double value = 0.0, limit = 0.0;
};

}  // namespace tactus
