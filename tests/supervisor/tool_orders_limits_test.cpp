#include <gtest/gtest.h>

#include "support/orders_rig.h"
#include "tactus/math/rotation.h"

/// Orders at the very limits of their times and distances: with a period whose sums have no
/// rounding, and a tool that is wherever the test says.
namespace tactus {
namespace {

using test::orderTo;

constexpr double kTick_s = 1.0 / 1024.0;
constexpr double kHeldOff = 0.49;  ///< of the reference's clock
constexpr auto kStreaming = ToolOrder::Kind::kStream;
constexpr auto kBehind = ToolOrder::Kind::kGoNext;

struct LimitsRig {
  void pass(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      seen.path_time_s += seen.progress * kTick_s;
      orders.update(seen, motion);
    }
  }
  void tell(const ToolOrder& order) {
    orders.order(order);
    pass(1);
  }
  /// Where the reference is at its end.
  void updateAt(double path_time_s) {
    seen.path_time_s = path_time_s;
    orders.update(seen, motion);
  }
  ToolState state() const { return orders.report().state; }
  Vector3 place() const { return motion.evaluate(seen.path_time_s).p_BaseTool; }

  TaskCommandsConfig config = [] {
    TaskCommandsConfig c;
    c.give_up_after_s = 1.0;
    c.stream_timeout_s = 0.125;
    return c;
  }();
  ToolOrders orders{config};
  ToolMotion motion{Pose{Matrix3::Identity(), Vector3::Zero()}};
  ToolWatch seen = [] {
    ToolWatch watch;
    watch.passed_s = kTick_s;
    watch.X_BaseTool = {Matrix3::Identity(), Vector3(0.01, 0.0, 0.0)};
    watch.is_running = true;
    return watch;
  }();
};

/// Those that were missed are of a stream's time.
TEST(ToolOrdersLimits, CountTimeAndNotCycles) {
  for (const int missed : {0, 1, 3}) {
    LimitsRig rig;
    rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
    rig.seen.passed_s = (1 + missed) * kTick_s;
    rig.pass(128 / (1 + missed));
    EXPECT_EQ(rig.state(), ToolState::kMoving) << missed;
    rig.pass(1);
    EXPECT_EQ(rig.state(), ToolState::kLate) << missed;
  }
}

TEST(ToolOrdersLimits, GiveUpAfterTheirTime) {
  LimitsRig rig;
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1));
  rig.seen.progress = kHeldOff;
  rig.pass(1000);
  EXPECT_EQ(rig.state(), ToolState::kBlocked);
  rig.seen.progress = 0.5;  // no longer held off
  rig.pass(1);
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  rig.seen.progress = kHeldOff;
  rig.pass(1024);
  EXPECT_EQ(rig.state(), ToolState::kBlocked) << "its time begins anew";
  const std::uint64_t number = rig.motion.plan().number;
  rig.pass(1);
  EXPECT_EQ(rig.state(), ToolState::kGivenUp);
  EXPECT_GT(rig.motion.plan().number, number);
  EXPECT_EQ(rig.place(), rig.seen.X_BaseTool.p_AB);
}

TEST(ToolOrdersLimits, ANewOrderHasATimeOfItsOwn) {
  LimitsRig rig;
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1));
  rig.seen.progress = kHeldOff;
  rig.pass(1000);
  rig.tell(orderTo({0.0, 0.3, 0.0}, 2));
  rig.pass(1024);
  EXPECT_EQ(rig.orders.report(), (ToolReport{2, ToolState::kBlocked, 0}));
  rig.pass(1);
  EXPECT_EQ(rig.state(), ToolState::kGivenUp);
}

