#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/control/fault.h"
#include "tactus/control/robot.h"
#include "tactus/math/filter.h"

namespace tactus {

enum class TareState : std::uint8_t { kNone, kAveraging, kDone, kRefused };

struct TactileCounters {
  std::uint32_t samples = 0;
  std::uint32_t incomplete = 0;  ///< samples dropped because a frame was missing or mixed up
  std::uint32_t malformed = 0;   ///< frames of wrong size or kind
  std::uint32_t repeated = 0;    ///< frames that came twice, or of a sample not newer than the last
};

/// The number of the sample after this one: 0 says that there is none.
constexpr std::uint32_t sampleAfter(std::uint32_t number) noexcept {
  return std::max(number + 1, std::uint32_t{1});
}

/// Assembles samples of a tactile module from its four frames, calibrates, tares and, where the
/// module does not, filters them. Knows no socket and no clock: time is counted in cycles.
///
/// A sample is four frames of one sequence number, in any order; a frame of another new number
/// begins another sample. A number is new if it is 1 to 127 after the last sample's, modulo 256,
/// and others are ignored: a module that is stuck or replayed gives no samples, and one that
/// started anew is heard again after at most 129. Once nothing has come for kMaxSilentSamples
/// sample periods, numbers tell nothing any more, and any is new. A frame that comes twice is
/// ignored if it says the same, and spoils its sample if not.
///
/// Status bit 0 and a channel at its rail (+-(2^23 - 1), -2^23) are saturation. Bit 1 is a broken
/// cable; so is any bit that this code does not know, as the module then says what nobody heeds.
class TactileReceiver {
 public:
  /// Less than the 128 that make a number look old, as clocks differ.
  static constexpr int kMaxSilentSamples = 120;

  /// period_s: of the cycle. Throws std::invalid_argument if the filter's cut-off is not below half
  /// the sample rate.
  TactileReceiver(const CanTactileConfig& config, double period_s);

  int bus() const noexcept { return config_.bus; }

  /// A data frame of the module's bus; ids that are not its own are ignored.
  void receive(const CanFrame& frame) noexcept;
  /// Once a cycle, after all frames.
  void tick() noexcept;

  /// Starts averaging the offset anew; until it is done the old one holds. Never in contact: |F|
  /// without offset above tare_max_offset_N, F wandering by more than tare_max_spread_N (the
  /// diagonal of the rectangle that holds all F) or a faulty sample refuses it.
  void startTare() noexcept;
  TareState tareState() const noexcept { return tare_state_; }
  /// Of the last refusal: offset or spread; none if a faulty sample refused it.
  const FaultDetail& tareRefusal() const noexcept { return tare_refusal_; }

  /// The newest complete sample, tared and filtered; its sequence counts samples from 1.
  const TactileSample& sample() const noexcept { return sample_; }
  /// The channels of that sample, as they came.
  const Eigen::Matrix<double, 8, 1>& counts() const noexcept { return counts_; }
  /// kNone, kTactileSaturated or kTactileCableBreak of the newest sample; not latched.
  Fault fault() const noexcept { return fault_; }
  const TactileCounters& counters() const noexcept { return counters_; }

 private:
  static constexpr int kFrames = 4;
  static constexpr int kChannels = 8;
  static constexpr int kReadings = 5;

  /// The sample under way.
  struct Assembly {
    std::uint8_t sequence = 0;
    unsigned arrived = 0;  ///< bit k: frame k
    bool is_spoilt = false;
    std::uint8_t status = 0;  ///< of all frames together
    std::array<CanFrame, kFrames> frames;
  };

  void add(int index, const CanFrame& frame) noexcept;
  void begin(std::uint8_t sequence) noexcept;
  bool isNew(std::uint8_t sequence) const noexcept;
  void finish() noexcept;
  void forgetNumbers() noexcept;
  void publish(const Wrench5& raw) noexcept;
  void average(const Wrench5& raw) noexcept;
  void refuseTare(double offset_N, double spread_N) noexcept;
  void endTare() noexcept;

  CanTactileConfig config_;
  std::optional<ButterworthLowPass> fresh_filter_;
  std::array<std::optional<ButterworthLowPass>, kReadings> filters_;

  Assembly assembly_;
  bool has_finished_ = false;
  std::uint8_t finished_sequence_ = 0;
  int max_silent_cycles_;
  int silent_cycles_ = 0;  ///< without a frame that has a number, up to that

  Wrench5 offset_ = Wrench5::Zero();
  TareState tare_state_ = TareState::kNone;
  int tare_count_ = 0;
  Wrench5 tare_sum_ = Wrench5::Zero();
  Eigen::Vector2d tare_low_, tare_high_;  ///< F_y and F_z so far
  FaultDetail tare_refusal_;

  TactileSample sample_;
  Eigen::Matrix<double, kChannels, 1> counts_ = Eigen::Matrix<double, kChannels, 1>::Zero();
  Fault fault_ = Fault::kNone;
  TactileCounters counters_;
};

}  // namespace tactus
