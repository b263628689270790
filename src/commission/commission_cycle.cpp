#include "tactus/commission/commission_cycle.h"

#include <algorithm>
#include <cmath>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/cia402.h"
#include "tactus/canopen/cycle_count.h"

namespace tactus {
namespace {

/// And one more, until whose answer second ones to these have come.
enum ReadEntry : std::size_t { kStatusWordNow, kPositionNow };

/// A drive that starts anew after it was released needs as long as one that boots.
int readingTries(const CanopenConfig& canopen) {
  return std::max(2, static_cast<int>(std::ceil(canopen.boot_timeout_s / canopen.sdo_timeout_s)));
}

bool hasPower(std::uint16_t status_word) {
  const auto state = decodeStatusWord(status_word);
  return !state || (*state != DriveState::kNotReady && *state != DriveState::kSwitchOnDisabled &&
                    *state != DriveState::kReadyToSwitchOn && *state != DriveState::kFault);
}

}  // namespace

CommissionCycle::CommissionCycle(const CommissionConfig& config)
    : config_(config),
      scan_(config.hardware, config.period_s),
      outboxes_(config.hardware.buses.size()),
      heartbeat_(heartbeatFrame(config.hardware.canopen.master_node_id, NmtState::kOperational)) {}

void CommissionCycle::receive(int bus, std::span<const CanFrame> frames) noexcept {
  if (phase_ == Phase::kScanning) return scan_.receive(bus, frames);
  if (phase_ == Phase::kMoving) return stroke_->receive(bus, frames);
  if (phase_ != Phase::kReading) return;
  for (const CanFrame& frame : frames) readers_[bus].receive(frame);
}

void CommissionCycle::update(const CommissionInput& input) {
  for (FrameBatch& outbox : outboxes_) outbox.clear();
  is_line_high_ = !is_line_high_;
  is_enabled_ = input.lines.enable;
  if (input.stop_requested) stop();
  switch (phase_) {
    case Phase::kScanning:
      scan_.update(outboxes_);
      if (!scan_.isDone()) return;
      uses_.emplace(config_, scan_.nodes());
      phase_ = Phase::kIdle;
      return;
    case Phase::kReading:
      for (std::size_t bus = 0; bus < readers_.size(); ++bus) readers_[bus].update(outboxes_[bus]);
      if (std::ranges::all_of(readers_, [](const BusReader& r) { return r.isDone(); }))
        finishReading();
      return;
    case Phase::kMoving:
      stroke_->update(input);
      for (std::size_t bus = 0; bus < outboxes_.size(); ++bus)
        outboxes_[bus] = stroke_->outbox(static_cast<int>(bus));
      if (stroke_->isFinished()) finishStroke();
      return;
    case Phase::kIdle:
    case Phase::kAsking:
      return;
  }
}

/// A motion stops by itself, as it hears of it, too.
void CommissionCycle::stop() {
  if (phase_ != Phase::kAsking && phase_ != Phase::kReading) return;
  joint_->fail({.kind = JointTroubleKind::kStopped});
  goOn();
}

GpioOutputs CommissionCycle::lines() const noexcept {
  return {stroke_ && stroke_->isBrakeOpen(), is_line_high_};
}

void CommissionCycle::begin(int joint) {
  rest_counts_.reset();
  joint_.emplace(config_, joint, *uses_);
  goOn();
}

const Question* CommissionCycle::question() const noexcept {
  return phase_ == Phase::kAsking ? joint_->question() : nullptr;
}

bool CommissionCycle::answer(const Answer& answer) {
  if (phase_ != Phase::kAsking || !joint_->isAnswer(answer)) return false;
  answer_ = answer;
  startReading();
  return true;
}

void CommissionCycle::startReading() {
  const CanopenConfig& canopen = config_.hardware.canopen;
  const int timeout = cyclesLasting(canopen.sdo_timeout_s, config_.period_s);
  readers_.clear();
  for (std::size_t bus = 0; bus < outboxes_.size(); ++bus) {
    std::vector<int> ids;
    for (const FoundNode& node : nodes())
      if (node.isDrive() && node.bus == static_cast<int>(bus)) ids.push_back(node.node_id);
    readers_.emplace_back(
        ids, std::vector<ObjectEntry>{{0x6041, 0, 2}, {0x6064, 0, 4}, {0x1000, 0, 4}}, timeout,
        readingTries(canopen),
        readingPace(config_.hardware.buses[bus].bit_rate_per_s, config_.period_s));
  }
  phase_ = Phase::kReading;
}

void CommissionCycle::finishReading() {
  JointTrouble trouble;
  double counts = 0.0;
  const FoundNode node = joint_->node();
  if (judgeReading(trouble, counts)) {
    joint_->take(answer_, counts);
    rest_counts_ = counts;
    const bool goes_on = !joint_->isFinished();
    const bool is_same =
        goes_on && joint_->node().bus == node.bus && joint_->node().node_id == node.node_id;
    if (!is_same) rest_counts_.reset();
  } else {
    joint_->fail(trouble);
  }
  goOn();
}

/// False: nothing may move.
bool CommissionCycle::judgeReading(JointTrouble& trouble, double& counts) const {
  const FoundNode& own = joint_->node();
  for (std::size_t bus = 0; bus < readers_.size(); ++bus) {
    for (const ObjectReader& node : readers_[bus].nodes()) {
      const bool is_own = own.bus == static_cast<int>(bus) && own.node_id == node.nodeId();
      const auto word = node.value(kStatusWordNow), position = node.value(kPositionNow);
      trouble.bus = static_cast<int>(bus);
      trouble.node_id = node.nodeId();
      const FoundNode* const found = uses_->find(static_cast<int>(bus), node.nodeId());
      trouble.kind = JointTroubleKind::kTwoDevices;
      if (found->has_twin || node.isAnsweredTwice()) return false;
      if (!word || (is_own && !position)) {
        trouble.kind = is_own ? JointTroubleKind::kNodeSilent : JointTroubleKind::kOtherSilent;
        return false;
      }
      trouble.value = *word;
      trouble.kind = JointTroubleKind::kOtherHasPower;
      if (hasPower(static_cast<std::uint16_t>(*word))) return false;
      if (is_own) counts = static_cast<std::int32_t>(*position);
    }
  }
  trouble.bus = own.bus;
  trouble.node_id = own.node_id;
  trouble.kind = JointTroubleKind::kMovedBetween;
  trouble.value = rest_counts_ ? std::abs(counts - *rest_counts_) : 0.0;
  trouble.limit = rest_tolerance_counts_;
  return trouble.value <= trouble.limit;
}

void CommissionCycle::finishStroke() {
  const StrokeReport report = stroke_->report();
  joint_->onStroke(report);
  rest_counts_ = report.end_counts;
  stroke_.reset();
  goOn();
}

void CommissionCycle::goOn() {
  if (joint_->isFinished()) {
    phase_ = Phase::kIdle;
  } else if (joint_->question()) {
    phase_ = Phase::kAsking;
  } else {
    StrokePlan plan = joint_->stroke();
    plan.rest_counts = *rest_counts_;  // a motion begins only after a reading
    // What a brake lets a joint turn, and a joint without one sink, until it is noticed.
    rest_tolerance_counts_ = plan.bounds.max_following_error * plan.bounds.counts_per_unit;
    stroke_.emplace(config_.hardware, plan, config_.period_s);
    phase_ = Phase::kMoving;
  }
}

}  // namespace tactus
