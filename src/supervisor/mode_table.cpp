#include "tactus/supervisor/mode_table.h"

#include <algorithm>
#include <array>

namespace tactus {
namespace {

struct ModeRows {
  using enum Mode;
  static constexpr std::uint32_t kIfAcknowledging = kIfEnableLine | kIfCauseGone | kIfEnableOff;
  static constexpr std::uint32_t kIfAcknowledged =
      kIfEnableLine | kIfCauseGone | kIfEnableOn | kIfWasOff;
  static constexpr std::uint32_t kIfDone = kIfAtRest | kIfDrivesOff;
  static constexpr auto kSetup = Fault::kDriveSetupRefused;
  static constexpr auto kLost = Fault::kDriveStateLost;

  static constexpr auto kTable = std::to_array<ModeRow>({
      {kBoot, kOff, kIfStopRequested},
      {kBoot, kFault, kIfTimeOver, kSetup},
      {kBoot, kFault, kIfFault},
      {kBoot, kReady, kIfConfigured},

      {kReady, kOff, kIfStopRequested},
      {kReady, kFault, kIfFault},
      {kReady, kEnabling, kIfEnableOn},

      {kEnabling, kFault, kIfTimeOver, kLost},
      {kEnabling, kFault, kIfStopsAtOnce},
      {kEnabling, kStopping, kIfStopRequested},
      {kEnabling, kStopping, kIfEnableOff},
      {kEnabling, kStopping, kIfFault},
      {kEnabling, kRunning, kIfFollowing | kIfBrakesHadTime},
      {kEnabling, kEnabling, kIfFollowing, Fault::kNone, ModeEffect::kCountFollowing},
      {kEnabling, kEnabling, kIfNotFollowing, Fault::kNone, ModeEffect::kCountAnew},

      {kRunning, kFault, kIfStopsAtOnce},
      {kRunning, kStopping, kIfStopRequested},
      {kRunning, kStopping, kIfRamps},
      {kRunning, kHolding, kIfEnableOff},
      {kRunning, kRetreating, kIfRetreats},

      {kRetreating, kFault, kIfStopsAtOnce},
      {kRetreating, kStopping, kIfStopRequested},
      {kRetreating, kStopping, kIfRamps},
      {kRetreating, kHolding, kIfEnableOff},
      {kRetreating, kHolding, kIfRetreatOver},
      {kRetreating, kHolding, kIfTimeOver},

      {kHolding, kFault, kIfStopsAtOnce},
      {kHolding, kStopping, kIfStopRequested},
      {kHolding, kStopping, kIfRamps},
      {kHolding, kStopping, kIfFault | kIfNoEnableLine | kIfAtRest},
      {kHolding, kHolding, kIfAcknowledging, Fault::kNone, ModeEffect::kRememberOff},
      {kHolding, kRunning, kIfAcknowledged | kIfAtRest, Fault::kNone, ModeEffect::kClear},

      {kStopping, kFault, kIfTimeOver, kLost},
      {kStopping, kFault, kIfStopsAtOnce},
      {kStopping, kFault, kIfDone | kIfFault},
      {kStopping, kOff, kIfDone | kIfStopRequested},
      {kStopping, kReady, kIfDone},

      {kFault, kOff, kIfOffOrTimeOver | kIfStopRequested},
      {kFault, kOff, kIfOffOrTimeOver | kIfNoEnableLine},
      {kFault, kFault, kIfOffOrTimeOver | kIfAcknowledging, Fault::kNone, ModeEffect::kRememberOff},
      {kFault, kBoot, kIfOffOrTimeOver | kIfAcknowledged, Fault::kNone, ModeEffect::kClear},
  });

  static constexpr auto kBrakes = std::to_array<BrakeRow>({
      {kEnabling, kIfAllFollow},
      {kRunning, 0},
      {kRetreating, 0},
      {kHolding, 0},
      {kStopping, kIfBrakeWasOpen | kIfNotResting},
      {kFault, kIfBrakeWasOpen | kIfAnyHolds | kIfNoneMovesOn | kIfBeforeDeadline},
  });
};

}  // namespace

std::span<const ModeRow> modeRows() noexcept { return ModeRows::kTable; }

std::span<const BrakeRow> brakeRows() noexcept { return ModeRows::kBrakes; }

bool isLegal(Mode from, Mode to) noexcept {
  return from != to && std::any_of(modeRows().begin(), modeRows().end(), [&](const ModeRow& row) {
           return row.from == from && row.to == to;
         });
}

}  // namespace tactus
