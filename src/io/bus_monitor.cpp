#include "tactus/io/bus_monitor.h"

#include <errno.h>
#include <linux/can/error.h>

#include <algorithm>
#include <array>

namespace tactus {
namespace {

constexpr std::uint8_t kPassive = CAN_ERR_CRTL_RX_PASSIVE | CAN_ERR_CRTL_TX_PASSIVE;
constexpr std::uint8_t kNotPassive =
    CAN_ERR_CRTL_RX_WARNING | CAN_ERR_CRTL_TX_WARNING | CAN_ERR_CRTL_ACTIVE;

bool isDownError(int error_number) noexcept {
  constexpr std::array<int, 3> kDownErrors = {ENETDOWN, ENODEV, ENXIO};
  return std::find(kDownErrors.begin(), kDownErrors.end(), error_number) != kDownErrors.end();
}

int gravity(Fault fault) noexcept {
  constexpr std::array kMildestFirst = {Fault::kNone,       Fault::kBusFlooded,
                                        Fault::kBusStalled, Fault::kBusUnacknowledged,
                                        Fault::kBusOff,     Fault::kBusDown};
  return static_cast<int>(std::find(kMildestFirst.begin(), kMildestFirst.end(), fault) -
                          kMildestFirst.begin());
}

/// Drivers report a missing acknowledgement as a class of its own or as the place of a violation.
bool lacksAcknowledge(const CanFrame& error) noexcept {
  return (error.id & CAN_ERR_ACK) != 0 ||
         ((error.id & CAN_ERR_PROT) != 0 && error.data[3] == CAN_ERR_PROT_LOC_ACK);
}

}  // namespace

void BusMonitor::onErrorFrame(const CanFrame& frame) noexcept {
  ++counters_.error_frames;
  if ((frame.id & CAN_ERR_CRTL) != 0) {
    if ((frame.data[1] & kPassive) != 0)
      is_passive_ = true;
    else if ((frame.data[1] & kNotPassive) != 0)
      is_passive_ = false;
  }
  if (is_passive_) frames_to_active_ = kFramesToActive;  // any error raises its counter anew
  if (lacksAcknowledge(frame)) lacks_acknowledge_ = true;
  if (is_passive_ && lacks_acknowledge_) raise(Fault::kBusUnacknowledged);
  if ((frame.id & (CAN_ERR_BUSOFF | CAN_ERR_RESTARTED)) != 0) {
    raise(Fault::kBusOff);
    unconfirmed_ = 0;  // leaving the bus empties driver and queue
  }
}

void BusMonitor::onConfirmed(int frames) noexcept {
  if (frames <= 0) return;
  unconfirmed_ = std::max(0, unconfirmed_ - frames);
  was_confirmed_ = is_known_alive_ = true;
  has_answered_ = true;
  lacks_acknowledge_ = false;
  frames_to_active_ = std::max(0, frames_to_active_ - frames);
  if (frames_to_active_ == 0) is_passive_ = false;
}

void BusMonitor::onSent(int accepted, int offered) noexcept {
  counters_.sent += static_cast<std::uint64_t>(accepted);
  counters_.refused += static_cast<std::uint64_t>(offered - accepted);
  if (isDead()) noteProbe();
  unconfirmed_ += accepted;
  if (accepted < offered) was_refused_ = true;
}

void BusMonitor::onSendError(int error_number) noexcept { onReceiveError(error_number); }

/// Whatever else a send fails with shows in onSent(); a receive fails otherwise only with EAGAIN.
void BusMonitor::onReceiveError(int error_number) noexcept {
  if (!isDownError(error_number)) return;
  raise(Fault::kBusDown);
  unconfirmed_ = 0;  // going down empties driver and queue
}

void BusMonitor::onForeignFrame() noexcept {
  ++counters_.foreign;
  is_known_alive_ = true;
}

void BusMonitor::onReceived(int frames, bool batch_was_full) noexcept {
  counters_.received += static_cast<std::uint64_t>(frames);
  is_known_alive_ = is_known_alive_ || frames > 0;
  full_batches_ = batch_was_full ? full_batches_ + 1 : 0;
}

void BusMonitor::update() noexcept {
  if (cycles_to_probe_ > 0) --cycles_to_probe_;
  noteUnconfirmed();
  noteFlood();
  if (gravity(trouble_) > gravity(fault_)) {
    if (!isDead()) cycles_to_probe_ = probe_cycles_;
    fault_ = trouble_;
  }
  recover();
  trouble_ = Fault::kNone;
  was_refused_ = was_confirmed_ = false;
  if (!maySend()) ++counters_.held_back;
}

void BusMonitor::raise(Fault trouble) noexcept {
  if (gravity(trouble) > gravity(trouble_)) trouble_ = trouble;
}

/// A bus that has answered and fallen silent with frames open has lost them: their confirmations
/// are no longer waited for, but the probe's is.
void BusMonitor::noteProbe() noexcept {
  cycles_to_probe_ = probe_cycles_;
  if (!has_answered_ || calm_cycles_ < kCalmCycles) return;
  unconfirmed_ = calm_cycles_ = 0;
  has_answered_ = false;
}

void BusMonitor::noteUnconfirmed() noexcept {
  const bool is_stuck = unconfirmed_ > 0 || was_refused_;
  stuck_cycles_ = is_stuck ? std::min(stuck_cycles_ + 1, kMaxUnconfirmedCycles + 1) : 0;
  if (isDead() || !is_stuck) return;
  if (is_passive_ && unconfirmed_ > 0) raise(Fault::kBusUnacknowledged);
  if (stuck_cycles_ <= kMaxUnconfirmedCycles) return;
  // A controller that is passive from before says so no more, and one of a slow bus says it later.
  const bool is_alone = unconfirmed_ > 0 && !is_known_alive_;
  raise(is_alone ? Fault::kBusUnacknowledged : Fault::kBusStalled);
}

void BusMonitor::noteFlood() noexcept {
  full_batches_ = std::min(full_batches_, kMaxFullBatches);
  if (full_batches_ == kMaxFullBatches) raise(Fault::kBusFlooded);
}

/// On a flooded bus frames are sent and confirmed all the while, or it would be stalled.
void BusMonitor::recover() noexcept {
  if (fault_ == Fault::kNone) return;
  if (trouble_ != Fault::kNone) has_answered_ = false;
  const bool is_answered = has_answered_ || !isDead();
  const bool is_calm = trouble_ == Fault::kNone && is_answered && !(isDead() && was_confirmed_);
  calm_cycles_ = is_calm ? std::min(calm_cycles_ + 1, kCalmCycles) : 0;
  if (calm_cycles_ == kCalmCycles && (unconfirmed_ == 0 || !isDead())) rearm();
}

void BusMonitor::rearm() noexcept {
  fault_ = Fault::kNone;
  stuck_cycles_ = calm_cycles_ = 0;
  is_passive_ = lacks_acknowledge_ = has_answered_ = false;
}

}  // namespace tactus
