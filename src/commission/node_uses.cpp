#include "tactus/commission/node_uses.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace tactus {
namespace {

constexpr int kNever = std::numeric_limits<int>::max();

}  // namespace

NodeUses::NodeUses(const CommissionConfig& config, std::vector<FoundNode> nodes)
    : config_(&config),
      nodes_(std::move(nodes)),
      tried_(nodes_.size(), false),
      last_bounds_(nodes_.size()),
      drive_of_(static_cast<std::size_t>(config.joints())) {}

const FoundNode* NodeUses::find(int bus, int node_id) const noexcept {
  const auto found = std::ranges::find_if(
      nodes_, [&](const FoundNode& node) { return node.bus == bus && node.node_id == node_id; });
  return found == nodes_.end() ? nullptr : &*found;
}

void NodeUses::learn(int joint, int bus, int node_id) {
  const FoundNode* const node = find(bus, node_id);
  if (!node) return;
  for (auto& drive : drive_of_)
    if (drive == indexOf(*node)) drive.reset();
  drive_of_[joint] = indexOf(*node);
}

std::vector<JointPlace> NodeUses::known() const {
  std::vector<JointPlace> places;
  for (std::size_t joint = 0; joint < drive_of_.size(); ++joint) {
    if (!drive_of_[joint]) continue;
    const FoundNode& node = nodes_[*drive_of_[joint]];
    places.push_back({static_cast<int>(joint), node.bus, node.node_id});
  }
  return places;
}

const FoundNode* NodeUses::candidate(int joint) const noexcept {
  const FoundNode* best = nullptr;
  int best_rank = kNever;
  for (const FoundNode& node : nodes_) {
    const int r = rank(joint, node);
    if (r >= best_rank) continue;
    best = &node;
    best_rank = r;
  }
  return best;
}

int NodeUses::rank(int joint, const FoundNode& node) const noexcept {
  const std::size_t index = indexOf(node);
  if (!node.isDrive() || tried_[index]) return kNever;
  if (drive_of_[joint]) return drive_of_[joint] == index ? 0 : kNever;
  for (const auto& drive : drive_of_)
    if (drive == index) return kNever;
  const DriveConfig* const entry = inFile(node);
  if (!entry) return 3;
  if (entry->joint == joint) return 1;
  const auto& others = drive_of_[entry->joint];
  return others ? 2 : 4;
}

DriveConfig NodeUses::entryFor(int joint, const FoundNode& node) const noexcept {
  const auto& drives = config_->hardware.drives;
  const auto own = std::ranges::find(drives, joint, &DriveConfig::joint);
  DriveConfig entry = own == drives.end() ? DriveConfig{} : *own;
  if (const DriveConfig* const there = inFile(node)) {
    entry.has_velocity_unit = entry.has_velocity_unit || there->has_velocity_unit;
    entry.has_quick_stop_option = entry.has_quick_stop_option && there->has_quick_stop_option;
    entry.has_speed_limit = entry.has_speed_limit && there->has_speed_limit;
  }
  return entry;
}

const DriveConfig* NodeUses::inFile(const FoundNode& node) const noexcept {
  const auto& drives = config_->hardware.drives;
  const auto found = std::ranges::find_if(drives, [&](const DriveConfig& drive) {
    return drive.bus == node.bus && drive.node_id == node.node_id;
  });
  return found == drives.end() ? nullptr : &*found;
}

}  // namespace tactus
