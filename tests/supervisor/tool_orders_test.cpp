#include "tactus/supervisor/tool_orders.h"

#include <gtest/gtest.h>

#include "support/orders_rig.h"

namespace tactus {
namespace {

using test::OrdersRig;
using test::orderTo;

TEST(ToolOrders, HoldUntilTheyAreTold) {
  OrdersRig rig;
  rig.run(1.0);
  EXPECT_EQ(rig.state(), ToolState::kHolding);
  EXPECT_EQ(rig.place(), Vector3(Vector3::Zero()));
}

TEST(ToolOrders, LeadToATargetAndSaySo) {
  OrdersRig rig;
  const Vector3 target(0.1, -0.05, 0.02);
  rig.orders.order(orderTo(target, 7));
  rig.step();
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  EXPECT_EQ(rig.orders.report().number, 7u);
  rig.run(5.0);
  EXPECT_EQ(rig.state(), ToolState::kArrived);
  EXPECT_EQ(rig.place(), target);
}

TEST(ToolOrders, GoFromWaypointToWaypointWithTheirPauses) {
  OrdersRig rig;
  ToolOrder first = orderTo({0.1, 0.0, 0.0}, 1);
  first.pause_s = 1.0;
  rig.orders.order(first);
  for (int i = 0; i < 3; ++i)
    rig.orders.order(orderTo({0.1, 0.1 * (i + 1), 0.0}, 1, ToolOrder::Kind::kGoNext));
  rig.step();
  EXPECT_EQ(rig.orders.report().waiting, 3);
  while (rig.state() != ToolState::kArrived) rig.step();
  rig.run(0.95);
  EXPECT_EQ(rig.state(), ToolState::kArrived);
  EXPECT_EQ(rig.place(), Vector3(0.1, 0.0, 0.0));
  rig.run(0.1);
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  rig.run(10.0);
  EXPECT_EQ(rig.place(), Vector3(0.1, 0.1 * 3, 0.0));
  EXPECT_EQ(rig.orders.report().waiting, 0);
}

/// Also in the very cycle in which the one before is given up, whenever that is.
TEST(ToolOrders, ANewOneIsNotGivenUpWithTheOneBefore) {
  for (int cycle = 1900; cycle < 2200; ++cycle) {
    OrdersRig rig;
    rig.orders.order(orderTo({0.5, 0.0, 0.0}, 1));
    rig.run(0.5);
    rig.is_held_off = true;
    for (int i = 0; i < cycle; ++i) rig.step();
    rig.orders.order(orderTo({0.0, 0.2, 0.0}, 2));
    rig.step();
    EXPECT_EQ(rig.orders.report().number, 2u) << cycle;
    EXPECT_EQ(rig.state(), ToolState::kMoving) << cycle;
  }
}

TEST(ToolOrders, ANewOneTakesThePlaceOfAll) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, ToolOrder::Kind::kGoNext));
  rig.run(0.5);
  rig.orders.order(orderTo({0.0, 0.0, 0.2}, 2));
  rig.run(6.0);
  EXPECT_EQ(rig.place(), Vector3(0.0, 0.0, 0.2));
  EXPECT_EQ(rig.orders.report(), (ToolReport{2, ToolState::kArrived, 0}));
}

TEST(ToolOrders, HoldStopsWithinTheLimitsAndForgets) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, ToolOrder::Kind::kGoNext));
  rig.run(1.0);
  const double x = rig.place().x();
  ToolOrder hold;
  hold.number = 2;
  rig.orders.order(hold);
  rig.run(5.0);
  EXPECT_EQ(rig.state(), ToolState::kHolding);
  EXPECT_NEAR(rig.place().x(), x + 0.1 * 0.3 / 2.0, 1e-3);  // from 0.1 m/s, in 0.3 s
  EXPECT_EQ(rig.motion.evaluate(rig.seen.path_time_s).v_BaseTool, Vector3(Vector3::Zero()));
}

TEST(ToolOrders, GiveUpWhereTheToolIsHeldOff) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, ToolOrder::Kind::kGoNext));
  rig.run(1.0);
  rig.is_held_off = true;
  const Vector3 held = rig.seen.X_BaseTool.p_AB;
  rig.run(1.0);
  EXPECT_EQ(rig.state(), ToolState::kBlocked);
  EXPECT_GT((rig.place() - held).norm(), 0.01) << "the reference waits in front of the tool";
  rig.run(2.0);
  EXPECT_EQ(rig.state(), ToolState::kGivenUp);
  EXPECT_EQ(rig.place(), held);
  EXPECT_EQ(rig.orders.report().waiting, 0);
  rig.is_held_off = false;
  rig.run(1.0);
  EXPECT_EQ(rig.place(), held) << "what was given up is forgotten";
}