/// A stream presses on; its targets are one order.
TEST(ToolOrdersLimits, AStreamHasOneTimeForAllItsTargets) {
  LimitsRig rig;
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
  rig.seen.progress = kHeldOff;
  int ticks = 0;
  for (; ticks < 3000 && rig.state() != ToolState::kGivenUp; ++ticks) {
    if (ticks % 100 == 99) rig.orders.order(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
    rig.pass(1);
  }
  EXPECT_EQ(ticks, 1025);
}

TEST(ToolOrdersLimits, AStreamIsLateAfterItsTime) {
  LimitsRig rig;
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
  rig.pass(128);
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  rig.pass(1);
  EXPECT_EQ(rig.state(), ToolState::kLate);
}

TEST(ToolOrdersLimits, AStreamThatWasGivenUpHasToBreakOffForAsLong) {
  LimitsRig rig;
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
  rig.seen.progress = kHeldOff;
  while (rig.state() != ToolState::kGivenUp) rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
  rig.pass(127);
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
  EXPECT_EQ(rig.state(), ToolState::kGivenUp);
  rig.pass(128);
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
  EXPECT_EQ(rig.state(), ToolState::kMoving);
}

/// To where the tool is, or across, leads not on.
TEST(ToolOrdersLimits, AStreamThatLeadsNotOnBeginsAtTheTool) {
  for (const Vector3& target : {Vector3(0.01, 0.0, 0.0), Vector3(0.01, 0.2, 0.0)}) {
    LimitsRig rig;
    for (int i = 0; i < 5; ++i) {
      rig.tell(orderTo({0.3, 0.0, 0.0}, 1, kStreaming));
      rig.pass(100);
    }
    ASSERT_GT(rig.place().x(), 0.011);
    rig.seen.progress = kHeldOff;
    const std::uint64_t number = rig.motion.plan().number;
    rig.tell(orderTo(target, 1, kStreaming));
    EXPECT_LT((rig.place() - rig.seen.X_BaseTool.p_AB).norm(), 1e-9);
    EXPECT_GT(rig.motion.plan().number, number);
  }
}

/// Wherever the tool is in its base frame.
TEST(ToolOrdersLimits, AStreamLeadsBackFromTheToolAndNotFromTheBase) {
  for (const Vector3& place : {Vector3(0, 0, 0), Vector3(0, 0, 1), Vector3(-1, 2, -0.5)}) {
    for (const bool leads_back : {false, true}) {
      LimitsRig rig;
      rig.motion = ToolMotion(Pose{Matrix3::Identity(), place});
      rig.seen.X_BaseTool = {Matrix3::Identity(), place};
      rig.tell(orderTo(place + Vector3(0.3, 0.0, 0.0), 1, kStreaming));
      rig.pass(100);
      ASSERT_GT(rig.place().x(), place.x());
      rig.seen.progress = kHeldOff;
      rig.pass(1);
      ASSERT_EQ(rig.state(), ToolState::kBlocked);
      const double x = leads_back ? -0.1 : 0.1;
      rig.tell(orderTo(place + Vector3(x, 0.0, -5.0 * x), 1, kStreaming));
      EXPECT_EQ((rig.place() - place).norm() < 1e-9, leads_back) << place;
      EXPECT_EQ(rig.place().x() > place.x() + 1e-6, !leads_back) << place;
      EXPECT_EQ(rig.state(), leads_back ? ToolState::kMoving : ToolState::kBlocked);
    }
  }
}

/// What it leads elsewhere in position is no way back for a turn that is held off.
TEST(ToolOrdersLimits, AStreamLeadsBackATurnThatIsHeldOff) {
  for (const double turn_rad : {-0.3, 0.3}) {
    LimitsRig rig;
    const auto turned = [&](double angle_rad, double x) {
      ToolOrder order = orderTo({x, 0.0, 0.0}, 1, kStreaming);
      const Matrix3 R = rotationMatrix(Vector3(0.0, 0.0, angle_rad));
      std::copy_n(R.data(), 9, order.R_BaseTool);
      return order;
    };
    rig.tell(turned(0.4, 0.0));
    rig.pass(100);
    rig.seen.progress = kHeldOff;
    rig.seen.turn_waited_for_rad = Vector3(0.0, 0.0, 0.1);
    rig.pass(1);
    const Matrix3 ahead = rig.motion.evaluate(rig.seen.path_time_s).R_BaseTool;
    ASSERT_GT(rotationVector(ahead).z(), 1e-4);
    rig.tell(turned(turn_rad, -0.1));
    const Matrix3 begins = rig.motion.evaluate(rig.seen.path_time_s).R_BaseTool;
    EXPECT_EQ(rotationVector(begins).norm() < 1e-9, turn_rad < 0.0);
    EXPECT_EQ(rig.state(), turn_rad < 0.0 ? ToolState::kMoving : ToolState::kBlocked);
  }
}

/// Whose clock runs freely is not held off, but for rounding.
TEST(ToolOrdersLimits, AFreeToolGoesOnFromItsReference) {
  LimitsRig rig;
  rig.tell(orderTo({0.3, 0.0, 0.0}, 1));
  rig.pass(400);
  rig.seen.progress = kFreeProgress;
  const double x = rig.place().x();
  ASSERT_GT(x, 0.011);
  rig.tell(orderTo({0.0, 0.3, 0.0}, 2));
  EXPECT_GT(rig.place().x(), x);
  rig.tell(orderTo({0.3, 0.3, 0.0}, 3, kStreaming));
  rig.pass(129);
  ASSERT_EQ(rig.state(), ToolState::kLate);
  EXPECT_GT(rig.place().x(), x) << "it stops on its way, and not where the tool is";
}

TEST(ToolOrdersLimits, ThereIsNoFurtherThanTheirDistances) {
  LimitsRig rig;
  rig.tell(orderTo({0.1, 0.0, 0.0}, 1));
  const double end_s = rig.motion.end_s();
  rig.seen.lag_m = rig.config.arrival_m;
  rig.seen.lag_rad = rig.config.arrival_rad * 1.001;
  rig.updateAt(end_s);
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  rig.seen.lag_m = rig.config.arrival_m * 1.001;
  rig.seen.lag_rad = rig.config.arrival_rad;
  rig.updateAt(end_s);
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  rig.updateAt(end_s + 1.0);
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  rig.updateAt(end_s + 1.001);
  EXPECT_EQ(rig.state(), ToolState::kBlocked) << "it should be there";
  rig.seen.lag_m = rig.config.arrival_m;
  rig.updateAt(end_s - kTick_s);
  EXPECT_EQ(rig.state(), ToolState::kMoving) << "its reference is not there yet";
  rig.updateAt(end_s);
  EXPECT_EQ(rig.state(), ToolState::kArrived);
}

/// The next begins as soon as one has arrived, or its pause is over.
TEST(ToolOrdersLimits, BeginTheNextAtOnce) {
  for (const double pause_s : {0.0, 0.125}) {
    LimitsRig rig;
    ToolOrder first = orderTo({0.1, 0.0, 0.0}, 1);
    first.pause_s = pause_s;
    rig.orders.order(first);
    rig.orders.order(orderTo({0.2, 0.0, 0.0}, 1, kBehind));
    rig.orders.order(orderTo({0.2, 0.2, 0.0}, 1, kBehind));
    rig.pass(1);
    EXPECT_EQ(rig.orders.report().waiting, 2);
    rig.updateAt(rig.motion.end_s());
    if (pause_s > 0.0) {
      EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kArrived, 2}));
      rig.seen.progress = 0.0;
      rig.pass(127);
      EXPECT_EQ(rig.state(), ToolState::kArrived);
      rig.pass(1);
      rig.seen.progress = 1.0;
    }
    EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kMoving, 1}));
    rig.updateAt(rig.motion.end_s() - kTick_s);
    EXPECT_EQ(rig.orders.report().waiting, 1) << "the last waits for the one before it";
    rig.updateAt(rig.motion.end_s());
    EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kMoving, 0}));
    rig.updateAt(rig.motion.end_s());
    EXPECT_EQ(rig.state(), ToolState::kArrived);
    EXPECT_LT((rig.place() - Vector3(0.2, 0.2, 0.0)).norm(), 1e-12);
  }
}

