#pragma once

#include <algorithm>
#include <vector>

#include "support/commission_arms.h"

/// A joint of an arm with lines, while something goes wrong.
namespace tactus::test {

inline constexpr int kTroubledJoint = 1;

inline std::vector<HiddenJoint> turnedArm(double counts_per_rad = 4e5) {
  std::vector<HiddenJoint> arm = plainArm(3);
  arm[1].sign = -1;
  arm[1].counts_per_unit = counts_per_rad;
  arm[1].offset = 1.2;
  arm[1].start = 0.1;
  return arm;
}

inline CommissionConfig configWithLines() {
  CommissionConfig config = commissionConfig(plainArm(3));
  GpioConfig gpio;
  gpio.e_stop = gpio.enable = gpio.brake = GpioLineConfig{};
  config.hardware.gpio = gpio;
  return config;
}

inline std::uint16_t sdoIndex(const CanFrame& frame) {
  return static_cast<std::uint16_t>(frame.data[1] | frame.data[2] << 8);
}

inline CanFrame sdoAnswer(int node_id, const CanFrame& request, std::uint8_t command,
                          std::uint32_t data) {
  CanFrame answer = request;
  answer.id = 0x580u + static_cast<unsigned>(node_id);
  answer.data[0] = command;
  for (unsigned i = 0; i < 4; ++i) answer.data[4 + i] = static_cast<std::uint8_t>(data >> 8 * i);
  return answer;
}

struct TroubledRig : CommissionRig {
  explicit TroubledRig(std::uint64_t seed = 1, double counts_per_rad = 4e5)
      : CommissionRig(turnedArm(counts_per_rad), configWithLines(), seed) {
    jogs = false;
    EXPECT_TRUE(scan());
    on_cycle = [this] { watch(); };
  }

  /// In every cycle, whatever happens.
  void watch() {
    const bool is_open = cycle->lines().release_brake;
    const PowerState state = drive(kTroubledJoint).powerState();
    const bool has_torque = state == PowerState::kOperationEnabled ||
                            state == PowerState::kQuickStopActive ||
                            state == PowerState::kFaultReactionActive;
    // A cycle and a half for the frames to have told.
    open_without_torque = is_open && !has_torque ? open_without_torque + 1 : 0;
    most_open_without_torque = std::max(most_open_without_torque, open_without_torque);
    if (drive(kTroubledJoint).velocity() != 0.0 && has_torque && !is_open && !may_brake)
      ++moved_on_brake;
  }

  JointTrouble trouble() {
    EXPECT_TRUE(commission(kTroubledJoint));
    cycles(1500);
    EXPECT_TRUE(isAllOffAndAtRest());
    EXPECT_FALSE(cycle->lines().release_brake);
    return cycle->joint()->trouble();
  }

  int open_without_torque = 0, most_open_without_torque = 0, moved_on_brake = 0;
  bool may_brake = false;
};

}  // namespace tactus::test
