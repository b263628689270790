#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "support/allocation_guard.h"
#include "support/drive_rig.h"
#include "support/hostile_drive_bus.h"
#include "support/random.h"
#include "support/random_limits.h"
#include "tactus/canopen/canopen.h"

/// Every byte on the bus is hostile.
namespace tactus {
namespace {

using test::DriveRig;
using test::HostileDriveBus;
using test::kNode;
using test::Random;

/// Frames on the ids of one drive, mostly plausible ones.
CanFrame hostileFrame(Random& random, std::int32_t position) {
  CanFrame frame;
  static constexpr std::uint32_t kIds[] = {0x180, 0x180, 0x580, 0x700, 0x080, 0x000, 0x200};
  static constexpr int kSizes[] = {6, 6, 8, 1, 8, 2, 6};
  static constexpr int kStatus[] = {0x37, 0x37, 0x37, 0x40, 0x31, 0x33, 0x17, 0x0F, 0x08, 0x00};
  const int kind = random.index(7);
  frame.id = random.chance(0.95) ? kIds[kind] + kNode : random.index(0x800);
  frame.size = static_cast<std::uint8_t>(random.chance(0.95) ? kSizes[kind] : random.index(9));
  for (auto& byte : frame.data) byte = static_cast<std::uint8_t>(random.index(256));
  if (kind < 2 && random.chance(0.9)) {
    frame.data[0] = static_cast<std::uint8_t>(kStatus[random.index(10)]);
    if (random.chance(0.9)) writeLittleEndian(frame, 2, 4, static_cast<std::uint32_t>(position));
  }
  if (kind == 3 && random.chance(0.9)) frame.data[0] = 5;
  if (kind == 4 && random.chance(0.9)) writeLittleEndian(frame, 0, 2, 0);
  if (random.chance(0.02)) frame.extended = true;
  if (random.chance(0.02)) frame.kind = FrameKind::kRemote;
  return frame;
}

DriveGoal anyGoal(Random& random) {
  if (random.chance(0.7)) return DriveGoal::kEnabled;
  return static_cast<DriveGoal>(random.index(5));
}

/// One run: a good drive on a bus on which anybody may speak.
class HostileRun {
 public:
  HostileRun(Random& random, const DriveConfig& config)
      : random_(random), bus_(config, {}, test::kPeriod_s), position_(config.offset) {}

  /// What went wrong in a cycle; nullptr if nothing.
  const char* cycle(int number) {
    const bool is_hostile = number > 120 && random_.chance(0.05);
    std::vector<CanFrame> frames;
    if (gap_ > 0) --gap_;
    if (random_.chance(0.02)) gap_ = random_.integer(1, 10);
    if (gap_ == 0) frames = slave_.take();
    for (int i = is_hostile ? random_.integer(1, 4) : 0; i > 0; --i)
      frames.insert(frames.begin() + random_.index(static_cast<int>(frames.size()) + 1),
                    hostileFrame(random_, slave_.position));
    const DriveGoal goal = nextGoal(number);
    const bool has_fault = bus_.drive().report().fault != Fault::kNone;
    const bool restart = number == 0 || (has_fault && random_.chance(0.1));
    const double velocity =
        random_.chance(0.99) ? random_.uniform(-1.0, 1.0) : test::hostileNumber(random_);
    if (bus_.drive().report().has_position && random_.chance(0.99))
      position_ = bus_.drive().report().position + random_.uniform(-0.02, 0.02);
    const char* problem = nullptr;
    {
      test::AllocationGuard guard;
      for (const CanFrame& frame : frames) bus_.receive(frame);
      problem = bus_.update(goal, restart, velocity, position_);
    }
    for (const CanFrame& frame : bus_.sent()) slave_.hear(frame);
    slave_.hear(syncFrame());
    return problem;
  }

  const HostileDriveBus& bus() const { return bus_; }

 private:
  DriveGoal nextGoal(int number) {
    const DriveReport& report = bus_.drive().report();
    if (!report.is_configured || report.fault != Fault::kNone) return DriveGoal::kConfigure;
    return number < 120 ? DriveGoal::kEnabled : anyGoal(random_);
  }

  Random& random_;
  HostileDriveBus bus_;
  test::ScriptedDrive slave_{kNode};
  double position_;
  int gap_ = 0;  ///< cycles for which the drive is not heard
};

TEST(HostileFrames, NeverMakeADriveMoveOtherwiseThanAsked) {
  Random random(406);
  int setpoints = 0;
  int faults[256] = {};
  for (int run = 0; run < 300; ++run) {
    DriveConfig config = test::driveConfig();
    config.tracking_gain_per_s = random.chance(0.5) ? 0.0 : random.logUniform(0.1, 100.0);
    if (random.chance(0.5)) config.max_velocity = random.uniform(0.1, 2.0);
    HostileRun hostile(random, config);
    for (int cycle = 0; cycle < 1000; ++cycle) {
      const char* problem = hostile.cycle(cycle);
      ASSERT_EQ(problem, nullptr) << problem << ", run " << run << " cycle " << cycle;
      ++faults[static_cast<int>(hostile.bus().drive().report().fault)];
    }
    setpoints += hostile.bus().setpoints();
  }
  EXPECT_GT(setpoints, 20000);
  for (Fault fault : {Fault::kNone, Fault::kDriveFault, Fault::kDriveStateLost, Fault::kDriveSilent,
                      Fault::kFollowingError, Fault::kDriveSetupRefused, Fault::kCommandNotFinite})
    EXPECT_GT(faults[static_cast<int>(fault)], 0) << faultName(fault);
}

TEST(NoAllocation, InTheCycleOfADrive) {
  DriveRig rig;
  rig.enable();
  rig.slave.fault(0x7500);
  const auto frames = rig.slave.take();
  FrameBatch out;
  test::AllocationGuard guard;
  for (const CanFrame& frame : frames) rig.drive.receive(frame);
  rig.drive.observe({0.0, 0.0});
  rig.drive.update(DriveGoal::kEnabled, false, 0.1, 0.0, out);
  rig.drive.update(DriveGoal::kConfigure, true, 0.1, 0.0, out);
  for (int cycle = 0; cycle < 6000; ++cycle) {
    out.clear();
    rig.drive.observe({0.0, 0.0});
    rig.drive.update(DriveGoal::kConfigure, false, 0.0, 0.0, out);
  }
}

}  // namespace
}  // namespace tactus
