#include "tactus/io/bus_monitor.h"

#include <errno.h>
#include <gtest/gtest.h>
#include <linux/can/error.h>

#include <array>
#include <deque>
#include <random>
#include <vector>

#include "support/allocation_guard.h"
#include "tactus/canopen/can_robot.h"

namespace tactus {
namespace {

CanFrame errorFrame(std::uint32_t error_class, std::uint8_t controller = 0,
                    std::uint8_t location = 0) {
  CanFrame frame;
  frame.id = error_class;
  frame.kind = FrameKind::kError;
  frame.size = 8;
  frame.data[1] = controller;
  frame.data[3] = location;
  return frame;
}

const CanFrame kPassive = errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_PASSIVE);
const CanFrame kNoAcknowledge = errorFrame(CAN_ERR_ACK);
const CanFrame kBusOffFrame = errorFrame(CAN_ERR_BUSOFF);

/// A cycle of a bus that works: what was sent is confirmed, then four frames are sent.
void workingCycle(BusMonitor& monitor) {
  monitor.onConfirmed(4);
  monitor.onReceived(3, false);
  monitor.update();
  if (monitor.maySend()) monitor.onSent(4, 4);
}

/// Cycles without a confirmation in which the caller sends what it may.
void deadCycles(BusMonitor& monitor, int count) {
  for (int i = 0; i < count; ++i) {
    monitor.onReceived(0, false);
    monitor.update();
    if (monitor.maySend()) monitor.onSent(4, 4);
    if (monitor.mayProbe()) monitor.onSent(1, 1);
  }
}

/// Quiet cycles up to the one in which a probe may go.
void cyclesToProbe(BusMonitor& monitor) {
  for (int i = 0; i <= BusMonitor::kProbeCycles && !monitor.mayProbe(); ++i) monitor.update();
  ASSERT_TRUE(monitor.mayProbe());
}

TEST(BusMonitor, LetsFramesGoOnABusThatConfirmsThem) {
  BusMonitor monitor;
  for (int i = 0; i < 1000; ++i) workingCycle(monitor);
  EXPECT_EQ(monitor.fault(), Fault::kNone);
  EXPECT_EQ(monitor.counters().sent, 4000u);
  EXPECT_EQ(monitor.counters().received, 3000u);
  EXPECT_EQ(monitor.counters().held_back, 0u);
}

/// Twelve days of a full bus.
TEST(BusMonitor, CountsMoreFramesThan32BitsHold) {
  BusMonitor monitor;
  constexpr int kFrames = 1'500'000'000;
  for (int i = 0; i < 4; ++i) {
    monitor.onSent(kFrames, kFrames);
    monitor.onConfirmed(kFrames);
    monitor.onReceived(kFrames, false);
    monitor.update();
  }
  EXPECT_EQ(monitor.counters().sent, 6'000'000'000u);
  EXPECT_EQ(monitor.counters().received, 6'000'000'000u);
}

TEST(BusMonitor, HoldsFramesBackWhileSomeAreUnconfirmedAndTakesAPassingStallForNoFault) {
  for (int stall = 1; stall <= BusMonitor::kMaxUnconfirmedCycles; ++stall) {
    BusMonitor monitor;
    workingCycle(monitor);
    monitor.onConfirmed(3);  // one is missing
    for (int i = 0; i < stall; ++i) {
      monitor.update();
      EXPECT_FALSE(monitor.maySend());
      EXPECT_FALSE(monitor.mayProbe());
      EXPECT_EQ(monitor.fault(), Fault::kNone);
    }
    EXPECT_EQ(monitor.counters().held_back, static_cast<std::uint32_t>(stall));
    workingCycle(monitor);
    EXPECT_TRUE(monitor.counters().sent == 8u) << "sends again at once";
    for (int i = 0; i < 10; ++i) workingCycle(monitor);
    EXPECT_EQ(monitor.fault(), Fault::kNone);
  }
}

TEST(BusMonitor, TakesABusForStalledThatConfirmsNothingForMoreThanThreeCycles) {
  BusMonitor monitor;
  workingCycle(monitor);
  deadCycles(monitor, BusMonitor::kMaxUnconfirmedCycles);
  EXPECT_EQ(monitor.fault(), Fault::kNone);
  deadCycles(monitor, 1);
  EXPECT_EQ(monitor.fault(), Fault::kBusStalled);
}

/// A cable that is not there at the start: the controller may have become passive long before, and
/// tells of no change.
TEST(BusMonitor, TakesABusThatHasNeverGivenASignOfLifeForUnacknowledged) {
  BusMonitor monitor;
  deadCycles(monitor, BusMonitor::kMaxUnconfirmedCycles + 1);
  EXPECT_EQ(monitor.fault(), Fault::kNone);
  deadCycles(monitor, 1);
  EXPECT_EQ(monitor.fault(), Fault::kBusUnacknowledged);
  monitor.onConfirmed(4);
  for (int i = 0; i <= BusMonitor::kCalmCycles; ++i) monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kNone) << "plugged in";
  deadCycles(monitor, BusMonitor::kMaxUnconfirmedCycles + 2);
  EXPECT_EQ(monitor.fault(), Fault::kBusStalled);
}

TEST(BusMonitor, TakesABusWhoseNodesAreHeardForStalled) {
  for (const bool is_foreign : {false, true}) {
    BusMonitor monitor;
    if (is_foreign)
      monitor.onForeignFrame();
    else
      monitor.onReceived(1, false);
    deadCycles(monitor, BusMonitor::kMaxUnconfirmedCycles + 2);
    EXPECT_EQ(monitor.fault(), Fault::kBusStalled);
  }
}

TEST(BusMonitor, TakesABusForStalledWhoseKernelQueueStaysFull) {
  BusMonitor monitor;
  for (int i = 0; i <= BusMonitor::kMaxUnconfirmedCycles; ++i) {
    monitor.update();
    ASSERT_TRUE(monitor.maySend()) << "nothing of ours is in the kernel, newer frames may do";
    monitor.onSendError(ENOBUFS);
    monitor.onSent(0, 4);
  }
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kBusStalled);
  EXPECT_EQ(monitor.counters().refused, 16u);
  EXPECT_EQ(monitor.counters().sent, 0u);
}

TEST(BusMonitor, WaitsOnlyForTheFramesThatTheKernelAccepted) {
  BusMonitor monitor;
  monitor.update();
  monitor.onSent(2, 4);
  EXPECT_EQ(monitor.counters().refused, 2u);
  monitor.onConfirmed(2);
  monitor.update();
  EXPECT_TRUE(monitor.maySend());
  EXPECT_EQ(monitor.fault(), Fault::kNone);
}

/// Each trouble, told as the kernel tells it, and its name in the very cycle.
TEST(BusMonitor, NamesEachTroubleInItsCycle) {
  const struct {
    std::vector<CanFrame> errors;
    int receive_error, send_error;
    Fault fault;
  } kRows[] = {
      {{kPassive, kNoAcknowledge}, 0, 0, Fault::kBusUnacknowledged},
      {{kNoAcknowledge, kPassive}, 0, 0, Fault::kBusUnacknowledged},
      {{errorFrame(CAN_ERR_ACK | CAN_ERR_CRTL, CAN_ERR_CRTL_RX_PASSIVE)},
       0,
       0,
       Fault::kBusUnacknowledged},
      {{kPassive, errorFrame(CAN_ERR_PROT, 0, CAN_ERR_PROT_LOC_ACK)},
       0,
       0,
       Fault::kBusUnacknowledged},
      {{kBusOffFrame}, 0, 0, Fault::kBusOff},
      {{errorFrame(CAN_ERR_RESTARTED)}, 0, 0, Fault::kBusOff},
      {{kPassive, kNoAcknowledge, kBusOffFrame}, 0, 0, Fault::kBusOff},
      {{kBusOffFrame}, ENETDOWN, 0, Fault::kBusDown},
      {{}, ENETDOWN, 0, Fault::kBusDown},
      {{}, ENODEV, 0, Fault::kBusDown},
      {{}, 0, ENETDOWN, Fault::kBusDown},
      {{}, 0, ENXIO, Fault::kBusDown},
      // no trouble that stops a bus
      {{}, EAGAIN, EAGAIN, Fault::kNone},
      {{kPassive}, 0, 0, Fault::kNone},
      {{kNoAcknowledge}, 0, 0, Fault::kNone},
      {{kPassive, errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_TX_WARNING), kNoAcknowledge},
       0,
       0,
       Fault::kNone},
      {{kPassive, errorFrame(CAN_ERR_CRTL, CAN_ERR_CRTL_ACTIVE), kNoAcknowledge},
       0,
       0,
       Fault::kNone},
      {{errorFrame(CAN_ERR_LOSTARB | CAN_ERR_PROT | CAN_ERR_BUSERROR, CAN_ERR_CRTL_TX_PASSIVE,
                   CAN_ERR_PROT_LOC_DATA),
        kNoAcknowledge},
       0,
       0,
       Fault::kNone},
  };
  for (std::size_t row = 0; row < std::size(kRows); ++row) {
    SCOPED_TRACE(row);
    BusMonitor monitor;
    workingCycle(monitor);
    monitor.onConfirmed(4);
    for (const CanFrame& error : kRows[row].errors) monitor.onErrorFrame(error);
    if (kRows[row].receive_error != 0) monitor.onReceiveError(kRows[row].receive_error);
    if (kRows[row].send_error != 0) monitor.onSendError(kRows[row].send_error);
    monitor.update();
    EXPECT_EQ(monitor.fault(), kRows[row].fault);
    EXPECT_EQ(monitor.maySend(), kRows[row].fault == Fault::kNone);
    EXPECT_EQ(monitor.counters().error_frames, kRows[row].errors.size());
  }
}

