#include <gtest/gtest.h>

#include <functional>

#include "plant/scripted_master.h"
#include "support/random.h"
#include "tactus/canopen/cia402.h"
#include "tactus/plant/plant.h"

/// Scripted troubles of the whole plant. All last from 0.1 to 0.2 s after enabling.
namespace tactus {
namespace {

using test::canFrame;
using test::crops9Hardware;
using test::kPeriod_ns;
using test::kPeriod_s;
using test::ScriptedMaster;
using Kind = Trouble::Kind;

constexpr int kKinds = static_cast<int>(Kind::kEmergencyStop) + 1;
/// Another trouble that begins and ends while one lasts.
constexpr Trouble kMeanwhile = {Kind::kDuplicate, 0.14, 0.16, 1, 0x181, 0.0};

class PlantInTrouble : public testing::Test {
 protected:
  void startWith(std::vector<Trouble> troubles) {
    plant_.emplace(test::crops9Controller(Variant::kNullSpace), test::crops9Plant({}), hardware_,
                   kPeriod_s, std::move(troubles));
    master_.emplace(*plant_, hardware_);
    master_->start();
    for (int i = 0; i < 9; ++i) master_->setVelocity(i, 0.05);
    started_ns_ = master_->t_ns() - 3 * kPeriod_ns;
  }
  static Trouble trouble(Kind kind, int bus, std::uint32_t id, double delay_s = 0.0) {
    return {kind, 0.1, 0.2, bus, id, delay_s};
  }
  /// Since enabling.
  void runUntil(double t_s) {
    while (static_cast<double>(master_->t_ns() - started_ns_) < 1e9 * t_s) master_->cycle();
  }
  bool isEnabled(int drive) const {
    return plant_->drive(drive).powerState() == PowerState::kOperationEnabled;
  }
  /// Frames of the id heard from now until t_s.
  int countUntil(double t_s, int bus, std::uint32_t id) {
    master_->cycle();
    master_->forget();
    runUntil(t_s);
    return master_->timesHeard(bus, id);
  }