/// A stop forgets what was told, and tells of the last of it however long it lasts.
TEST(ToolOrdersLimits, AStopTellsOfWhatItForgot) {
  LimitsRig rig;
  rig.seen.is_running = false;
  rig.pass(3);
  EXPECT_EQ(rig.orders.report(), (ToolReport{0, ToolState::kHolding, 0})) << "nothing was told";
  rig.orders.order(orderTo({0.1, 0.0, 0.0}, 1));
  rig.pass(3);
  EXPECT_EQ(rig.orders.report(), (ToolReport{1, ToolState::kStopped, 0}));
  rig.seen.is_running = true;
  rig.tell(orderTo({0.1, 0.0, 0.0}, 2));
  rig.updateAt(rig.motion.end_s());
  EXPECT_EQ(rig.orders.report(), (ToolReport{2, ToolState::kArrived, 0}));
  rig.seen.is_running = false;
  rig.pass(3);
  EXPECT_EQ(rig.orders.report(), (ToolReport{2, ToolState::kArrived, 0})) << "it was there";
  rig.orders.order(orderTo({0.3, 0.0, 0.0}, 3));
  rig.orders.order(orderTo({0.3, 0.3, 0.0}, 4));
  rig.pass(3);
  EXPECT_EQ(rig.orders.report(), (ToolReport{4, ToolState::kStopped, 0}));
}

/// After a stop it is another run; orders of it are obeyed.
TEST(ToolOrdersLimits, OfThisRunAreObeyed) {
  LimitsRig rig;
  rig.seen.run = 2;
  ToolOrder order = orderTo({0.1, 0.0, 0.0}, 1);
  order.run = 2;
  rig.tell(order);
  rig.pass(100);
  EXPECT_EQ(rig.state(), ToolState::kMoving);
  rig.updateAt(rig.motion.end_s());
  EXPECT_EQ(rig.state(), ToolState::kArrived);
}

/// What is told after it begins at once, whatever pause was under way.
TEST(ToolOrdersLimits, AStopEndsAPause) {
  for (const double pause_s : {0.0, 10.0}) {
    LimitsRig rig;
    ToolOrder first = orderTo({0.1, 0.0, 0.0}, 1);
    first.pause_s = pause_s;
    rig.tell(first);
    rig.updateAt(rig.motion.end_s());
    ASSERT_EQ(rig.state(), ToolState::kArrived);
    rig.seen.is_running = false;
    rig.pass(3);
    rig.seen.is_running = true;
    rig.tell(orderTo({0.1, 0.1, 0.0}, 2, kBehind));
    EXPECT_EQ(rig.orders.report(), (ToolReport{2, ToolState::kMoving, 0})) << pause_s;
  }
}

/// A hold of a tool that is held off is another plan, which the log has to know.
TEST(ToolOrdersLimits, AHoldIsANewPlan) {
  for (const double progress : {1.0, kHeldOff}) {
    LimitsRig rig;
    rig.tell(orderTo({0.3, 0.0, 0.0}, 1));
    rig.pass(300);
    rig.seen.progress = progress;
    const std::uint64_t number = rig.motion.plan().number;
    ToolOrder hold;
    hold.number = 2;
    rig.tell(hold);
    EXPECT_GT(rig.motion.plan().number, number);
    EXPECT_EQ(rig.state(), ToolState::kHolding);
  }
}

}  // namespace
}  // namespace tactus