TEST(BusMonitor, TakesAPassiveBusForUnacknowledgedWithoutWaitingForThreeCycles) {
  BusMonitor monitor;
  workingCycle(monitor);
  monitor.onErrorFrame(kPassive);
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kBusUnacknowledged);
}

TEST(BusMonitor, AGraverTroubleTakesTheNameAndAMilderOneDoesNot) {
  BusMonitor monitor;
  workingCycle(monitor);
  deadCycles(monitor, 4);
  ASSERT_EQ(monitor.fault(), Fault::kBusStalled);
  monitor.onErrorFrame(kBusOffFrame);
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kBusOff);
  monitor.onErrorFrame(kPassive);
  monitor.onErrorFrame(kNoAcknowledge);
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kBusOff);
  monitor.onSendError(ENETDOWN);
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kBusDown);
}

TEST(BusMonitor, ProbesADeadBusAsRarelyAsItIsToldAndNothingElse) {
  for (const int probe_cycles : {BusMonitor::kProbeCycles, 351}) {
    BusMonitor monitor(probe_cycles);
    monitor.update();
    monitor.onErrorFrame(kBusOffFrame);
    int probes = 0;
    for (int cycle = 0; cycle < 10 * probe_cycles + 1; ++cycle) {
      monitor.update();
      EXPECT_FALSE(monitor.maySend());
      if (!monitor.mayProbe()) continue;
      EXPECT_EQ(cycle % probe_cycles, 0);
      ++probes;
      monitor.onSendError(ENOBUFS);
      monitor.onSent(0, 1);
    }
    EXPECT_EQ(probes, 10);
    EXPECT_EQ(monitor.fault(), Fault::kBusOff);
  }
}

