#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <vector>

#include "plant/can_bytes.h"
#include "support/crops9.h"
#include "tactus/plant/plant.h"

namespace tactus::test {

inline constexpr double kPeriod_s = 0.001;
inline constexpr std::int64_t kPeriod_ns = 1'000'000;

/// The reference robot: three drives a bus on three buses, the module on a fourth. Every drive
/// counts in its own way.
inline HardwareConfig crops9Hardware() {
  HardwareConfig hardware;
  for (const char* name : {"can0", "can1", "can2", "can3"}) hardware.buses.push_back({name, 1e6});
  for (int joint = 0; joint < 9; ++joint) {
    DriveConfig drive;
    drive.joint = joint;
    drive.bus = joint / 3;
    drive.node_id = 1 + joint % 3;
    drive.counts_per_unit = 1e6 * (1 + joint);
    drive.offset = 0.1 * joint - 0.3;
    drive.sign = joint % 2 == 0 ? 1 : -1;
    hardware.drives.push_back(drive);
  }
  hardware.tactile_modules.emplace_back();
  hardware.tactile_modules.front().bus = 3;
  hardware.tactile_modules.front().channels.calibration =
      crops9Plant({}).modules[0].channels.calibration;
  return hardware;
}

/// A master with nothing but the bytes of CiA 301 and 402: sets up and enables all drives, and then
/// sends what it is told, cycle by cycle.
class ScriptedMaster {
 public:
  ScriptedMaster(Plant& plant, const HardwareConfig& hardware)
      : plant_(plant),
        drives_(hardware.drives),
        velocity_(drives_.size(), 0.0),
        positions_(drives_.size()),
        status_(drives_.size()),
        feedbacks_(drives_.size(), 0) {}

  /// To operation enabled, at rest.
  void start() {
    waitUntil(60'000'000);
    for (const DriveConfig& drive : drives_) configure(drive);
    for (int bus = 0; bus < plant_.buses(); ++bus) plant_.send(bus, canFrame(0, {1, 0}), t_ns_);
    waitUntil((t_ns_ / kPeriod_ns + 1) * kPeriod_ns + phase_ns);
    for (const int word : {0x06, 0x07, 0x0F}) {
      control_word = word;
      for (int i = 0; i < 3; ++i) cycle();
    }
  }

  /// One period: takes what came, sends heartbeat, setpoints and SYNC.
  void cycle() {
    takeAll();
    for (int bus = 0; bus < plant_.buses(); ++bus) {
      if (is_silent) continue;
      if (cycles_ % 20 == 0) plant_.send(bus, canFrame(0x77F, {5}), t_ns_);
      for (std::size_t i = 0; i < drives_.size(); ++i)
        if (drives_[i].bus == bus) plant_.send(bus, setpoint(static_cast<int>(i)), t_ns_);
      if (hasDrives(bus)) plant_.send(bus, canFrame(0x80, {}), t_ns_);
    }
    ++cycles_;
    t_ns_ += kPeriod_ns;
    plant_.advance(t_ns_);
  }
  void cycles(int count) {
    for (int i = 0; i < count; ++i) cycle();
  }

  void setVelocity(int drive, double velocity) { velocity_[drive] = velocity; }
  /// m or rad, of the last feedback.
  double position(int drive) const {
    const DriveConfig& config = drives_[drive];
    return config.offset + config.sign * positions_[drive] / config.counts_per_unit;
  }
  int status(int drive) const { return status_[drive]; }
  int feedbacks(int drive) const { return feedbacks_[drive]; }
  int t_ms() const { return static_cast<int>(t_ns_ / 1'000'000); }
  std::int64_t t_ns() const { return t_ns_; }

  /// All frames that ever came from a bus.
  std::vector<CanFrame> heard(int bus) { return heard_[bus]; }
  int timesHeard(int bus, std::uint32_t id, FrameKind kind = FrameKind::kData) {
    int times = 0;
    for (const CanFrame& frame : heard_[bus]) times += frame.id == id && frame.kind == kind;
    return times;
  }
  void forget() { heard_.clear(); }

  int control_word = 0;
  std::int64_t phase_ns = 0;  ///< of the cycles, against the plant's time
  bool is_silent = false;

 private:
  bool hasDrives(int bus) const {
    for (const DriveConfig& drive : drives_)
      if (drive.bus == bus) return true;
    return false;
  }

