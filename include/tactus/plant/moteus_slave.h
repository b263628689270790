#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/plant/plant_bus.h"
#include "tactus/plant/power_state.h"
#include "tactus/plant/slave_drive.h"

namespace tactus {

/// A moteus controller as its bus sees it, apart from the master's code: registers that are written
/// and read by subframes, the modes that the master uses, and the watchdog of position mode. In
/// that it follows the velocity at once, and jumps to a position that is commanded; otherwise it
/// slows down.
/// Times in ns since the plant was switched on.
class MoteusSlave {
 public:
  static constexpr std::int64_t kEnabling_ns = 3'000'000;  ///< in modes 2 to 4
  static constexpr double kDeceleration = 20.0;            ///< with torque, m/s^2 or rad/s^2

  /// Switched off.
  MoteusSlave(const DriveConfig& config, double period_s);

  void setPowered(bool is_on, std::int64_t t_ns) noexcept;
  /// Of the troubles of a drive: failing, ignoring, frozen; telling nonsense is a position that is
  /// no number. The others it does not have.
  void setTroubles(const DriveTroubles& troubles) noexcept;
  void receive(const QueuedFrame& item, std::int64_t t_ns) noexcept;
  void update(std::int64_t t_ns) noexcept;
  std::int64_t nextEvent_ns() const noexcept;

  void move(double dt_s) noexcept;
  void setPosition(double q) noexcept;

  FrameBatch& outbox() noexcept { return outbox_; }
  PowerState powerState() const noexcept;
  double velocity() const noexcept { return velocity_; }  ///< m/s or rad/s
  std::uint64_t staleSetpoints() const noexcept { return stale_setpoints_; }
  int mode() const noexcept { return mode_; }

 private:
  /// What a frame commands, with the numbers that it has where they are not written.
  struct Command {
    std::optional<int> mode;
    double turns = 0.0;  ///< not finite: from where it is
    double turns_per_s = 0.0;
    double watchdog_s = 0.0;  ///< NaN: none
  };

  bool obeyFrame(const CanFrame& frame, CanFrame& reply) noexcept;
  enum class Answer : std::uint8_t { kWhole, kError, kNoRoom };

  Answer answer(std::uint32_t first, std::uint32_t count, std::uint8_t what,
                CanFrame& reply) const noexcept;
  int write(std::uint32_t number, double value) noexcept;
  std::optional<double> read(std::uint32_t number, int type) const noexcept;
  void applyCommand() noexcept;
  void enter(int mode) noexcept;
  void follow(double dt_s) noexcept;
  void fail(int code) noexcept;

  DriveConfig config_;
  std::int64_t max_setpoint_age_ns_;
  bool is_powered_ = false;
  int mode_ = 0;
  int fault_ = 0;
  double position_turns_ = 0.0;
  double velocity_ = 0.0;         ///< m/s or rad/s
  double forgotten_turns_ = 0.0;  ///< while the power was off
  Command command_, followed_;
  std::int64_t enabled_at_ns_ = kNever_ns;
  std::int64_t expires_ns_ = kNever_ns;
  std::int64_t now_ns_ = 0;
  DriveTroubles troubles_;
  std::array<double, 3> frozen_{};  ///< mode, position, velocity
  FrameBatch outbox_;
  std::uint64_t stale_setpoints_ = 0;
};

}  // namespace tactus