TEST(ToolOrders, LeadAwayFromWhatHoldsTheToolOff) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.run(1.0);
  rig.is_held_off = true;
  rig.run(1.0);
  rig.orders.order(orderTo({0.0, 0.0, 0.0}, 2));
  rig.step();
  EXPECT_EQ(rig.place(), rig.seen.X_BaseTool.p_AB) << "from the tool, not from what it waited for";
  rig.is_held_off = false;
  rig.run(3.0);
  EXPECT_EQ(rig.state(), ToolState::kArrived);
}

TEST(ToolOrders, BlockedGoesOnOnceTheWayIsFree) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.run(1.0);
  rig.is_held_off = true;
  rig.run(1.0);
  rig.is_held_off = false;
  rig.run(5.0);
  EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kArrived, 0}));
}

TEST(ToolOrders, AStreamThatFallsSilentStops) {
  OrdersRig rig;
  for (int i = 1; i <= 100; ++i) {
    rig.orders.order(orderTo({0.005 * i, 0.0, 0.0}, 3, ToolOrder::Kind::kStream));
    rig.run(0.01);
  }
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  const double x = rig.place().x();
  rig.run(0.2);
  EXPECT_EQ(rig.state(), ToolState::kLate);
  rig.run(2.0);
  EXPECT_EQ(rig.motion.evaluate(rig.seen.path_time_s).v_BaseTool, Vector3(Vector3::Zero()));
  EXPECT_LT(rig.place().x(), x + 0.03);
}

/// Targets that lead on and on do not make the reference jump, and the arm does not chase them.
TEST(ToolOrders, AStreamIsHeldOffAndGivesUp) {
  OrdersRig rig;
  const auto stream = [&](double x) {
    rig.orders.order(orderTo({x, 0.0, 0.0}, 3, ToolOrder::Kind::kStream));
    rig.run(0.01);
  };
  for (int i = 1; i <= 100; ++i) stream(0.002 * i + 0.05);
  rig.is_held_off = true;
  const double held = rig.seen.X_BaseTool.p_AB.x();
  for (int i = 0; i < 50; ++i) stream(0.3 + 0.002 * i);
  EXPECT_EQ(rig.state(), ToolState::kBlocked);
  const double waits = rig.place().x();
  for (int i = 0; i < 50; ++i) stream(0.4 + 0.002 * i);
  EXPECT_EQ(rig.state(), ToolState::kBlocked);
  EXPECT_NEAR(rig.place().x(), waits, 1e-3);
  stream(held - 0.1);
  EXPECT_LT(rig.place().x(), held + 1e-3) << "back is free at once";
  for (int i = 0; i < 300 && rig.state() != ToolState::kGivenUp; ++i) stream(0.5);
  EXPECT_EQ(rig.state(), ToolState::kGivenUp);
  for (int i = 0; i < 300; ++i) stream(0.5);
  EXPECT_EQ(rig.state(), ToolState::kGivenUp) << "it presses again";
  rig.run(0.2);
  stream(0.5);
  EXPECT_EQ(rig.state(), ToolState::kMoving) << "a stream that broke off begins anew";
}

TEST(ToolOrders, AStopForgetsAll) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, ToolOrder::Kind::kGoNext));
  rig.run(1.0);
  rig.seen.is_running = false;
  rig.step();
  EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kStopped, 0}));
  rig.orders.order(orderTo({0.1, 0.0, 0.0}, 2));  // comes while the arm does not run
  rig.step();
  EXPECT_EQ(rig.orders.report(), (ToolReport{2, ToolState::kStopped, 0}));
  rig.seen.is_running = true;
  const std::uint64_t number = rig.motion.plan().number;
  rig.run(1.0);
  EXPECT_EQ(rig.motion.plan().number, number);
}

TEST(ToolOrders, MoreThanFitEndInAHold) {
  OrdersRig rig;
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1));
  rig.run(1.0);
  const double x = rig.place().x();
  for (std::size_t i = 0; i <= ToolOrders::kMaxWaiting + 5; ++i)
    rig.orders.order(orderTo({0.0, 0.3, 0.0}, 1, ToolOrder::Kind::kGoNext));
  rig.run(3.0);
  EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kHolding, 0}));
  EXPECT_LT(rig.place().x(), x + 0.05);
}

/// As of a client whose order was checked while the arm stopped and went on.
TEST(ToolOrders, ThatWereGivenBeforeAStopAreForgotten) {
  OrdersRig rig;
  rig.seen.run = 2;
  ToolOrder late = orderTo({0.3, 0.0, 0.0}, 1);
  late.run = 1;
  rig.orders.order(late);
  rig.run(1.0);
  EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kStopped, 0}));
  EXPECT_EQ(rig.place(), Vector3(Vector3::Zero()));
}

}  // namespace
}  // namespace tactus
