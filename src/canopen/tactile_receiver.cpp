#include "tactus/canopen/tactile_receiver.h"

#include <algorithm>

#include "tactus/canopen/cycle_count.h"

namespace tactus {
namespace {

constexpr std::uint8_t kSaturated = 0x01;
constexpr int kRail = (1 << 23) - 1;
constexpr int kFirstChannelByte = 2;
constexpr int kBytesPerChannel = 3;
constexpr unsigned kAllFrames = 0xF;

/// Signed 24 bits, little-endian.
int countsAt(const CanFrame& frame, int byte) noexcept {
  const std::uint32_t bits = static_cast<std::uint32_t>(frame.data[byte]) |
                             static_cast<std::uint32_t>(frame.data[byte + 1]) << 8 |
                             static_cast<std::uint32_t>(frame.data[byte + 2]) << 16;
  return static_cast<int>(bits ^ 0x800000U) - 0x800000;
}

bool isAtRail(int counts) noexcept { return counts >= kRail || counts <= -kRail; }

}  // namespace

TactileReceiver::TactileReceiver(const CanTactileConfig& config, double period_s)
    : config_(config),
      max_silent_cycles_(
          cyclesLasting(kMaxSilentSamples * config.channels.sample_period_s, period_s)) {
  if (config.filter_cutoff_hz)
    fresh_filter_.emplace(*config.filter_cutoff_hz, 1.0 / config.channels.sample_period_s);
  filters_.fill(fresh_filter_);
}

void TactileReceiver::receive(const CanFrame& frame) noexcept {
  const std::uint32_t index = frame.id - config_.first_id;
  if (index >= kFrames) return;
  if (frame.kind != FrameKind::kData || frame.extended || frame.is_fd || frame.size != 8) {
    ++counters_.malformed;
    return;
  }
  silent_cycles_ = 0;
  if (isNew(frame.data[0]))
    add(static_cast<int>(index), frame);
  else
    ++counters_.repeated;
}

void TactileReceiver::tick() noexcept {
  if (silent_cycles_ == max_silent_cycles_) return;
  if (++silent_cycles_ == max_silent_cycles_) forgetNumbers();
}

/// Nor may frames from before the silence complete a sample after it.
void TactileReceiver::forgetNumbers() noexcept {
  has_finished_ = false;
  if (assembly_.arrived != 0) ++counters_.incomplete;
  assembly_.arrived = 0;
}

bool TactileReceiver::isNew(std::uint8_t sequence) const noexcept {
  const int ahead = static_cast<std::uint8_t>(sequence - finished_sequence_);
  return !has_finished_ || (ahead >= 1 && ahead <= 127);
}

void TactileReceiver::add(int index, const CanFrame& frame) noexcept {
  if (assembly_.arrived == 0 || assembly_.sequence != frame.data[0]) begin(frame.data[0]);
  const bool is_repeated = (assembly_.arrived >> index & 1U) != 0;
  if (is_repeated) ++counters_.repeated;
  if (is_repeated && assembly_.frames[index] != frame) assembly_.is_spoilt = true;
  if (is_repeated) return;
  assembly_.arrived |= 1U << index;
  assembly_.status |= frame.data[1];
  assembly_.frames[index] = frame;
  if (assembly_.arrived == kAllFrames) finish();
}

void TactileReceiver::begin(std::uint8_t sequence) noexcept {
  if (assembly_.arrived != 0) ++counters_.incomplete;
  assembly_.sequence = sequence;
  assembly_.arrived = 0;
  assembly_.is_spoilt = false;
  assembly_.status = 0;
}

void TactileReceiver::finish() noexcept {
  has_finished_ = true;
  finished_sequence_ = assembly_.sequence;
  assembly_.arrived = 0;
  if (assembly_.is_spoilt) {
    ++counters_.incomplete;
    return;
  }
  bool is_saturated = (assembly_.status & kSaturated) != 0;
  for (int channel = 0; channel < kChannels; ++channel) {
    const int byte = kFirstChannelByte + kBytesPerChannel * (channel % 2);
    const int value = countsAt(assembly_.frames[channel / 2], byte);
    counts_[channel] = value;
    is_saturated = is_saturated || isAtRail(value);
  }
  fault_ = is_saturated ? Fault::kTactileSaturated : Fault::kNone;
  if ((assembly_.status & ~kSaturated) != 0) fault_ = Fault::kTactileCableBreak;
  const TactileChannels& channels = config_.channels;
  const Eigen::Vector4d known = channels.calibration * counts_ / channels.counts_per_N;
  const double moment_x_Nm =
      channels.moment_x ? channels.moment_x->dot(counts_) / channels.counts_per_N : 0.0;
  publish(Wrench5{{known[0], known[1], known[2], known[3], moment_x_Nm}});
}

/// What a broken cable says is left out of the filters: it would ring on once the cable is whole.
void TactileReceiver::publish(const Wrench5& raw) noexcept {
  if (tare_state_ == TareState::kAveraging) average(raw);
  Wrench5 wrench = raw - offset_;
  const bool is_read = fault_ != Fault::kTactileCableBreak;
  for (int i = 0; i < kReadings; ++i) {
    if (filters_[i] && is_read) wrench[i] = filters_[i]->update(wrench[i]);
  }
  counters_.samples = sampleAfter(counters_.samples);
  sample_ = {wrench[0], wrench[1], wrench[2], wrench[3], counters_.samples, wrench[4]};
}

void TactileReceiver::startTare() noexcept {
  tare_state_ = TareState::kAveraging;
  tare_count_ = 0;
  tare_sum_.setZero();
}

void TactileReceiver::average(const Wrench5& raw) noexcept {
  const Eigen::Vector2d force = raw.head<2>();
  tare_low_ = tare_count_ == 0 ? force : tare_low_.cwiseMin(force);
  tare_high_ = tare_count_ == 0 ? force : tare_high_.cwiseMax(force);
  const double offset_N = force.norm();
  const double spread_N = (tare_high_ - tare_low_).norm();
  const bool is_calm =
      offset_N <= config_.tare_max_offset_N && spread_N <= config_.tare_max_spread_N;
  if (fault_ != Fault::kNone || !is_calm) return refuseTare(offset_N, spread_N);
  tare_sum_ += raw;
  if (++tare_count_ >= config_.tare_samples) endTare();
}

void TactileReceiver::refuseTare(double offset_N, double spread_N) noexcept {
  tare_state_ = TareState::kRefused;
  tare_refusal_ = {};
  if (spread_N > config_.tare_max_spread_N)
    tare_refusal_ = {spread_N, config_.tare_max_spread_N, "N"};
  if (offset_N > config_.tare_max_offset_N)
    tare_refusal_ = {offset_N, config_.tare_max_offset_N, "N"};
}

/// Filters begin anew, as the step of the offset would ring in them as a force.
void TactileReceiver::endTare() noexcept {
  offset_ = tare_sum_ / tare_count_;
  tare_state_ = TareState::kDone;
  filters_.fill(fresh_filter_);
}

}  // namespace tactus