/// Drives that watch the daemon's heartbeat alone have to stop where they are not heard.
TEST(BusMonitor, ProbesMoreRarelyThanDrivesWaitForAHeartbeat) {
  for (const double timeout_s : {0.01, 0.06, 0.0999, 0.1, 0.2, 3.0, 65.0}) {
    for (const double period_s : {0.0005, 0.001, 0.002}) {
      CanopenConfig canopen;
      canopen.heartbeat_timeout_s = timeout_s;
      const int cycles = probeCycles(canopen, period_s);
      EXPECT_GT(cycles * period_s, 1.4 * timeout_s);
      EXPECT_GE(cycles, BusMonitor::kProbeCycles);
    }
  }
  EXPECT_EQ(probeCycles({}, 0.001), BusMonitor::kProbeCycles) << "as shipped";
}

TEST(BusMonitor, RearmsOnceAProbeIsConfirmedAndCalmHasLasted) {
  BusMonitor monitor;
  monitor.onErrorFrame(kBusOffFrame);
  monitor.update();
  cyclesToProbe(monitor);
  monitor.onSent(1, 1);
  EXPECT_FALSE(monitor.mayProbe());
  for (int i = 0; i < 50; ++i) monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kBusOff) << "calm alone is no answer";
  monitor.onConfirmed(1);
  for (int i = 0; i < BusMonitor::kCalmCycles; ++i) {
    monitor.update();
    EXPECT_EQ(monitor.fault(), Fault::kBusOff);
  }
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kNone);
  EXPECT_TRUE(monitor.maySend());
}

