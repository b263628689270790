#pragma once

#include <array>
#include <cstdint>

#include "tactus/canopen/can_frame.h"
#include "tactus/canopen/hardware_config.h"
#include "tactus/plant/plant_bus.h"
#include "tactus/plant/power_state.h"
#include "tactus/plant/slave_drive.h"

namespace tactus {

/// A moteus controller as its bus sees it, apart from the master's code: registers that are written
/// and read by subframes, the modes that the master uses, and the watchdog of position mode. In
/// that it follows the velocity at once, whatever position is commanded; otherwise it slows down.
/// Times in ns since the plant was switched on.
class MoteusSlave {
 public:
  static constexpr std::int64_t kEnabling_ns = 3'000'000;  ///< in modes 2 to 4
  static constexpr double kDeceleration = 20.0;            ///< m/s^2 or rad/s^2

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
  void write(std::uint32_t number, double value) noexcept;
  void command(int mode) noexcept;
  double read(std::uint32_t number) const noexcept;
  bool obeyFrame(const CanFrame& frame, CanFrame& reply) noexcept;
  void fail(int code) noexcept;

  DriveConfig config_;
  std::int64_t max_setpoint_age_ns_;
  bool is_powered_ = false;
  int mode_ = 0;
  int fault_ = 0;
  double position_turns_ = 0.0;
  double velocity_ = 0.0;  ///< m/s or rad/s
  double commanded_turns_per_s_ = 0.0;
  std::int64_t enabled_at_ns_ = kNever_ns;
  std::int64_t expires_ns_ = kNever_ns;
  std::int64_t now_ns_ = 0;
  DriveTroubles troubles_;
  std::array<double, 3> frozen_{};  ///< mode, position, velocity
  FrameBatch outbox_;
  std::uint64_t stale_setpoints_ = 0;
};

}  // namespace tactus
