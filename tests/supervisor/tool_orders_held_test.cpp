#include <gtest/gtest.h>

#include "support/orders_rig.h"

/// Orders to a tool that is held off, lags, or was stopped meanwhile.
namespace tactus {
namespace {

using test::OrdersRig;
using test::orderTo;

constexpr auto kNext = ToolOrder::Kind::kGoNext;
constexpr auto kStreamed = ToolOrder::Kind::kStream;

OrdersRig heldOff() {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.run(1.0);
  rig.is_held_off = true;
  rig.run(1.0);
  EXPECT_EQ(rig.state(), ToolState::kBlocked);
  return rig;
}

/// Its reference waits in front of it, which is where a hold must not lead.
TEST(ToolOrdersHeld, AHoldRestsWhereTheToolIs) {
  OrdersRig rig = heldOff();
  const Vector3 held = rig.seen.X_BaseTool.p_AB;
  ToolOrder hold;
  hold.number = 2;
  rig.orders.order(hold);
  rig.run(0.1);
  EXPECT_EQ(rig.state(), ToolState::kHolding);
  rig.is_held_off = false;
  rig.run(3.0);
  EXPECT_EQ(rig.place(), held);
}

TEST(ToolOrdersHeld, AStreamThatFallsSilentRestsWhereTheToolIs) {
  OrdersRig rig;
  for (int i = 1; i <= 100; ++i) {
    rig.is_held_off = i > 50;
    rig.orders.order(orderTo({0.002 * i + 0.05, 0.0, 0.0}, 3, kStreamed));
    rig.run(0.01);
  }
  const Vector3 held = rig.seen.X_BaseTool.p_AB;
  ASSERT_LT(rig.seen.progress, 1.0) << "nothing holds it off";
  rig.run(0.2);
  EXPECT_EQ(rig.state(), ToolState::kLate);
  rig.is_held_off = false;
  rig.run(3.0);
  EXPECT_EQ(rig.place(), held);
}

/// What streams after another motion was given up has not pressed so far.
TEST(ToolOrdersHeld, AStreamBeginsAfterAnotherMotionWasGivenUp) {
  OrdersRig rig = heldOff();
  rig.run(3.0);
  ASSERT_EQ(rig.state(), ToolState::kGivenUp);
  rig.orders.order(orderTo({0.0, 0.1, 0.0}, 2, kStreamed));
  rig.step();
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  EXPECT_EQ(rig.orders.report().number, 2u);
}

/// A client sends waypoints one by one: those that come after the stop belong to what was stopped.
TEST(ToolOrdersHeld, WaypointsOfWhatWasStoppedAreForgottenToo) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.run(0.5);
  rig.seen.is_running = false;
  rig.step();
  rig.seen.is_running = true;
  rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, kNext));
  rig.run(3.0);
  EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kStopped, 0}));
  const Vector3 rest = rig.place();
  rig.orders.order(orderTo({0.0, 0.3, 0.0}, 2, kNext));
  rig.run(6.0);
  EXPECT_EQ(rig.orders.report(), (ToolReport{2, ToolState::kArrived, 0})) << "another's are not";
  EXPECT_NE(rig.place(), rest);
}

/// More than fit end in a hold, and so do the rest of the same.
TEST(ToolOrdersHeld, WhatFollowsARefusedOneIsRefused) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.run(0.5);
  for (std::size_t i = 0; i <= ToolOrders::kMaxWaiting; ++i)
    rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, kNext));
  rig.run(3.0);
  ASSERT_EQ(rig.state(), ToolState::kHolding);
  rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, kNext));
  rig.run(1.0);
  EXPECT_EQ(rig.state(), ToolState::kHolding);
}

/// There is the place and the orientation.
TEST(ToolOrdersHeld, OneThatLagsIsNotThere) {
  OrdersRig rig;
  rig.lag_rad = 2.0 * rig.config.arrival_rad;
  rig.orders.order(orderTo({0.1, 0.0, 0.0}, 1));
  rig.step();
  while (rig.seen.path_time_s < rig.motion.end_s() + 0.9) rig.step();
  EXPECT_EQ(rig.state(), ToolState::kMoving) << "it may yet come";
  rig.run(0.2);
  EXPECT_EQ(rig.state(), ToolState::kBlocked) << "its clock runs freely, and yet it does not come";
  rig.lag_rad = 0.5 * rig.config.arrival_rad;
  rig.step();
  EXPECT_EQ(rig.state(), ToolState::kArrived);
}

TEST(ToolOrdersHeld, OneThatStopsShortIsNotThere) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.1, 0.0, 0.0}, 1));
  rig.run(1.0);
  while (rig.place().x() < 0.1 - 2.0 * rig.config.arrival_m) rig.step();
  rig.is_held_off = true;  // by less than what its reference waits for
  rig.run(0.5);
  EXPECT_EQ(rig.seen.progress, 1.0);
  EXPECT_NE(rig.state(), ToolState::kArrived);
  rig.run(5.0);
  EXPECT_EQ(rig.state(), ToolState::kGivenUp);
}

/// A stream that was given up is over with a stop; one that begins after it is a new one.
TEST(ToolOrdersHeld, AStreamBeginsAnewAfterAStop) {
  OrdersRig rig;
  rig.is_held_off = true;
  for (int i = 0; i < 300 && rig.state() != ToolState::kGivenUp; ++i) {
    rig.orders.order(orderTo({0.3, 0, 0}, 1, kStreamed));
    rig.run(0.02);
  }
  ASSERT_EQ(rig.state(), ToolState::kGivenUp);
  rig.seen.is_running = false;
  rig.run(60.0);
  rig.seen.is_running = true;
  ++rig.seen.run;
  rig.is_held_off = false;
  rig.motion = ToolMotion(Pose{Matrix3::Identity(), Vector3::Zero()});
  for (int i = 0; i < 200; ++i) {
    ToolOrder order = orderTo({0.1, 0, 0}, 1, kStreamed);
    order.run = rig.seen.run;
    rig.orders.order(order);
    rig.run(0.02);
  }
  EXPECT_NEAR(rig.place().x(), 0.1, 1e-3);
}

}  // namespace
}  // namespace tactus