/// Frames that the kernel dropped need no confirmation: the first probe does.
TEST(BusMonitor, AFirstProbeIsEnoughAfterTroublesThatEmptyTheKernel) {
  for (const bool is_down : {false, true}) {
    BusMonitor monitor;
    workingCycle(monitor);
    if (is_down)
      monitor.onReceiveError(ENETDOWN);
    else
      monitor.onErrorFrame(kBusOffFrame);
    monitor.update();
    cyclesToProbe(monitor);
    monitor.onSent(1, 1);
    monitor.onConfirmed(1);
    for (int i = 0; i <= BusMonitor::kCalmCycles; ++i) monitor.update();
    EXPECT_EQ(monitor.fault(), Fault::kNone);
  }
}

TEST(BusMonitor, AConfirmationRefutesAMissingAcknowledgement) {
  BusMonitor monitor;
  workingCycle(monitor);
  monitor.onErrorFrame(kNoAcknowledge);
  monitor.onConfirmed(4);
  monitor.onErrorFrame(kPassive);
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kNone);
}

TEST(BusMonitor, ForgetsAfterTheRearmThatTheBusWasPassive) {
  BusMonitor monitor;
  workingCycle(monitor);
  monitor.onErrorFrame(kPassive);
  monitor.update();
  ASSERT_EQ(monitor.fault(), Fault::kBusUnacknowledged);
  monitor.onConfirmed(4);
  for (int i = 0; i <= BusMonitor::kCalmCycles; ++i) monitor.update();
  ASSERT_EQ(monitor.fault(), Fault::kNone);
  monitor.onSent(4, 4);
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kNone) << "a passing stall like any other";
}

/// Not every driver tells that its controller is active again, which after this it has to be.
TEST(BusMonitor, ForgetsAfter128ConfirmedFramesThatTheControllerWasPassive) {
  for (const int confirmed : {127, 128}) {
    BusMonitor monitor;
    monitor.onErrorFrame(kPassive);
    for (int i = 0; i < confirmed; ++i) {
      monitor.onSent(1, 1);
      monitor.onConfirmed(1);
      monitor.update();
      ASSERT_EQ(monitor.fault(), Fault::kNone);
    }
    monitor.onSent(4, 4);
    monitor.update();
    EXPECT_EQ(monitor.fault(), confirmed < 128 ? Fault::kBusUnacknowledged : Fault::kNone);
    if (confirmed < 128) continue;
    monitor.onErrorFrame(kPassive);
    monitor.update();
    EXPECT_EQ(monitor.fault(), Fault::kBusUnacknowledged) << "passive anew";
  }
}

/// Each raises the counter that has to fall.
TEST(BusMonitor, RemembersThatTheControllerWasPassiveWhileErrorsGoOn) {
  BusMonitor monitor;
  monitor.onErrorFrame(kPassive);
  for (int i = 0; i < 200; ++i) {
    if (i == 100) monitor.onErrorFrame(errorFrame(CAN_ERR_PROT));
    monitor.onSent(1, 1);
    monitor.onConfirmed(1);
    monitor.update();
  }
  monitor.onSent(4, 4);
  monitor.update();
  EXPECT_EQ(monitor.fault(), Fault::kBusUnacknowledged);
}

