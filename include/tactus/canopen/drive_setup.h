#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/canopen/sdo_client.h"

namespace tactus {

/// Why a drive could not be configured: the object and the abort code, 0 for a time-out, or for
/// another value than the one that was waited for.
struct SetupFailure {
  std::uint16_t index = 0;
  std::uint8_t subindex = 0;
  std::uint32_t abort_code = 0;
  bool is_other_value = false;
  std::uint32_t value = 0, expected = 0;  ///< of that
};

/// 60C2: the period is value * 10^exponent seconds.
struct InterpolationPeriod {
  std::uint8_t value = 0;
  std::int8_t exponent = 0;

  bool operator==(const InterpolationPeriod&) const = default;
};

/// Nothing for periods that 60C2 cannot hold exactly.
std::optional<InterpolationPeriod> interpolationPeriod(double period_s) noexcept;

/// What the set-up does with an entry of the drive's object dictionary.
struct SetupStep {
  enum class Kind : std::uint8_t {
    kExpect,  ///< read until it holds the value in the bits of the mask, or the time is over
    kWrite,   ///< the value
    /// Read, and written back with the value in the bits of the mask unless it is there; only
    /// written where it cannot be read, and all bits are told.
    kEnsure,
  };
  Kind kind = Kind::kWrite;
  ObjectEntry entry;
  std::uint32_t value = 0;
  std::uint32_t mask = 0xFFFFFFFF;
  /// What of the drive's refusals is forgiven, each with all before it.
  enum class Need : std::uint8_t {
    kRequired,
    kIfThere,     ///< drives may be without this entry
    kIfWritable,  ///< they may have it without letting it be written
    kIfTaken,     ///< they may refuse the value for any reason
  };
  Need need = Need::kRequired;

  /// Nothing of what was there is to be kept: an entry that cannot be read may be written.
  bool tellsAllBits() const noexcept { return mask == ~std::uint32_t{0}; }
};

using SetupSteps = std::vector<SetupStep>;

/// The steps in their order. Throws std::invalid_argument with one line if the drive could not be
/// told the period or the heartbeat times.
SetupSteps setupSteps(const DriveConfig& drive, const CanopenConfig& canopen, double period_s);

/// Configures a drive: NMT pre-operational, all steps by SDO, NMT start. A drive that has not
/// answered yet is asked again until CanopenConfig::boot_timeout_s, and one that boots meanwhile is
/// configured from the beginning. Whether the drive then runs is seen by its heartbeat and
/// feedback.
class DriveSetup {
 public:
  enum class Status : std::uint8_t { kIdle, kBusy, kDone, kFailed };

  DriveSetup(const DriveConfig& drive, const CanopenConfig& canopen, double period_s);

  void start() noexcept;
  void onBootUp() noexcept;                      ///< begins anew
  void receive(const CanFrame& frame) noexcept;  ///< answers of the drive's SDO server
  void update(FrameBatch& out) noexcept;         ///< once a cycle, after all frames

  Status status() const noexcept { return status_; }
  const SetupFailure& failure() const noexcept { return failure_; }

 private:
  void beginStep() noexcept;
  void judgeTransfer() noexcept;
  void judgeSilence() noexcept;
  void judgeAbort() noexcept;
  void judgeAnswer() noexcept;
  void write(std::uint32_t value) noexcept;
  void nextStep() noexcept;
  void fail(std::uint32_t abort_code) noexcept;

  SetupSteps steps_;
  SdoClient sdo_;
  int node_id_;
  int sdo_timeout_cycles_;
  int boot_timeout_cycles_;
  Status status_ = Status::kIdle;
  SetupFailure failure_;
  std::size_t step_ = 0;
  bool is_announced_ = false;  ///< NMT pre-operational has been sent
  bool is_repeated_ = false;   ///< this step, which was not answered
  bool is_changing_ = false;   ///< the second half of kEnsure
  int cycles_ = 0;             ///< since start()
  int step_cycles_ = 0;
};

}  // namespace tactus
