#pragma once

#include <optional>
#include <vector>

#include "tactus/commission/commission_config.h"
#include "tactus/commission/node_scan.h"

namespace tactus {

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

  bool isKnown(int joint) const noexcept { return drive_of_[joint].has_value(); }
  /// Which drive to try for a joint: the one that is known to move it; the file's; the one that the
  /// file gives to a joint whose own drive turned out to be another, as they may be swapped; one
  /// that the file does not name; any. None that moves another joint, or that was dismissed.
  const FoundNode* candidate(int joint) const noexcept;

 private:
  std::size_t indexOf(const FoundNode& node) const noexcept {
    return static_cast<std::size_t>(&node - nodes_.data());
  }
  int rank(int joint, const FoundNode& node) const noexcept;
  const DriveConfig* inFile(const FoundNode& node) const noexcept;

  const CommissionConfig* config_;
  std::vector<FoundNode> nodes_;
  std::vector<bool> tried_;                           ///< one a node
  std::vector<std::optional<std::size_t>> drive_of_;  ///< one a joint
};

}  // namespace tactus