TEST(BusMonitor, AnErrorAfterTheAnswerTakesItBack) {
  BusMonitor monitor;
  monitor.onErrorFrame(kPassive);
  monitor.onErrorFrame(kNoAcknowledge);
  monitor.update();
  cyclesToProbe(monitor);
  monitor.onSent(1, 1);
  monitor.onConfirmed(1);  // as on vcan, where an echo proves nothing
  for (int i = 0; i < BusMonitor::kCalmCycles - 1; ++i) monitor.update();
  monitor.onErrorFrame(kNoAcknowledge);
  for (int i = 0; i < BusMonitor::kProbeCycles; ++i) {
    monitor.update();
    EXPECT_EQ(monitor.fault(), Fault::kBusUnacknowledged);
  }
}

TEST(BusMonitor, TakesThreeFullBatchesInARowForAFloodInWhichItStillSends) {
  BusMonitor monitor;
  for (int i = 0; i < BusMonitor::kMaxFullBatches - 1; ++i) {
    monitor.onReceived(64, true);
    monitor.update();
    EXPECT_EQ(monitor.fault(), Fault::kNone) << "the backlog of a late cycle";
  }
  monitor.onReceived(10, false);
  monitor.update();
  for (int i = 0; i < BusMonitor::kMaxFullBatches; ++i) {
    monitor.onReceived(64, true);
    monitor.update();
  }
  EXPECT_EQ(monitor.fault(), Fault::kBusFlooded);
  EXPECT_TRUE(monitor.maySend()) << "to stop the drives";
  monitor.onSent(4, 4);
  for (int i = 0; i < BusMonitor::kCalmCycles; ++i) {
    EXPECT_EQ(monitor.fault(), Fault::kBusFlooded);
    workingCycle(monitor);
  }
  EXPECT_EQ(monitor.fault(), Fault::kNone);
}

TEST(BusMonitor, AFloodedBusThatStopsConfirmingIsStalled) {
  BusMonitor monitor;
  workingCycle(monitor);
  for (int i = 0; i < 5; ++i) {
    monitor.onReceived(64, true);
    monitor.update();
  }
  EXPECT_EQ(monitor.fault(), Fault::kBusStalled);
  EXPECT_FALSE(monitor.maySend());
}

/// A kernel and its controller, first in first out: delivers and confirms while the bus lives,
/// keeps frames while it is dead, may lose them without a word.
class ModelBus {
 public:
  struct Item {
    int cycle;
    bool is_setpoint;
  };

  std::deque<Item> queue;
  int stale_delivered = 0;  ///< set-points older than a passing stall

  void deliver(int cycle, BusMonitor& monitor) {
    for (; !queue.empty(); queue.pop_front()) {
      const int age = cycle - queue.front().cycle;
      if (queue.front().is_setpoint && age > BusMonitor::kMaxUnconfirmedCycles + 1)
        ++stale_delivered;
      monitor.onConfirmed(1);
    }
  }

  void offer(int cycle, int count, bool are_setpoints, BusMonitor& monitor) {
    int accepted = 0;
    for (; accepted < count && queue.size() < 10; ++accepted)
      queue.push_back({cycle, are_setpoints});
    if (accepted == 0) monitor.onSendError(ENOBUFS);
    monitor.onSent(accepted, count);
  }

  void expectOneCycleOfSetpoints() const {
    int first = -1;
    for (const Item& item : queue) {
      if (!item.is_setpoint) continue;
      if (first < 0) first = item.cycle;
      ASSERT_EQ(item.cycle, first);
    }
  }
};

