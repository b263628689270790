#include "tactus/plant/slave_drive.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactus/plant/sdo_server.h"
#include "tactus/plant/slave_pdo.h"

namespace tactus {
namespace {

// Error codes of CiA 301 and 402.
constexpr std::uint16_t kOverCurrent = 0x2310;
constexpr std::uint16_t kCommunication = 0x8100;
constexpr std::uint16_t kHeartbeatLost = 0x8130;
constexpr std::uint16_t kPdoTooShort = 0x8210;
constexpr std::uint16_t kSyncLength = 0x8240;
constexpr std::uint16_t kRpdoLost = 0x8250;
constexpr std::uint16_t kSyncLost = 0x8700;

constexpr std::uint32_t kNoStatus = 0xFFFF'FFFF;
constexpr std::int64_t kMillisecond_ns = 1'000'000;

}  // namespace

SlaveDrive::SlaveDrive(const DriveConfig& config, double period_s)
    : config_(config),
      max_setpoint_age_ns_(std::llround(2e9 * period_s)),
      objects_(config.node_id, config),
      axis_(config) {}

void SlaveDrive::setPowered(bool is_on, std::int64_t t_ns) noexcept {
  axis_.setPowered(false, objects_);
  if (is_on) {
    restart(0xFFFF, t_ns);
    return;
  }
  nmt_ = NodeState::kOff;
  outbox_.clear();
  has_latched_rpdo_ = false;
  boot_end_ns_ = next_heartbeat_ns_ = master_deadline_ns_ = kNever_ns;
}

void SlaveDrive::setTroubles(const DriveTroubles& troubles) noexcept {
  const DriveTroubles before = std::exchange(troubles_, troubles);
  if (troubles.freezes_feedback && !before.freezes_feedback) {
    frozen_status_ = objects_.get(0x6041);
    frozen_position_ = objects_.get(0x6064);
  }
  if (troubles.claims_boot_up && !before.claims_boot_up && isConnected()) sendNmtState(0);
  if (troubles.is_failing) fail(kOverCurrent);
  sendTpdoOnChange();
}

void SlaveDrive::receive(const QueuedFrame& item, std::int64_t t_ns) noexcept {
  const CanFrame& frame = item.frame;
  if (frame.kind != FrameKind::kData || frame.extended || frame.is_fd) return;
  if (nmt_ == NodeState::kOff || nmt_ == NodeState::kInitialising) return;
  const std::uint32_t master = (objects_.get(0x1016, 1) >> 16) & 0x7F;
  if (frame.id == 0) onNmt(frame, t_ns);
  if (frame.id == objects_.get(0x1005)) onSync(frame, t_ns);
  if (frame.id == idFrom(0x600)) onSdo(frame, t_ns);
  if (frame.id == pdoId(objects_, kReceivePdo)) onRpdo(item, t_ns);
  if (frame.id == 0x700 + master && frame.size == 1 && masterTimeout_ns() > 0)
    master_deadline_ns_ = t_ns + masterTimeout_ns();
  sendTpdoOnChange();
}

void SlaveDrive::update(std::int64_t t_ns) noexcept {
  if (t_ns >= boot_end_ns_) finishBoot();
  if (t_ns >= next_heartbeat_ns_) {
    sendNmtState(static_cast<std::uint8_t>(nmt_));
    next_heartbeat_ns_ = t_ns + heartbeatPeriod_ns();
  }
  if (t_ns >= master_deadline_ns_) {
    master_deadline_ns_ = kNever_ns;
    abortConnection(kHeartbeatLost);
    if (nmt_ == NodeState::kOperational) enter(NodeState::kPreOperational);  // default of 1029
  }
  if (t_ns >= syncDeadline_ns()) fail(kSyncLost);
  if (t_ns >= rpdoDeadline_ns()) fail(kRpdoLost);
  sendTpdoOnChange();
}

std::int64_t SlaveDrive::nextEvent_ns() const noexcept {
  return std::min({boot_end_ns_, next_heartbeat_ns_, master_deadline_ns_, syncDeadline_ns(),
                   rpdoDeadline_ns()});
}

void SlaveDrive::move(double dt_s) noexcept {
  axis_.move(dt_s, objects_);
  sendTpdoOnChange();
}

bool SlaveDrive::isConnected() const noexcept {
  return nmt_ == NodeState::kPreOperational || nmt_ == NodeState::kOperational;
}

std::uint32_t SlaveDrive::idFrom(std::uint32_t function) const noexcept {
  return function + static_cast<std::uint32_t>(config_.node_id);
}

void SlaveDrive::onNmt(const CanFrame& frame, std::int64_t t_ns) noexcept {
  if (frame.size != 2 || (frame.data[1] != 0 && frame.data[1] != config_.node_id)) return;
  switch (frame.data[0]) {
    case 1:
      return enter(NodeState::kOperational);
    case 2:
      return enter(NodeState::kStopped);
    case 128:
      return enter(NodeState::kPreOperational);
    case 129:  // the whole node
      axis_.setPowered(false, objects_);
      return restart(0xFFFF, t_ns);
    case 130:  // communication only
      return restart(0x1FFF, t_ns);
    default:
      return;
  }
}

void SlaveDrive::enter(NodeState state) noexcept {
  if (nmt_ == NodeState::kOperational && state != nmt_) {
    has_latched_rpdo_ = false;
    if (axis_.state() == PowerState::kOperationEnabled) abortConnection(kCommunication);
  }
  if (nmt_ != NodeState::kOperational) sent_status_ = kNoStatus;
  nmt_ = state;
  objects_.lockCommunication(state == NodeState::kOperational);
}

/// Object 6007: nothing, or else; all of it is a fault here.
void SlaveDrive::abortConnection(std::uint16_t error_code) noexcept {
  if (objects_.get(0x6007) != 0) return fail(error_code);
  sendEmergency(error_code);
}

void SlaveDrive::restart(std::uint16_t last_index, std::int64_t t_ns) noexcept {
  enter(NodeState::kInitialising);
  const std::uint32_t position = objects_.get(0x6064);  // the encoder is absolute
  objects_.reset(0, last_index);
  objects_.set(0x6064, 0, position);
  master_deadline_ns_ = next_heartbeat_ns_ = kNever_ns;
  boot_end_ns_ = t_ns + kBootTime_ns;
}

void SlaveDrive::finishBoot() noexcept {
  boot_end_ns_ = kNever_ns;
  sendNmtState(0);
  enter(NodeState::kPreOperational);
  if (axis_.state() == PowerState::kNotReadyToSwitchOn) axis_.setPowered(true, objects_);
  if (troubles_.is_failing) fail(kOverCurrent);
}

void SlaveDrive::onSdo(const CanFrame& frame, std::int64_t t_ns) noexcept {
  if (!isConnected()) return;
  const std::int64_t old_period_ns = heartbeatPeriod_ns();
  const std::uint32_t old_consumer = objects_.get(0x1016, 1);
  CanFrame response;
  response.id = idFrom(0x580);
  response.size = 8;
  if (!answerSdo(frame, objects_, response)) return;
  outbox_.push(response);
  if (objects_.get(0x1016, 1) != old_consumer) master_deadline_ns_ = kNever_ns;
  if (heartbeatPeriod_ns() != old_period_ns)
    next_heartbeat_ns_ = heartbeatPeriod_ns() == 0 ? kNever_ns : t_ns + heartbeatPeriod_ns();
  obey(t_ns);
}

void SlaveDrive::onRpdo(const QueuedFrame& item, std::int64_t t_ns) noexcept {
  if (nmt_ != NodeState::kOperational) return;
  if (item.frame.size < pdoBytes(objects_, kReceivePdo)) {
    sendEmergency(kPdoTooShort);
    return;
  }
  last_rpdo_ns_ = t_ns;
  const bool is_synchronous = objects_.get(0x1400, 2) <= 240;
  if (!is_synchronous) {
    applyRpdo(item, t_ns);
    return;
  }
  latched_rpdo_ = item;
  has_latched_rpdo_ = true;
}

/// Without object 1019 it has no data (CiA 301, 7.2.5.3).
void SlaveDrive::onSync(const CanFrame& frame, std::int64_t t_ns) noexcept {
  if (frame.size != 0) return sendEmergency(kSyncLength);
  last_sync_ns_ = t_ns;
  if (nmt_ != NodeState::kOperational) return;
  sendTpdoAtSync();  // what was sampled at the SYNC, before the setpoint takes effect
  if (has_latched_rpdo_) applyRpdo(latched_rpdo_, t_ns);
  has_latched_rpdo_ = false;
}

void SlaveDrive::applyRpdo(const QueuedFrame& item, std::int64_t t_ns) noexcept {
  if (troubles_.ignores_commands) return;
  unpackRpdo(item.frame, objects_);
  obey(t_ns);
  const bool is_stale = t_ns - item.sent_ns > max_setpoint_age_ns_;
  if (is_stale && axis_.state() == PowerState::kOperationEnabled) ++stale_setpoints_;
}

void SlaveDrive::obey(std::int64_t t_ns) noexcept {
  if (troubles_.ignores_commands) return;
  const PowerState before = axis_.state();
  const bool was_reset = axis_.obey(objects_, !troubles_.is_failing);
  if (was_reset) {
    objects_.set(0x603F, 0, 0);
    objects_.set(0x1001, 0, 0);
    sendEmergency(0);
  }
  if (axis_.state() != PowerState::kOperationEnabled || before == axis_.state()) return;
  last_sync_ns_ = std::max(last_sync_ns_, t_ns);
  last_rpdo_ns_ = std::max(last_rpdo_ns_, t_ns);
}

void SlaveDrive::fail(std::uint16_t error_code) noexcept {
  if (!axis_.fail(objects_)) return;
  const bool is_communication = error_code >> 12 == 8;
  objects_.set(0x603F, 0, error_code);
  objects_.set(0x1001, 0, is_communication ? 0x11 : 0x01);
  sendEmergency(error_code);
}

std::int64_t SlaveDrive::masterTimeout_ns() const noexcept {
  const std::uint32_t consumer = objects_.get(0x1016, 1);
  const bool names_node = ((consumer >> 16) & 0x7F) != 0;
  return names_node ? (consumer & 0xFFFF) * kMillisecond_ns : 0;
}

std::int64_t SlaveDrive::heartbeatPeriod_ns() const noexcept {
  return objects_.get(0x1017) * kMillisecond_ns;
}

bool SlaveDrive::watchesMotion() const noexcept {
  return axis_.state() == PowerState::kOperationEnabled && !troubles_.watches_heartbeat_only;
}

std::int64_t SlaveDrive::syncDeadline_ns() const noexcept {
  if (!watchesMotion()) return kNever_ns;
  double sync_period_ns = 1e9 * objects_.get(0x60C2, 1);
  for (int power = objects_.getSigned(0x60C2, 2); power < 0; ++power) sync_period_ns /= 10.0;
  return last_sync_ns_ + std::llround(kMaxMissingSyncs * sync_period_ns);
}

std::int64_t SlaveDrive::rpdoDeadline_ns() const noexcept {
  const std::uint32_t timer_ms = objects_.get(0x1400, 5);
  if (!watchesMotion() || timer_ms == 0) return kNever_ns;
  return last_rpdo_ns_ + timer_ms * kMillisecond_ns;
}

}  // namespace tactus
