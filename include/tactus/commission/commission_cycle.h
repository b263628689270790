#pragma once

#include <optional>
#include <span>
#include <vector>

#include "tactus/commission/commission_config.h"
#include "tactus/commission/joint_commission.h"
#include "tactus/commission/node_scan.h"
#include "tactus/commission/node_uses.h"
#include "tactus/commission/object_reader.h"
#include "tactus/commission/stroke.h"

namespace tactus {

/// Commissioning between frames in and frames out: scans the buses, then takes one joint at a time,
/// in whatever order it is told to. Between motions nothing is sent that a drive could move by: no
/// SYNC, no heartbeat, and each drive was released without power. Before each motion all drives of
/// all buses are asked whether they have power; if one has, nothing moves. Knows no socket, line,
/// terminal or clock.
class CommissionCycle {
 public:
  enum class Phase : std::uint8_t {
    kScanning,
    kIdle,     ///< begin() may be called
    kAsking,   ///< question() waits for answer()
    kReading,  ///< drives are asked where they are, and whether they are off
    kMoving,
  };

  explicit CommissionCycle(const CommissionConfig& config);
  CommissionCycle(const CommissionCycle&) = delete;
  CommissionCycle& operator=(const CommissionCycle&) = delete;

  void receive(int bus, std::span<const CanFrame> frames) noexcept;
  void update(const CommissionInput& input);  ///< once a cycle, after all frames
  const FrameBatch& outbox(int bus) const noexcept { return outboxes_[bus]; }
  void noteHeldBack(int bus) noexcept {
    if (stroke_) stroke_->noteHeldBack(bus);
  }
  const CanFrame& probe() const noexcept { return heartbeat_; }
  GpioOutputs lines() const noexcept;

  Phase phase() const noexcept { return phase_; }
  const std::vector<FoundNode>& nodes() const noexcept { return uses_->nodes(); }  ///< once scanned
  /// In kIdle: that this drive moves that joint, from an earlier run.
  void learn(int joint, int bus, int node_id) { uses_->learn(joint, bus, node_id); }
  void begin(int joint);  ///< in kIdle

  const Question* question() const noexcept;  ///< null but in kAsking
  bool answer(const Answer& answer);          ///< false: none of those that were asked for
  /// In kMoving: drives wait for the enable line.
  bool isWaitingForEnable() const noexcept {
    return stroke_ && stroke_->mode() == Mode::kReady && !is_enabled_;
  }

  /// In kIdle, of the joint begun last; null before the first.
  const JointCommission* joint() const noexcept { return joint_ ? &*joint_ : nullptr; }

 private:
  void startReading();
  void finishReading();
  bool judgeReading(JointTrouble& trouble, double& counts) const;
  void finishStroke();
  void goOn();
  void stop();

  CommissionConfig config_;
  NodeScan scan_;
  std::optional<NodeUses> uses_;
  std::vector<FrameBatch> outboxes_;  ///< one a bus
  CanFrame heartbeat_;
  bool is_line_high_ = false;  ///< of the heartbeat line
  bool is_enabled_ = true;     ///< by the enable line
  Phase phase_ = Phase::kScanning;
  std::optional<JointCommission> joint_;
  std::optional<Stroke> stroke_;
  std::vector<BusReader> readers_;  ///< one a bus
  Answer answer_;
  std::optional<double> rest_counts_;  ///< where the joint was left
  double rest_tolerance_counts_ = 0.0;
};

}  // namespace tactus