  CanFrame setpoint(int drive) const {
    const DriveConfig& config = drives_[drive];
    const auto v = static_cast<std::uint32_t>(static_cast<std::int32_t>(
        std::lround(config.sign * config.counts_per_unit * velocity_[drive])));
    return canFrame(0x200U + static_cast<std::uint32_t>(config.node_id),
                    {control_word & 0xFF, control_word >> 8, static_cast<int>(v & 0xFF),
                     static_cast<int>(v >> 8 & 0xFF), static_cast<int>(v >> 16 & 0xFF),
                     static_cast<int>(v >> 24)});
  }

  void waitUntil(std::int64_t t_ns) {
    t_ns_ = t_ns;
    plant_.advance(t_ns_);
    takeAll();
  }

  void takeAll() {
    for (int bus = 0; bus < plant_.buses(); ++bus) {
      FrameBatch frames;
      plant_.take(bus, frames);
      for (const CanFrame& frame : frames) hear(bus, frame);
    }
  }

  void hear(int bus, const CanFrame& frame) {
    heard_[bus].push_back(frame);
    for (std::size_t i = 0; i < drives_.size(); ++i) {
      const auto id = 0x180U + static_cast<std::uint32_t>(drives_[i].node_id);
      if (drives_[i].bus != bus || frame.id != id || frame.kind != FrameKind::kData) continue;
      status_[i] = static_cast<int>(number(frame, 0, 2));
      positions_[i] = static_cast<std::int32_t>(number(frame, 2, 4));
      ++feedbacks_[i];
    }
  }

  void configure(const DriveConfig& drive) {
    const int node = drive.node_id;
    const auto map = [&](int communication, int mapping, int id, std::uint32_t first,
                         std::uint32_t second) {
      write(drive, communication, 1, 0x8000'0000U | static_cast<std::uint32_t>(id), 4);
      write(drive, mapping, 0, 0, 1);
      write(drive, mapping, 1, first, 4);
      write(drive, mapping, 2, second, 4);
      write(drive, mapping, 0, 2, 1);
      write(drive, communication, 2, 1, 1);
      write(drive, communication, 1, static_cast<std::uint32_t>(id), 4);
    };
    map(0x1400, 0x1600, 0x200 + node, 0x6040'0010, 0x60FF'0020);
    write(drive, 0x1400, 5, 60, 2);
    map(0x1800, 0x1A00, 0x180 + node, 0x6041'0010, 0x6064'0020);
    write(drive, 0x1016, 1, 0x007F'003C, 4);
    write(drive, 0x1017, 0, 20, 2);
    write(drive, 0x6007, 0, 3, 2);
    write(drive, 0x6060, 0, 9, 1);
    write(drive, 0x60C2, 1, 1, 1);
    write(drive, 0x6085, 0, static_cast<std::uint32_t>(10.0 * drive.counts_per_unit), 4);
  }

  void write(const DriveConfig& drive, int index, int subindex, std::uint32_t value, int size) {
    const auto node = static_cast<std::uint32_t>(drive.node_id);
    const int before = timesHeard(drive.bus, 0x580 + node);
    plant_.send(drive.bus,
                canFrame(0x600 + node,
                         {0x23 | (4 - size) << 2, index & 0xFF, index >> 8, subindex,
                          static_cast<int>(value & 0xFF), static_cast<int>(value >> 8 & 0xFF),
                          static_cast<int>(value >> 16 & 0xFF), static_cast<int>(value >> 24)}),
                t_ns_);
    waitUntil(t_ns_ + kPeriod_ns);
    ASSERT_EQ(timesHeard(drive.bus, 0x580 + node), before + 1);
    for (const CanFrame& frame : heard_[drive.bus])
      ASSERT_TRUE(frame.id != 0x580 + node || frame.data[0] == 0x60) << std::hex << index;
  }

  Plant& plant_;
  std::vector<DriveConfig> drives_;
  std::vector<double> velocity_;
  std::vector<std::int32_t> positions_;
  std::vector<int> status_;
  std::vector<int> feedbacks_;
  std::map<int, std::vector<CanFrame>> heard_;
  std::int64_t t_ns_ = 0;
  long cycles_ = 0;
};

}  // namespace tactus::test
