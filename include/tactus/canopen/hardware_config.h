#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "tactus/control/tactile_channels.h"

/// What robot.yaml says of the machine between controller and arm. All of it is checked by the
/// loader: indices point at something, numbers are finite and in range, no id is given twice.
namespace tactus {

inline constexpr int kMaxBuses = 8;

struct BusConfig {
  std::string interface;  ///< name of the CAN network interface, as can0
  double bit_rate_per_s = 1e6;
  /// Of the data of CAN FD frames; absent: a classic bus.
  std::optional<double> data_bit_rate_per_s{};
};

/// What a drive understands.
enum class DriveKind : std::uint8_t {
  kCia402,  ///< CANopen, CiA 402 in cyclic synchronous velocity mode
  kMoteus,  ///< mjbots' moteus, on CAN FD
};

/// What the position of a moteus refers to, as its register 0x00C has it.
enum class MoteusHome : std::int32_t {
  kRotor = 1,   ///< the rotor, whose whole turns nobody counts while the power is off
  kOutput = 2,  ///< the output shaft
};

/// counts = sign * counts_per_unit * (q - offset), with q in m or rad. The counts of a moteus are
/// turns.
struct DriveConfig {
  DriveKind kind = DriveKind::kCia402;
  int joint = 0;
  int bus = 0;                        ///< index into HardwareConfig::buses
  int node_id = 1;                    ///< 1..127
  double counts_per_unit = 1e6;       ///< per m or rad, > 0
  double offset = 0.0;                ///< m or rad: the joint's position at 0 counts
  int sign = 1;                       ///< +1 or -1
  double max_following_error = 0.05;  ///< m or rad, between command and measured position
  double max_velocity =
      std::numeric_limits<double>::infinity();  ///< m/s or rad/s, tracking included
  double tracking_gain_per_s = 0.0;  ///< pulls the drive to the commanded position; 0: none
  /// Entries 1018:1 and :2, which the node has to have; absent: any.
  std::optional<std::uint32_t> vendor_id{}, product_code{};
  int transmit_pdos = 4;              ///< all but the first are switched off, those that are there
  bool has_quick_stop_option = true;  ///< entry 605A; else its quick stop is its own affair
  bool has_velocity_unit = true;      ///< entry 60A9, if it is there, says what 60FF is in
  MoteusHome home = MoteusHome::kOutput;  ///< at least, of a moteus
  bool has_speed_limit = true;            ///< entry 607F, if it is there, is in counts/s as 60FF is
};

/// CANopen settings common to all drives.
struct CanopenConfig {
  int master_node_id = 127;
  double heartbeat_period_s = 0.02;   ///< of the daemon and of the drives
  double heartbeat_timeout_s = 0.06;  ///< after which the other side is taken for dead
  double sdo_timeout_s = 0.1;
  double boot_timeout_s = 5.0;  ///< for all drives to be configured, after which booting fails
  /// From a fault on, until brakes are closed, and drives that are not seen off are cut off; longer
  /// than any quick stop.
  double stop_deadline_s = 0.5;
};

/// A tactile module on its bus: frames first_id + k, k = 0..3, of two channels each.
struct CanTactileConfig {
  int bus = 0;
  std::uint32_t first_id = 0x100;
  TactileChannels channels;
  /// Cut-off of the daemon's 3rd-order Butterworth at the module's rate; absent: the module
  /// filters.
  std::optional<double> filter_cutoff_hz;
  int tare_samples = 50;           ///< averaged before activation
  double tare_max_offset_N = 2.0;  ///< of |F| in rest: more is a contact, or a fault
  double tare_max_spread_N = 0.2;  ///< of |F| while averaging
};

struct GpioLineConfig {
  int line = 0;
  bool active_low = false;
  double debounce_s = 0.0;  ///< inputs: how long a change that lets the arm move must last
};

struct GpioConfig {
  std::string chip;                         ///< as gpiochip0
  std::optional<GpioLineConfig> e_stop;     ///< in: active: stop
  std::optional<GpioLineConfig> enable;     ///< in: active: may move
  std::optional<GpioLineConfig> brake;      ///< out: active: brakes released
  double brake_switching_s = 0.1;           ///< that the brakes take to open or to close
  std::optional<GpioLineConfig> heartbeat;  ///< out: toggles each cycle while the loop runs
};

struct RealTimeConfig {
  int priority = 80;        ///< SCHED_FIFO, 1..98
  int cpu = -1;             ///< the loop's core; -1: any
  int max_late_cycles = 3;  ///< in a row; more is a fault
  bool required = true;     ///< false: run even where the machine grants no real time
};

struct HardwareConfig {
  std::vector<BusConfig> buses;
  std::vector<DriveConfig> drives;  ///< one a joint, in the order of the joints
  CanopenConfig canopen;
  std::vector<CanTactileConfig> tactile_modules;
  std::optional<GpioConfig> gpio;
  RealTimeConfig real_time;
  double start_tolerance = 0.02;  ///< m or rad: how far the arm may be from the scene's start
};

}  // namespace tactus
