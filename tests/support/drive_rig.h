#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "support/period.h"
#include "support/scripted_drive.h"
#include "tactus/canopen/canopen.h"
#include "tactus/canopen/drive.h"

namespace tactus::test {

inline constexpr int kNode = 5;

inline DriveConfig driveConfig() {
  DriveConfig config;
  config.node_id = kNode;
  config.counts_per_unit = 2e5;
  config.offset = 0.25;
  config.sign = -1;
  config.max_velocity = 20.0;
  return config;
}

/// A drive of the master's, a drive to talk to, and the bus between them: one cycle of delay.
struct DriveRig {
  explicit DriveRig(const DriveConfig& drive_config = driveConfig(),
                    const CanopenConfig& canopen = {})
      : config(drive_config), drive(drive_config, canopen, kPeriod_s) {}

  /// The frames that the master sends; the drive answers in the next cycle.
  std::vector<CanFrame> cycle(DriveGoal goal, double velocity = 0.0, bool restart = false) {
    for (const CanFrame& frame : slave.take()) drive.receive(frame);
    FrameBatch out;
    drive.observe({position, position});
    drive.update(goal, restart, velocity, position, out);
    position += velocity * kPeriod_s;
    for (const CanFrame& frame : out) slave.hear(frame);
    slave.hear(syncFrame());
    return {out.begin(), out.end()};
  }

  void cycles(int count, DriveGoal goal, double velocity = 0.0) {
    for (int i = 0; i < count; ++i) cycle(goal, velocity);
  }

  /// Cycles until done, at most this many; fails the test otherwise.
  template <typename Done>
  int until(Done done, DriveGoal goal, int most = 500) {
    for (int i = 0; i < most; ++i) {
      cycle(goal);
      if (done()) return i + 1;
    }
    ADD_FAILURE() << "not reached in " << most << " cycles, fault " << faultName(report().fault);
    return most;
  }

  void configure() {
    cycle(DriveGoal::kConfigure, 0.0, true);
    until([this] { return report().is_configured || report().fault != Fault::kNone; },
          DriveGoal::kConfigure);
    position = report().position;
  }

  /// Operation enabled, and settled there.
  void enable() {
    configure();
    until([this] { return report().state == DriveState::kOperationEnabled; }, DriveGoal::kEnabled);
    cycles(5, DriveGoal::kEnabled);
    EXPECT_EQ(report().fault, Fault::kNone) << faultName(report().fault);
  }

  const DriveReport& report() const { return drive.report(); }

  DriveConfig config;
  Drive drive;
  ScriptedDrive slave{kNode};
  double position = 0.0;  ///< commanded
};

/// RPDO1 among frames; fails the test unless there is exactly one.
inline DriveCommand commandOf(const std::vector<CanFrame>& frames) {
  DriveCommand command;
  int count = 0;
  for (const CanFrame& frame : frames) {
    if (frame.id != 0x200u + kNode) continue;
    ++count;
    EXPECT_EQ(frame.size, 6);
    const auto& d = frame.data;
    command.control_word = static_cast<std::uint16_t>(d[0] | d[1] << 8);
    command.velocity =
        static_cast<std::int32_t>(d[2] | d[3] << 8 | d[4] << 16 | std::uint32_t{d[5]} << 24);
  }
  EXPECT_EQ(count, 1);
  return command;
}

}  // namespace tactus::test
