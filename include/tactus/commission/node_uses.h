#pragma once

#include <limits>
#include <optional>
#include <vector>

#include "tactus/commission/commission_config.h"
#include "tactus/commission/joint_findings.h"
#include "tactus/commission/node_scan.h"

namespace tactus {

/// Bounds of a motion in counts, of which no unit is known: whatever joint the drive moves.
struct CountBounds {
  double travel = kUnbounded, speed = kUnbounded, acceleration = kUnbounded, error = kUnbounded;

  static constexpr double kUnbounded = std::numeric_limits<double>::infinity();
};

/// Which drive moves which joint, as far as it is known.
class NodeUses {
 public:
  NodeUses(const CommissionConfig& config, std::vector<FoundNode> nodes);

  const std::vector<FoundNode>& nodes() const noexcept { return nodes_; }
  const FoundNode* find(int bus, int node_id) const noexcept;

  /// That this drive moves that joint. Whatever was known of either before is forgotten.
  void learn(int joint, int bus, int node_id);
  void forgetTrials() noexcept { tried_.assign(nodes_.size(), false); }
  /// That the drive moves nothing that anybody sees.
  void dismiss(const FoundNode& node) noexcept { tried_[indexOf(node)] = true; }

  /// Of the drive's last motion, whichever joint it was for; unbounded before the first.
  const CountBounds& lastBounds(const FoundNode& node) const noexcept {
    return last_bounds_[indexOf(node)];
  }
  void noteBounds(const FoundNode& node, const CountBounds& bounds) noexcept {
    last_bounds_[indexOf(node)] = bounds;
  }

  bool isKnown(int joint) const noexcept { return drive_of_[joint].has_value(); }
  std::vector<JointPlace> known() const;
  /// Which drive to try for a joint: the one that is known to move it; the file's; the one that the
  /// file gives to a joint whose own drive turned out to be another, as they may be swapped; one
  /// that the file does not name; any. None that moves another joint, or that was dismissed.
  const FoundNode* candidate(int joint) const noexcept;
  /// What the set-up of a drive that may move the joint has to know: the joint's entry, as for the
  /// daemon. Where the file has an entry of another joint for that place, the unit of velocities is
  /// looked at unless both do without, for a wrong one makes the joint fast; and 605A and 607F are
  /// written only if both have them.
  DriveConfig entryFor(int joint, const FoundNode& node) const noexcept;

 private:
  std::size_t indexOf(const FoundNode& node) const noexcept {
    return static_cast<std::size_t>(&node - nodes_.data());
  }
  int rank(int joint, const FoundNode& node) const noexcept;
  const DriveConfig* inFile(const FoundNode& node) const noexcept;

  const CommissionConfig* config_;
  std::vector<FoundNode> nodes_;
  std::vector<bool> tried_;                           ///< one a node
  std::vector<CountBounds> last_bounds_;              ///< one a node
  std::vector<std::optional<std::size_t>> drive_of_;  ///< one a joint
};

}  // namespace tactus
