#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <optional>

#include "tactus/canopen/drive.h"

/// What must hold whatever a bus brings, for tests with random and with searched frames.
namespace tactus::test {

/// A drive under frames that anybody may have sent. Judges, from those frames alone, what the
/// drive's owner may send to it.
class HostileDriveBus {
 public:
  HostileDriveBus(const DriveConfig& config, const CanopenConfig& canopen, double period_s)
      : config_(config), drive_(config, canopen, period_s) {}

  void receive(const CanFrame& frame) noexcept {
    drive_.receive(frame);
    const bool is_feedback = frame.kind == FrameKind::kData && !frame.extended && frame.size == 6 &&
                             frame.id == 0x180u + static_cast<unsigned>(config_.node_id);
    if (is_feedback) is_enabled_next_ = (frame.data[0] & 0x6F) == 0x27;
  }

  /// What is wrong with what was sent in this cycle; nullptr if nothing.
  const char* update(DriveGoal goal, bool restart, double velocity, double position) noexcept {
    if (is_enabled_next_) is_enabled_ = *is_enabled_next_;
    is_enabled_next_.reset();
    const Fault fault_before = drive_.report().fault;
    sent_.clear();
    drive_.observe({position, position});
    drive_.update(goal, restart, velocity, position, sent_);
    const bool is_restart = goal == DriveGoal::kConfigure && restart;
    if (!is_restart && fault_before != Fault::kNone && drive_.report().fault != fault_before)
      return "a fault went, or changed, without a restart";
    if (!std::isfinite(drive_.report().position)) return "a position that is no number";
    if (goal == DriveGoal::kSilent && !sent_.empty()) return "not silent";
    if (sent_.size() > 2) return "more frames than two in a cycle";
    for (const CanFrame& frame : sent_)
      if (const char* problem = judge(frame, goal, velocity)) return problem;
    return nullptr;
  }

  const Drive& drive() const { return drive_; }
  const FrameBatch& sent() const { return sent_; }
  int setpoints() const { return setpoints_; }  ///< other than zero that were sent

 private:
  const char* judge(const CanFrame& frame, DriveGoal goal, double velocity) noexcept {
    const auto node = static_cast<unsigned>(config_.node_id);
    if (frame.kind != FrameKind::kData || frame.extended || frame.size > 8) return "no data frame";
    if (frame.id == 0x000 && frame.size == 2) return nullptr;
    if (frame.id == 0x600u + node && frame.size == 8) return nullptr;
    if (frame.id != 0x200u + node || frame.size != 6) return "a frame of a kind it must not send";
    if (!drive_.report().is_configured) return "a setpoint to a drive that is not configured";
    std::int32_t counts = 0;
    std::memcpy(&counts, &frame.data[2], 4);  // tests run on little-endian machines
    if (counts == 0) return nullptr;
    ++setpoints_;
    if (goal != DriveGoal::kEnabled) return "a velocity without the goal";
    if (!is_enabled_) return "a velocity while not enabled";
    if (drive_.report().fault != Fault::kNone) return "a velocity in spite of a fault";
    if (frame.data[0] != 0x0F) return "a velocity without enabling operation";
    const double pull = config_.tracking_gain_per_s * config_.max_following_error;
    const double asked = velocity * config_.sign;
    const double low = (asked - pull) * config_.counts_per_unit - 1.0;
    const double high = (asked + pull) * config_.counts_per_unit + 1.0;
    if (std::abs(counts) > config_.max_velocity * config_.counts_per_unit + 1.0)
      return "a velocity beyond the joint's";
    if (config_.max_velocity < std::abs(velocity)) return nullptr;  // clamped: judged above
    if (counts < std::fmin(low, 2147483647.0) || counts > std::fmax(high, -2147483647.0))
      return "another velocity than was asked for";
    return nullptr;
  }

  DriveConfig config_;
  Drive drive_;
  FrameBatch sent_;
  bool is_enabled_ = false;              ///< by its last status word
  std::optional<bool> is_enabled_next_;  ///< that has come since the last cycle
  int setpoints_ = 0;
};

}  // namespace tactus::test