/// Outages of random length and silence: never more than a cycle's set-points in the kernel, never
/// any handed over while the bus is taken for dead, and the bus comes back.
TEST(BusMonitor, NeverLetsSetpointsPileUpAndComesBackAfterEveryOutage) {
  std::mt19937 random(7);
  for (int run = 0; run < 300; ++run) {
    SCOPED_TRACE(run);
    BusMonitor monitor;
    ModelBus bus;
    const int dies = 5 + static_cast<int>(random() % 20);
    const int returns = dies + static_cast<int>(random() % 5000);
    const bool tells = random() % 2 == 0;
    const bool loses = random() % 4 == 0;
    for (int cycle = 0; cycle < returns + 500; ++cycle) {
      const bool is_alive = cycle < dies || cycle >= returns;
      if (is_alive) bus.deliver(cycle, monitor);
      if (loses && cycle == returns - 1) bus.queue.clear();
      if (tells && !is_alive && cycle % 7 == 0) {
        monitor.onErrorFrame(kPassive);
        monitor.onErrorFrame(kNoAcknowledge);
      }
      monitor.update();
      ASSERT_FALSE(monitor.maySend() && monitor.mayProbe());
      if (monitor.maySend()) bus.offer(cycle, 4, true, monitor);
      if (monitor.mayProbe()) bus.offer(cycle, 1, false, monitor);
      bus.expectOneCycleOfSetpoints();
      if (!is_alive && cycle > dies + BusMonitor::kMaxUnconfirmedCycles) {
        ASSERT_NE(monitor.fault(), Fault::kNone) << cycle - dies;
      }
    }
    EXPECT_LE(bus.stale_delivered, 4) << "the last cycle's before the bus died";
    EXPECT_EQ(monitor.fault(), Fault::kNone);
    EXPECT_TRUE(monitor.maySend() || bus.queue.size() == 4u);
  }
}

bool isBusFault(Fault fault) {
  return fault == Fault::kNone || fault == Fault::kBusStalled ||
         fault == Fault::kBusUnacknowledged || fault == Fault::kBusOff ||
         fault == Fault::kBusDown || fault == Fault::kBusFlooded;
}

/// One random event; true if it was a confirmation.
bool tellSomething(std::mt19937& random, BusMonitor& monitor) {
  switch (random() % 40) {
    case 0: {
      CanFrame frame = errorFrame(random() & 0x1FFFFFFFU);
      if (random() % 2 == 0) frame.id = 1U << random() % 10;
      for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random());
      monitor.onErrorFrame(frame);
      return false;
    }
    case 1:
      monitor.onSendError(static_cast<int>(random() % 140));
      return false;
    case 2:
      monitor.onReceiveError(static_cast<int>(random() % 140));
      return false;
    case 3:
      monitor.onForeignFrame();
      return false;
    case 4:
      monitor.onConfirmed(static_cast<int>(1 + random() % 6));
      return true;
    default:
      monitor.onReceived(3, random() % 8 == 0);
      monitor.update();
      if (monitor.maySend() && random() % 4 == 0) monitor.onSent(static_cast<int>(random() % 5), 4);
      if (monitor.mayProbe()) monitor.onSent(1, 1);
      return false;
  }
}

bool isDead(Fault fault) { return fault != Fault::kNone && fault != Fault::kBusFlooded; }

/// Whatever is told in whatever order: names are the bus's own, a dead bus gets nothing but probes,
/// and comes back only after a confirmation. Without heap.
TEST(BusMonitor, KeepsItsPromisesUnderRandomEvents) {
  std::mt19937 random(11);
  std::array<bool, 32> is_met{};
  int broken = 0, recovered = 0;
  BusMonitor monitor;
  bool has_answered = false;
  for (int i = 0; i < 2'000'000; ++i) {
    const Fault before = monitor.fault();
    {
      const test::AllocationGuard guard;
      if (i / 500 % 2 == 0) {  // else nothing would ever recover
        has_answered |= tellSomething(random, monitor);
      } else {
        workingCycle(monitor);
        has_answered = true;
      }
    }
    const Fault after = monitor.fault();
    is_met[static_cast<std::size_t>(after)] = true;
    if (!isDead(before) && isDead(after)) has_answered = false;
    if (isDead(before) && after == Fault::kNone) {
      ++recovered;
      broken += !has_answered;
    }
    broken += !isBusFault(after) + (isDead(after) && monitor.maySend()) +
              (monitor.maySend() && monitor.mayProbe());
    ASSERT_EQ(broken, 0) << "event " << i << ", fault " << static_cast<int>(after);
  }
  EXPECT_GT(recovered, 100);
  for (const Fault fault : {Fault::kNone, Fault::kBusStalled, Fault::kBusUnacknowledged,
                            Fault::kBusOff, Fault::kBusDown, Fault::kBusFlooded})
    EXPECT_TRUE(is_met[static_cast<std::size_t>(fault)]) << faultName(fault);
}

}  // namespace
}  // namespace tactus
