#include "tactus/plant/plant_bus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <vector>

#include "plant/can_bytes.h"
#include "support/random.h"
#include "tactus/canopen/bus_load.h"

namespace tactus {
namespace {

using test::canFrame;

constexpr double kMegabit_per_s = 1e6;

struct Seen {
  std::int64_t end_ns;
  BusDelivery delivery;
};

std::vector<Seen> runUntil(PlantBus& bus, std::int64_t t_ns) {
  std::vector<Seen> seen;
  for (std::int64_t next_ns = bus.nextEvent_ns(); next_ns <= t_ns; next_ns = bus.nextEvent_ns())
    if (const auto delivery = bus.step()) seen.push_back({next_ns, *delivery});
  return seen;
}

TEST(WorstCaseBits, AreThoseOfTheLoadBudget) {
  EXPECT_EQ(worstCaseBits(canFrame(0x80, {})), 55);
  EXPECT_EQ(worstCaseBits(canFrame(0x201, {0, 0, 0, 0, 0, 0})), 115);
  EXPECT_EQ(worstCaseBits(canFrame(0x101, {0, 0, 0, 0, 0, 0, 0, 0})), 135);
  CanFrame remote = canFrame(0x181, {0, 0, 0, 0, 0, 0, 0, 0});
  remote.kind = FrameKind::kRemote;
  EXPECT_EQ(worstCaseBits(remote), 55);
}

TEST(PlantBus, AFrameOfCanFdSwitchesItsRate) {
  PlantBus bus(1e6, 2, 5e6);
  CanFrame frame = canFrame(0x8001, {});
  frame.extended = frame.is_fd = true;
  frame.size = 24;
  ASSERT_TRUE(bus.send(1, frame, 0));
  const FdBits bits = worstCaseFdBits(24, true);
  const std::int64_t end_ns = 1000 * bits.arbitration + 200 * bits.data;
  EXPECT_TRUE(runUntil(bus, end_ns - 1).empty());
  EXPECT_EQ(runUntil(bus, end_ns).size(), 1u);
  ASSERT_TRUE(bus.send(1, canFrame(0x181, {1, 2, 3, 4, 5, 6}), end_ns));
  EXPECT_TRUE(runUntil(bus, end_ns + 114999).empty());
  EXPECT_EQ(runUntil(bus, end_ns + 115000).size(), 1u) << "as on a classic bus";
}

TEST(PlantBus, AClassicBusCarriesNoCanFd) {
  PlantBus bus(1e6, 2);
  CanFrame frame = canFrame(0x181, {});
  frame.is_fd = true;
  EXPECT_FALSE(bus.send(PlantBus::kOtherSide, frame, 0));
  EXPECT_EQ(bus.refused(), 1u);
}

TEST(PlantBus, AFrameTakesItsTimeByTheBitRate) {
  for (const double rate : {125e3, 250e3, 500e3, 1e6}) {
    PlantBus bus(rate, 2);
    bus.send(1, canFrame(0x181, {1, 2, 3, 4, 5, 6}), 1000);
    EXPECT_TRUE(runUntil(bus, 999).empty());
    const std::int64_t end_ns = 1000 + static_cast<std::int64_t>(115e9 / rate);
    EXPECT_TRUE(runUntil(bus, end_ns - 1).empty());
    const auto seen = runUntil(bus, end_ns);
    ASSERT_EQ(seen.size(), 1u);
    EXPECT_EQ(seen[0].delivery.sender, 1);
    EXPECT_EQ(seen[0].delivery.item.sent_ns, 1000);
    EXPECT_EQ(bus.nextEvent_ns(), kNever_ns);
  }
}

TEST(PlantBus, AWaitingHigherPriorityDoesNotInterruptAFrame) {
  PlantBus bus(kMegabit_per_s, 3);
  bus.send(1, canFrame(0x700, {5}), 0);
  EXPECT_TRUE(runUntil(bus, 0).empty());
  bus.send(2, canFrame(0x001, {}), 10);
  bus.send(1, canFrame(0x100, {}), 20);
  const auto seen = runUntil(bus, 1'000'000);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0].delivery.item.frame.id, 0x700u);
  EXPECT_EQ(seen[0].end_ns, 65'000);
  EXPECT_EQ(seen[1].delivery.item.frame.id, 0x001u);
  EXPECT_EQ(seen[1].end_ns, 120'000);
  EXPECT_EQ(seen[2].delivery.item.frame.id, 0x100u);
}

TEST(PlantBus, AFrameThatComesLaterTakesNoPartInAnEarlierArbitration) {
  PlantBus bus(kMegabit_per_s, 3);
  bus.send(1, canFrame(0x700, {5}), 0);
  bus.send(2, canFrame(0x001, {}), 10);
  const auto seen = runUntil(bus, 1'000'000);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].delivery.item.frame.id, 0x700u);
}