  HardwareConfig hardware_ = crops9Hardware();
  std::optional<Plant> plant_;
  std::optional<ScriptedMaster> master_;
  std::int64_t started_ns_ = 0;
};

TEST_F(PlantInTrouble, DropsTheFramesOfOneId) {
  startWith({trouble(Kind::kDrop, 1, 0x182)});
  runUntil(0.095);
  EXPECT_EQ(isEnabled(4), true);
  runUntil(0.11);
  EXPECT_EQ(countUntil(0.19, 1, 0x182), 0);
  EXPECT_GT(master_->timesHeard(1, 0x181), 70);
  EXPECT_GT(master_->timesHeard(0, 0x182), 70);
  runUntil(0.21);
  EXPECT_GT(countUntil(0.3, 1, 0x182), 80);
}

TEST_F(PlantInTrouble, DroppedSyncsMakeTheDrivesStop) {
  startWith({trouble(Kind::kDrop, 0, 0x080)});
  runUntil(0.3);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(isEnabled(i), i >= 3) << i;
  EXPECT_EQ(plant_->drive(0).objects().get(0x603F), 0x8700u);
  EXPECT_EQ(plant_->drive(0).velocity(), 0.0);
}

TEST_F(PlantInTrouble, DroppedSetpointsMakeTheirDriveStop) {
  startWith({trouble(Kind::kDrop, 0, 0x202)});
  runUntil(0.11);
  master_->setVelocity(1, 0.0);
  runUntil(0.155);
  EXPECT_TRUE(isEnabled(1));
  EXPECT_NEAR(plant_->drive(1).velocity(), 0.05, 1e-6) << "goes on";
  runUntil(0.17);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(isEnabled(i), i != 1) << i;
  EXPECT_EQ(plant_->drive(1).objects().get(0x603F), 0x8250u);
  EXPECT_EQ(plant_->drive(1).velocity(), 0.0);
}

TEST_F(PlantInTrouble, DelayedSetpointsAreCountedAsStale) {
  startWith({trouble(Kind::kDelay, 0, 0x201, 0.01)});
  runUntil(0.15);
  EXPECT_GT(plant_->counters().stale_setpoints_applied, 20u);
  EXPECT_EQ(plant_->drive(1).staleSetpoints(), 0u);
  runUntil(0.25);
  const auto before = plant_->counters().stale_setpoints_applied;
  runUntil(0.5);
  EXPECT_EQ(plant_->counters().stale_setpoints_applied, before);
}

TEST_F(PlantInTrouble, DelaysFeedback) {
  startWith({trouble(Kind::kDelay, 0, 0x181, 0.02)});
  runUntil(0.101);
  EXPECT_LE(countUntil(0.119, 0, 0x181), 1) << "nothing comes for the time of the delay";
  runUntil(0.3);
  const int all = master_->timesHeard(0, 0x181);
  EXPECT_NEAR(all, master_->timesHeard(0, 0x182), 1) << "none is lost";
}

TEST_F(PlantInTrouble, ReordersPairsOfTheBus) {
  startWith({trouble(Kind::kReorder, 3, 0)});
  runUntil(0.105);
  master_->forget();
  runUntil(0.195);
  int swapped = 0;
  const auto frames = master_->heard(3);
  for (std::size_t i = 1; i < frames.size(); ++i) swapped += frames[i].id + 1 == frames[i - 1].id;
  EXPECT_GE(swapped, 40);
  runUntil(0.21);
  master_->forget();
  runUntil(0.3);
  const auto calm = master_->heard(3);
  ASSERT_GT(calm.size(), 60u);
  for (std::size_t i = 1; i < calm.size(); ++i)
    EXPECT_EQ((calm[i].id - calm[i - 1].id + 4) % 4, 1u);
}

TEST_F(PlantInTrouble, AFrameHeldForSwappingIsLetGoAtTheEnd) {
  startWith({trouble(Kind::kReorder, 0, 0x701)});  // a heartbeat each 20 ms
  runUntil(0.05);
  master_->forget();
  runUntil(0.205);
  const int held = master_->timesHeard(0, 0x702) - master_->timesHeard(0, 0x701);
  EXPECT_EQ(held, 0);
}

TEST_F(PlantInTrouble, CorruptsTheDataOfOneId) {
  startWith({trouble(Kind::kCorrupt, 0, 0x182)});
  runUntil(0.11);
  int wrong = 0;
  for (int i = 0; i < 70; ++i) {
    master_->cycle();
    const double q = plant_->world().modules() > 0 ? master_->position(1) : 0.0;
    RobotInput seen;
    SimulatedRobot world = plant_->world();
    world.read(seen);
    const bool is_far = std::abs(q - seen.q_measured[1]) > 1e-3;
    const bool is_odd = (master_->status(1) & 0x6F) != 0x27 || (master_->status(1) >> 13) != 0;
    wrong += is_far || is_odd;
  }
  EXPECT_GT(wrong, 20) << "flips in low bits of the position pass";
  runUntil(0.25);
  EXPECT_EQ(master_->status(1) & 0x6F, 0x27);
  EXPECT_TRUE(isEnabled(1));
}

TEST_F(PlantInTrouble, DuplicatesFrames) {
  startWith({trouble(Kind::kDuplicate, 0, 0x183)});
  runUntil(0.11);
  const int times = countUntil(0.19, 0, 0x183);
  EXPECT_NEAR(times, 2 * master_->timesHeard(0, 0x182), 2);
}

TEST_F(PlantInTrouble, ADriveFailsAndStopsByItself) {
  startWith({trouble(Kind::kDriveFault, 1, 2)});
  runUntil(0.099);
  EXPECT_TRUE(isEnabled(4));
  runUntil(0.15);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(isEnabled(i), i != 4) << i;
  EXPECT_EQ(plant_->drive(4).velocity(), 0.0);
  EXPECT_EQ(master_->timesHeard(1, 0x82), 1);
  EXPECT_EQ(master_->status(4) & 0x4F, 0x08);
  runUntil(0.25);
  for (const int word : {0x80, 0x06, 0x07, 0x0F}) {
    master_->control_word = word;
    master_->cycles(3);
  }
  EXPECT_EQ(master_->status(4) & 0x6F, 0x27) << "can be reset once its cause is gone";
}

TEST_F(PlantInTrouble, AllDrivesOfABusFailTogether) {
  startWith({trouble(Kind::kDriveFault, 2, 0)});
  runUntil(0.15);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(isEnabled(i), i < 6) << i;
}

TEST_F(PlantInTrouble, ADriveIgnoresCommandsAndKeepsItsVelocity) {
  startWith({trouble(Kind::kIgnoreCommands, 0, 2)});
  runUntil(0.11);
  for (int i = 0; i < 9; ++i) master_->setVelocity(i, -0.02);
  runUntil(0.12);
  EXPECT_NEAR(plant_->drive(1).velocity(), 0.05, 1e-6);
  EXPECT_NEAR(plant_->drive(2).velocity(), -0.02, 1e-6);
  master_->control_word = 0x02;  // quick stop
  runUntil(0.135);
  plant_->send(0, canFrame(0x602, {0x2B, 0x40, 0x60, 0, 0x02, 0, 0, 0}), master_->t_ns());
  runUntil(0.195);  // longer than its deadline for setpoints: they do arrive
  for (int i = 0; i < 9; ++i) EXPECT_EQ(isEnabled(i), i == 1) << i;
  EXPECT_NEAR(plant_->drive(1).velocity(), 0.05, 1e-6);
  EXPECT_EQ(master_->status(1) & 0x6F, 0x27);
  runUntil(0.23);
  EXPECT_FALSE(isEnabled(1));
  EXPECT_EQ(plant_->drive(1).velocity(), 0.0);
}

TEST_F(PlantInTrouble, ADriveThatIgnoresCommandsStillStopsByItself) {
  for (const bool by_nmt : {false, true}) {
    startWith({trouble(Kind::kIgnoreCommands, 0, 0)});
    runUntil(0.11);
    if (by_nmt) plant_->send(0, canFrame(0, {2, 2}), master_->t_ns());
    master_->is_silent = !by_nmt;
    runUntil(0.19);
    EXPECT_EQ(plant_->drive(1).velocity(), 0.0);
    EXPECT_EQ(plant_->drive(1).objects().get(0x603F), by_nmt ? 0x8100u : 0x8700u);
    EXPECT_EQ(isEnabled(0), by_nmt);
  }
}

TEST_F(PlantInTrouble, ADrivesFeedbackFreezes) {
  startWith({trouble(Kind::kFreezeFeedback, 0, 2), kMeanwhile});
  runUntil(0.099);
  const double begin = master_->position(1);
  runUntil(0.11);
  const double frozen = master_->position(1);
  EXPECT_NEAR(frozen, begin, 0.003 * 0.05) << "that of the moment";
  const int feedbacks = master_->feedbacks(1);
  master_->control_word = 0x07;  // the drive obeys, and says nothing of it
  runUntil(0.195);
  EXPECT_EQ(plant_->drive(1).powerState(), PowerState::kSwitchedOn);
  EXPECT_EQ(master_->status(1) & 0x6F, 0x27);
  EXPECT_EQ(master_->status(2) & 0x6F, 0x23);
  EXPECT_EQ(master_->position(1), frozen);
  EXPECT_GE(master_->feedbacks(1), feedbacks + 80);
  runUntil(0.21);
  EXPECT_EQ(master_->status(1) & 0x6F, 0x23);
  EXPECT_GT(master_->position(1), frozen + 0.005 * 0.05);
}

TEST_F(PlantInTrouble, ADriveTellsAStatusThatTheStandardDoesNotKnow) {
  startWith({trouble(Kind::kNonsenseStatus, 0, 2)});
  runUntil(0.11);
  const double before = master_->position(1);
  for (const int word : {0x0F, 0x07, 0x06, 0x00}) {  // enabled, switched on, ready, disabled
    master_->control_word = word;
    master_->cycles(10);
    const auto status = static_cast<std::uint16_t>(master_->status(1));
    EXPECT_FALSE(decodeStatusWord(status)) << word << " " << status;
    EXPECT_TRUE(decodeStatusWord(static_cast<std::uint16_t>(master_->status(2)))) << word;
  }
  EXPECT_GT(master_->position(1), before) << "its position is the truth";
  runUntil(0.21);
  EXPECT_EQ(master_->status(1) & 0x4F, 0x40);
}

TEST_F(PlantInTrouble, ADriveSaysThatItHasBootedThoughItRunsOn) {
  startWith({trouble(Kind::kBootUp, 0, 2), kMeanwhile});
  runUntil(0.09);
  master_->forget();
  runUntil(0.3);
  int boot_ups = 0;
  for (const CanFrame& frame : master_->heard(0)) {
    if (frame.id < 0x701 || frame.size != 1 || frame.data[0] != 0) continue;
    EXPECT_EQ(frame, canFrame(0x702, {0}));
    ++boot_ups;
  }
  EXPECT_EQ(boot_ups, 1);
  EXPECT_TRUE(isEnabled(1));
  EXPECT_NEAR(plant_->drive(1).velocity(), 0.05, 1e-6);
  EXPECT_GT(master_->timesHeard(0, 0x182), 200);
}

TEST_F(PlantInTrouble, ADriveMissesTheHeartbeatOnly) {
  for (const std::uint32_t lost : {0x080U, 0x202U}) {
    startWith({trouble(Kind::kHeartbeatOnly, 0, 2), trouble(Kind::kDrop, 0, lost)});
    runUntil(0.105);
    master_->setVelocity(1, 0.0);
    runUntil(0.199);
    EXPECT_TRUE(isEnabled(1));
    EXPECT_NEAR(plant_->drive(1).velocity(), 0.05, 1e-6) << "nobody has told it otherwise";
    EXPECT_EQ(isEnabled(0), lost == 0x202U);
  }
  startWith({trouble(Kind::kHeartbeatOnly, 0, 2)});
  runUntil(0.105);
  master_->is_silent = true;
  runUntil(0.135);
  EXPECT_TRUE(isEnabled(1));
  EXPECT_FALSE(isEnabled(0));
  runUntil(0.19);
  EXPECT_FALSE(isEnabled(1));
  EXPECT_EQ(plant_->drive(1).objects().get(0x603F), 0x8130u);
}

TEST_F(PlantInTrouble, ThePowerOfABusIsCutAndReturns) {
  startWith({trouble(Kind::kPowerCut, 0, 0)});
  runUntil(0.1);
  master_->forget();
  runUntil(0.15);
  EXPECT_LE(master_->timesHeard(0, 0x181), 1) << "the one on its way";
  const int errors = master_->timesHeard(0, 0x24, FrameKind::kError);
  EXPECT_GE(errors, 10);
  EXPECT_LE(errors, 50) << "floods";
  EXPECT_GT(master_->timesHeard(1, 0x181), 45) << "the other buses go on";
  EXPECT_GT(plant_->counters().frames_refused, 20u);
  EXPECT_EQ(plant_->bus(0).waiting(PlantBus::kOtherSide), FrameQueue::kCapacity);
  EXPECT_EQ(plant_->drive(0).nmtState(), NodeState::kOff);
  EXPECT_EQ(plant_->drive(0).velocity(), 0.0);
  runUntil(0.205);
  master_->forget();
  runUntil(0.3);
  EXPECT_EQ(master_->timesHeard(0, 0x701), 1) << "boots";
  EXPECT_EQ(master_->timesHeard(0, 0x24, FrameKind::kError), 0);
  EXPECT_EQ(plant_->drive(0).nmtState(), NodeState::kPreOperational);
  EXPECT_EQ(plant_->drive(0).velocity(), 0.0);
  EXPECT_EQ(plant_->counters().stale_setpoints_applied, 0u);
}

TEST_F(PlantInTrouble, WithoutPowerTheModuleSaysNothingAndKeepsNothing) {
  startWith({trouble(Kind::kPowerCut, 3, 0)});
  runUntil(0.102);
  master_->forget();
  runUntil(0.199);
  for (const CanFrame& frame : master_->heard(3)) EXPECT_EQ(frame.kind, FrameKind::kError);
  runUntil(0.3);
  EXPECT_NEAR(master_->timesHeard(3, 0x100), 25, 1) << "only those since then";
}

TEST_F(PlantInTrouble, ShortBusOffLeavesNoStaleSetpointToAMasterThatGoesOnSending) {
  startWith({{Kind::kBusOff, 0.1, 0.1035, 0, 0, 0.0}});
  runUntil(0.1);
  master_->forget();
  runUntil(0.12);
  EXPECT_TRUE(isEnabled(0)) << "SYNC was missing too shortly";
  EXPECT_GE(master_->timesHeard(0, 0x40, FrameKind::kError), 1);
  EXPECT_EQ(master_->timesHeard(0, 0x100, FrameKind::kError), 1);
  EXPECT_EQ(plant_->counters().stale_setpoints_applied, 0u);
  const std::uint64_t refused = plant_->counters().frames_refused;
  EXPECT_GE(refused, 3u * 4u) << "three setpoints and SYNC a cycle";
  EXPECT_LE(refused, 4u * 5u);
}

TEST_F(PlantInTrouble, LongBusOffStopsTheDrives) {
  startWith({trouble(Kind::kBusOff, 0, 0)});
  runUntil(0.105);
  master_->forget();
  runUntil(0.195);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(isEnabled(i));
  for (const CanFrame& frame : master_->heard(0)) EXPECT_EQ(frame.kind, FrameKind::kError);
  EXPECT_GT(master_->timesHeard(1, 0x181), 80);
}

TEST_F(PlantInTrouble, TheEmergencyStopIsALineOfItsOwn) {
  Trouble pressed = trouble(Kind::kEmergencyStop, 0, 0);
  startWith({pressed});
  std::int64_t pressed_ns = 0;
  for (int cycle = 0; cycle < 300; ++cycle) {
    pressed_ns += plant_->emergencyStop(master_->t_ns()) ? kPeriod_ns : 0;
    master_->cycle();
  }
  EXPECT_EQ(pressed_ns, 100 * kPeriod_ns);
  EXPECT_TRUE(isEnabled(0)) << "stopping is the daemon's";
}

TEST_F(PlantInTrouble, NothingHappensBeforeADriveIsEnabled) {
  Plant plant(
      test::crops9Controller(Variant::kNullSpace), test::crops9Plant({}), hardware_, kPeriod_s,
      {{Kind::kPowerCut, 0.0, 100.0, 0, 0, 0.0}, {Kind::kEmergencyStop, 0.0, 100.0, 0, 0, 0.0}});
  plant.advance(5'000'000'000);
  EXPECT_EQ(plant.drive(0).nmtState(), NodeState::kPreOperational);
  EXPECT_FALSE(plant.emergencyStop(5'000'000'000));
}

TEST_F(PlantInTrouble, ASilentMasterIsNoticedByEveryDrive) {
  startWith({});
  runUntil(0.1);
  master_->is_silent = true;
  runUntil(0.3);
  for (int i = 0; i < 9; ++i) {
    EXPECT_FALSE(isEnabled(i));
    EXPECT_EQ(plant_->drive(i).velocity(), 0.0);
  }
}

/// Whatever the script, whatever the master does: runs repeat, events go forward.
TEST_F(PlantInTrouble, AnyScriptRepeatsToTheBit) {
  test::Random random(851);
  for (int script = 0; script < 20; ++script) {
    std::vector<Trouble> troubles;
    for (int i = 0; i < 6; ++i) {
      const double from_s = random.uniform(0.0, 0.2);
      const std::uint32_t ids[] = {0, 0x201, 0x181, 0x80, 0x100, 2};
      troubles.push_back({static_cast<Kind>(random.index(kKinds)), from_s,
                          from_s + random.uniform(0.001, 0.2), random.index(4),
                          ids[random.index(6)], random.uniform(0.0, 0.02)});
    }
    std::vector<std::vector<CanFrame>> heard[2];
    for (auto& run : heard) {
      startWith(troubles);
      runUntil(0.5);
      for (int bus = 0; bus < 4; ++bus) run.push_back(master_->heard(bus));
    }
    ASSERT_EQ(heard[0], heard[1]);
  }
}

}  // namespace
}  // namespace tactus
