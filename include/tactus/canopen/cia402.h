#pragma once

#include <array>
#include <cstdint>
#include <optional>

/// The power state machine of CiA 402-2 (IEC 61800-7-201): status word 6041, control word 6040.
namespace tactus {

enum class DriveState : std::uint8_t {
  kNotReady,
  kSwitchOnDisabled,
  kReadyToSwitchOn,
  kSwitchedOn,
  kOperationEnabled,
  kQuickStopActive,
  kFaultReactionActive,
  kFault,
};

const char* driveStateName(DriveState state) noexcept;

/// Nothing for patterns that the standard's table does not hold.
std::optional<DriveState> decodeStatusWord(std::uint16_t status_word) noexcept;

/// Values of the control word: commands of the standard. Bits that choose none of them (operation
/// mode, halt, manufacturer's) are 0.
namespace control_word {
inline constexpr std::uint16_t kDisableVoltage = 0x00;
inline constexpr std::uint16_t kQuickStop = 0x02;
inline constexpr std::uint16_t kShutdown = 0x06;
inline constexpr std::uint16_t kSwitchOn = 0x07;
inline constexpr std::uint16_t kDisableOperation = 0x07;
inline constexpr std::uint16_t kEnableOperation = 0x0F;
inline constexpr std::uint16_t kFaultReset = 0x80;  ///< acts when bit 7 rises
}  // namespace control_word

/// Where the state machine is to be led.
enum class PowerGoal : std::uint8_t {
  kDisabled,   ///< switch on disabled, by slowing down first
  kEnabled,    ///< operation enabled
  kQuickStop,  ///< switch on disabled, through the drive's own quick stop
};

/// One transition of the standard, with its number there.
struct PowerTransition {
  int number;
  std::optional<DriveState> from;  ///< none: from any state, or from power-on
  DriveState to;
  bool is_automatic;             ///< the drive's own, whatever is commanded
  std::uint16_t control_word;    ///< that asks for it, or that lets an automatic one happen
  bool to_disabled, to_enabled;  ///< goals to which this is the next step
};

const std::array<PowerTransition, 17>& powerTransitions() noexcept;  ///< in order of the numbers

/// The transition that is one step nearer to the goal; none at the goal, where only the drive
/// itself gets further, and for a quick stop, which is one command in every state.
const PowerTransition* nextTransition(DriveState state, PowerGoal goal) noexcept;

/// The control word for one step towards the goal, or for staying there. Never a fault reset: a
/// drive in fault is left there.
std::uint16_t controlWordTowards(PowerGoal goal, DriveState state) noexcept;

}  // namespace tactus