TEST(PlantBus, ExtendedAndRemoteFramesLoseAgainstDataFramesOfTheSameId) {
  PlantBus bus(kMegabit_per_s, 4);
  CanFrame extended = canFrame(0x100U << 18, {1});
  extended.extended = true;
  CanFrame remote = canFrame(0x100, {});
  remote.kind = FrameKind::kRemote;
  bus.send(1, extended, 0);
  bus.send(2, remote, 0);
  bus.send(3, canFrame(0x100, {1}), 0);
  const auto seen = runUntil(bus, 1'000'000);
  ASSERT_EQ(seen.size(), 3u);
  EXPECT_EQ(seen[0].delivery.sender, 3);
  EXPECT_EQ(seen[1].delivery.sender, 2);
  EXPECT_EQ(seen[2].delivery.sender, 1);
}

TEST(PlantBus, AFrameMoreThanAQueueHoldsIsRefusedAndCounted) {
  PlantBus bus(kMegabit_per_s, 2);
  constexpr int kMost = FrameQueue::kCapacity;
  for (int i = 0; i < kMost; ++i) EXPECT_TRUE(bus.send(0, canFrame(0x201, {i}), 0));
  EXPECT_FALSE(bus.send(0, canFrame(0x000, {99}), 0));
  EXPECT_EQ(bus.refused(), 1u);
  const auto seen = runUntil(bus, 10'000'000);
  ASSERT_EQ(seen.size(), std::size_t{kMost});
  for (int i = 0; i < kMost; ++i) EXPECT_EQ(seen[i].delivery.item.frame.data[0], i);
}

/// A bus with random traffic, and everything that is known of it from outside.
class BusUnderLoad {
 public:
  explicit BusUnderLoad(std::uint64_t seed)
      : random_(seed), bus_(kMegabit_per_s, kNodes), waiting_(kNodes) {}

  void run(int frames) {
    for (int i = 0; i < frames; ++i) {
      t_ns_ += static_cast<std::int64_t>(random_.uniform(0.0, 2.0) * load_gap_ns_);
      advance(t_ns_);
      const int node = random_.index(kNodes);
      const CanFrame frame = randomFrame();
      const bool is_room = waiting_[node].size() < FrameQueue::kCapacity;
      ASSERT_EQ(bus_.send(node, frame, t_ns_), is_room);
      if (is_room) waiting_[node].push_back({frame, t_ns_});
      accepted_ += is_room ? 1 : 0;
      if (i % 500 == 0) load_gap_ns_ = random_.uniform(40e3, 200e3);
    }
    advance(kNever_ns - 1);
    EXPECT_EQ(delivered_, accepted_);
  }

 private:
  static constexpr int kNodes = 5;

  CanFrame randomFrame() {
    CanFrame frame = canFrame(static_cast<std::uint32_t>(random_.index(0x800)), {});
    frame.size = static_cast<std::uint8_t>(random_.index(9));
    return frame;
  }

  void advance(std::int64_t t_ns) {
    for (const Seen& seen : runUntil(bus_, t_ns)) check(seen);
  }

  void check(const Seen& seen) {
    const CanFrame& frame = seen.delivery.item.frame;
    const std::int64_t start_ns = seen.end_ns - 1000 * worstCaseBits(frame);
    ASSERT_GE(start_ns, last_end_ns_) << "frames overlap";
    std::int64_t first_sent_ns = kNever_ns;
    for (const auto& queue : waiting_) {
      if (queue.empty()) continue;
      first_sent_ns = std::min(first_sent_ns, queue.front().sent_ns);
      if (queue.front().sent_ns > start_ns) continue;
      ASSERT_LE(frame.id, queue.front().frame.id) << "lost arbitration, went all the same";
    }
    ASSERT_EQ(start_ns, std::max(last_end_ns_, first_sent_ns)) << "idle while something waits";
    auto& own = waiting_[seen.delivery.sender];
    ASSERT_FALSE(own.empty());
    ASSERT_EQ(own.front().frame, frame) << "out of turn";
    own.pop_front();
    last_end_ns_ = seen.end_ns;
    ++delivered_;
  }

  test::Random random_;
  PlantBus bus_;
  std::vector<std::deque<QueuedFrame>> waiting_;
  double load_gap_ns_ = 100e3;
  std::int64_t t_ns_ = 0;
  std::int64_t last_end_ns_ = 0;
  int accepted_ = 0;
  int delivered_ = 0;
};

TEST(PlantBus, CarriesOneFrameAtATimeTheMostUrgentFirstAndNeverIdles) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) BusUnderLoad(seed).run(3000);
}

