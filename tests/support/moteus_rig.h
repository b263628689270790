#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>

#include "support/period.h"
#include "tactus/canopen/moteus_drive.h"

namespace tactus::test {

inline constexpr int kMoteusNode = 7;

inline DriveConfig moteusConfig() {
  DriveConfig config;
  config.kind = DriveKind::kMoteus;
  config.node_id = kMoteusNode;
  config.counts_per_unit = 0.5;
  config.sign = -1;
  config.offset = 0.25;
  config.max_velocity = 2.0;
  return config;
}

inline CanFrame moteusReply(int mode, float position, float velocity, int fault,
                            int map = kMoteusMap, int home = 2) {
  CanFrame frame;
  frame.id = moteusReplyId(kMoteusNode);
  frame.is_fd = true;
  const auto put = [&frame](int byte) {
    frame.data[frame.size++] = static_cast<std::uint8_t>(byte);
  };
  const auto putFloat = [&put](float value) {
    std::uint32_t bits = 0;
    std::memcpy(&bits, &value, sizeof(bits));
    for (int i = 0; i < 4; ++i) put(static_cast<int>(bits >> 8 * i & 0xFF));
  };
  put(0x21), put(0x00), put(mode), put(0x2E), put(0x01);
  putFloat(position);
  putFloat(velocity);
  put(0x21), put(0x0F), put(fault), put(0x21), put(0x0C), put(home);
  put(0x29), put(0x82), put(0x02);
  put(map), put(0), put(0), put(0);
  return frame;
}

/// What a command says: mode (-1: none) and velocity in turns/s.
struct Said {
  int mode = -1;
  float velocity = 0.0F;
};

inline Said saidBy(const CanFrame& frame) {
  Said said;
  if (frame.data[0] != 0x01) return said;
  said.mode = frame.data[2];
  if (said.mode == 10) std::memcpy(&said.velocity, &frame.data[9], sizeof(float));
  return said;
}

struct MoteusRig {
  MoteusDrive drive{moteusConfig(), CanopenConfig{}, kPeriod_s};
  double position = 0.25;
  int mode = 0, fault = 0;
  float turns = 0.0F;

  Said cycle(DriveGoal goal, double velocity = 0.0, bool restart = false) {
    drive.receive(moteusReply(mode, turns, 0.0F, fault));
    return quietCycle(goal, velocity, restart);
  }
  Said quietCycle(DriveGoal goal, double velocity = 0.0, bool restart = false) {
    FrameBatch out;
    drive.observe({position, position});
    drive.update(goal, restart, velocity, position, out);
    EXPECT_LE(out.size(), 1u);
    return out.empty() ? Said{-2, 0.0F} : saidBy(*out.begin());
  }
  void cycles(int count, DriveGoal goal) {
    for (int i = 0; i < count; ++i) cycle(goal);
  }
  void configure() {
    cycle(DriveGoal::kConfigure, 0.0, true);
    cycle(DriveGoal::kConfigure);
    ASSERT_TRUE(drive.report().is_configured);
  }
  void enable() {
    configure();
    EXPECT_EQ(cycle(DriveGoal::kEnabled, 1.0).velocity, 0.0F) << "not before it follows";
    mode = 10;
    for (int i = 0; i < 5; ++i) cycle(DriveGoal::kEnabled);
  }
};

}  // namespace tactus::test
