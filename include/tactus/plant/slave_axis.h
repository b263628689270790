#pragma once

#include <cstdint>

#include "tactus/canopen/hardware_config.h"
#include "tactus/plant/object_dictionary.h"
#include "tactus/plant/power_state.h"

namespace tactus {

/// The drive behind the CANopen node: power stage (CiA 402), cyclic synchronous velocity, stops.
/// Control and target come from the object dictionary, status and actual values go there.
class SlaveAxis {
 public:
  /// Without torque only the gear's friction slows a joint down, m/s^2 or rad/s^2. With torque it
  /// stops as 6085 says.
  static constexpr double kCoastingDeceleration = 1.0;

  /// Without power.
  explicit SlaveAxis(const DriveConfig& config) : config_(config) {}

  void setPowered(bool is_on, ObjectDictionary& objects) noexcept;

  /// Does what the control word says; true if that has reset a fault.
  bool obey(ObjectDictionary& objects, bool may_reset) noexcept;

  /// Begins the fault reaction; false if the drive is in fault, or off, already.
  bool fail(ObjectDictionary& objects) noexcept;

  /// Drives for dt_s.
  void move(double dt_s, ObjectDictionary& objects) noexcept;

  /// What the encoder sees, m or rad.
  void setPosition(double q, ObjectDictionary& objects) const noexcept;

  PowerState state() const noexcept { return state_; }
  double velocity() const noexcept { return velocity_; }  ///< of the joint, m/s or rad/s

 private:
  bool follows(const ObjectDictionary& objects) const noexcept;
  double deceleration(const ObjectDictionary& objects) const noexcept;
  void showStatus(ObjectDictionary& objects) const noexcept;

  DriveConfig config_;
  PowerState state_ = PowerState::kNotReadyToSwitchOn;
  bool is_powered_ = false;
  bool had_reset_bit_ = false;
  double velocity_ = 0.0;
};

}  // namespace tactus