TEST(PlantBus, WithoutPowerFramesWaitAndTheControllerComplains) {
  PlantBus bus(kMegabit_per_s, 2);
  bus.setPowered(false, 0);
  EXPECT_EQ(bus.nextEvent_ns(), kNever_ns) << "nothing to send, nothing to miss";
  constexpr int kMost = FrameQueue::kCapacity;
  for (int i = 0; i < kMost + 4; ++i) bus.send(0, canFrame(0x201, {i}), 1000);
  EXPECT_EQ(bus.refused(), 4u);
  const auto seen = runUntil(bus, 100'000'000);
  ASSERT_GE(seen.size(), 2u);
  EXPECT_EQ(seen[0].end_ns, 1000 + 16 * (65'000 + 20'000)) << "sixteen attempts with error flags";
  for (std::size_t i = 0; i < seen.size(); ++i) {
    const CanFrame& error = seen[i].delivery.item.frame;
    EXPECT_EQ(seen[i].delivery.sender, PlantBus::kController);
    EXPECT_EQ(error.kind, FrameKind::kError);
    EXPECT_EQ(error.id, 0x24u);  // CAN_ERR_ACK | CAN_ERR_CRTL
    EXPECT_EQ(error.size, 8);
    EXPECT_EQ(error.data[1], 0x20);  // CAN_ERR_CRTL_TX_PASSIVE
    const std::int64_t last_ns = i == 0 ? 0 : seen[i - 1].end_ns;
    EXPECT_GE(seen[i].end_ns - last_ns, 1'000'000) << "floods";
  }
  bus.setPowered(true, 100'000'000);
  const auto late = runUntil(bus, 200'000'000);
  ASSERT_EQ(late.size(), std::size_t{kMost});
  EXPECT_EQ(late[0].end_ns, 100'000'000 + 65'000);
  EXPECT_EQ(late[0].delivery.item.sent_ns, 1000) << "its age shows";
}

TEST(PlantBus, ACutAbortsTheFrameOnTheBus) {
  PlantBus bus(kMegabit_per_s, 2);
  bus.send(1, canFrame(0x181, {1}), 0);
  EXPECT_TRUE(runUntil(bus, 1000).empty());
  bus.setPowered(false, 2000);
  EXPECT_EQ(bus.nextEvent_ns(), kNever_ns);
  EXPECT_FALSE(bus.send(1, canFrame(0x181, {2}), 2500));
  EXPECT_EQ(bus.nextEvent_ns(), kNever_ns);
  bus.setPowered(true, 3000);
  EXPECT_TRUE(runUntil(bus, 1'000'000).empty()) << "what a node without power had is lost";

  bus.send(0, canFrame(0x201, {1}), 1'000'000);
  EXPECT_TRUE(runUntil(bus, 1'010'000).empty());
  bus.setPowered(false, 1'020'000);
  bus.setPowered(true, 1'100'000);
  const auto seen = runUntil(bus, 2'000'000);
  ASSERT_EQ(seen.size(), 1u) << "the other side's is sent again";
  EXPECT_EQ(seen[0].end_ns, 1'100'000 + 65'000);
}

TEST(PlantBus, InBusOffOnlyTheOthersTalk) {
  PlantBus bus(kMegabit_per_s, 2);
  bus.send(0, canFrame(0x201, {1}), 0);
  EXPECT_TRUE(runUntil(bus, 1000).empty());
  bus.setOtherSideOff(true, 2000);
  bus.send(1, canFrame(0x701, {5}), 2000);
  int from_node = 0;
  int reports = 0;
  for (const Seen& seen : runUntil(bus, 50'000'000)) {
    EXPECT_NE(seen.delivery.sender, PlantBus::kOtherSide);
    if (seen.delivery.sender == 1) ++from_node;
    if (seen.delivery.sender != PlantBus::kController) continue;
    EXPECT_EQ(seen.delivery.item.frame.id, 0x40u);  // CAN_ERR_BUSOFF
    EXPECT_EQ(seen.delivery.item.frame.kind, FrameKind::kError);
    ++reports;
  }
  EXPECT_EQ(from_node, 1);
  EXPECT_EQ(reports, 1);
  EXPECT_FALSE(bus.send(0, canFrame(0x202, {2}), 49'000'000));
  EXPECT_EQ(bus.refused(), 1u);
  bus.setOtherSideOff(false, 50'000'000);
  bus.send(0, canFrame(0x203, {3}), 51'000'000);
  const auto seen = runUntil(bus, 60'000'000);
  ASSERT_EQ(seen.size(), 2u) << "what it had, and what it wanted to send meanwhile, is gone";
  EXPECT_EQ(seen[0].delivery.item.frame.id, 0x100u);  // CAN_ERR_RESTARTED
  EXPECT_EQ(seen[1].delivery.item.frame.id, 0x203u);
  EXPECT_EQ(seen[1].end_ns, 51'000'000 + 65'000);
}

TEST(PlantBus, BusOffEmptiesTheWholeQueueAlsoWithoutPower) {
  PlantBus bus(kMegabit_per_s, 2);
  bus.setPowered(false, 0);
  for (int i = 0; i < 16; ++i) bus.send(0, canFrame(0x201, {i}), 1000);
  runUntil(bus, 10'000'000);
  bus.setOtherSideOff(true, 10'000'000);
  EXPECT_EQ(bus.waiting(PlantBus::kOtherSide), 0u);
  bus.setPowered(true, 11'000'000);
  bus.setOtherSideOff(false, 12'000'000);
  for (const Seen& seen : runUntil(bus, 100'000'000))
    EXPECT_EQ(seen.delivery.item.frame.kind, FrameKind::kError);
}

}  // namespace
}  // namespace tactus
