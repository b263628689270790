#include "tactus/supervisor/joint_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/canopen/canopen.h"
#include "tactus/plant/plant.h"

/// Of both kinds of drives, of which the plant's stand elsewhere than the scene begins.
namespace tactus {
namespace {

struct ReadingRig {
  explicit ReadingRig(const char* name)
      : scene(test::shippedScene(name)), q(scene.controller.q_start) {
    for (int joint = 0; joint < q.size(); ++joint) q[joint] += joint % 2 == 0 ? 0.11 : -0.07;
    ControllerConfig elsewhere = scene.controller;
    elsewhere.q_start = q;
    plant.emplace(elsewhere, scene.plant, *scene.hardware, scene.period_s, scene.troubles);
    reader.emplace(*scene.hardware, scene.period_s);
    bus_faults.resize(scene.hardware->buses.size(), Fault::kNone);
  }

  void cycle() {
    plant->advance(t_ns);
    for (int bus = 0; bus < plant->buses(); ++bus) {
      FrameBatch frames;
      plant->take(bus, frames);
      if (is_silent && bus == 0) continue;
      FrameBatch heard;
      for (CanFrame frame : frames) {
        if (on_frame) on_frame(frame);
        heard.push(frame);
      }
      reader->receive(bus, heard.frames());
    }
    reader->update(bus_faults);
    for (int bus = 0; bus < plant->buses(); ++bus)
      for (const CanFrame& frame : reader->outbox(bus)) plant->send(bus, frame, t_ns + 100'000);
    t_ns += std::llround(1e9 * scene.period_s);
  }

  bool hasTorque() const {
    for (int joint = 0; joint < q.size(); ++joint)
      if (plant->powerState(joint) == PowerState::kOperationEnabled) return true;
    return false;
  }

  /// Within the time that drives have for their set-up.
  void readAll() {
    const double most_s = scene.hardware->canopen.boot_timeout_s + 1.0;
    for (double time_s = 0.0; time_s < most_s && !reader->isDone(); time_s += scene.period_s) {
      cycle();
      ASSERT_FALSE(hasTorque());
    }
    ASSERT_TRUE(reader->isDone());
  }

  Scene scene;
  JointVector q;
  std::optional<Plant> plant;
  std::optional<JointReader> reader;
  std::vector<Fault> bus_faults;
  std::function<void(CanFrame& frame)> on_frame;  ///< may change what is heard
  bool is_silent = false;
  std::int64_t t_ns = 0;
};

class Reading : public testing::TestWithParam<const char*>, public ReadingRig {
 protected:
  Reading() : ReadingRig(GetParam()) {}
};

TEST_P(Reading, FindsTheArm) {
  readAll();
  EXPECT_EQ(reader->report().fault, Fault::kNone);
  ASSERT_EQ(reader->q().size(), q.size());
  for (int joint = 0; joint < q.size(); ++joint)
    EXPECT_NEAR(reader->q()[joint], q[joint], 1e-4) << joint;
}

/// The daemon's set-up follows, and the arm begins where it was found. Without a farewell drives
/// would miss the heartbeat meanwhile.
TEST_P(Reading, LetsTheDrivesGoForWhoComesNext) {
  readAll();
  plant->advance(t_ns += 1'000'000'000);
  for (int joint = 0; joint < q.size(); ++joint)
    EXPECT_EQ(plant->powerState(joint), PowerState::kSwitchOnDisabled) << joint;
  Scene found = scene;
  found.controller.q_start = reader->q();
  test::VirtualRobotCell cell(found);
  cell.plant = *plant;
  cell.t_ns = t_ns;
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
  cell.step();
  for (int joint = 0; joint < q.size(); ++joint)
    EXPECT_NEAR(cell.cycle.robot().drive(joint).position, q[joint], 1e-3) << joint;
}

/// Of a daemon that was killed: the place is told once they have stopped, and are off.
TEST_P(Reading, WaitsForDrivesThatStillMove) {
  test::VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 2500; ++i) cell.step();
  plant = cell.plant;
  t_ns = cell.t_ns;
  ASSERT_TRUE(hasTorque());
  while (!reader->isDone() && t_ns < cell.t_ns + 10'000'000'000) cycle();
  ASSERT_EQ(reader->report().fault, Fault::kNone) << faultName(reader->report().fault);
  EXPECT_FALSE(hasTorque());
  const JointVector found = reader->q();
  reader.emplace(*scene.hardware, scene.period_s);
  plant->advance(t_ns += 1'000'000'000);
  while (!reader->isDone() && t_ns < cell.t_ns + 20'000'000'000) cycle();
  EXPECT_LT((reader->q() - found).cwiseAbs().maxCoeff(), 1e-3) << "at rest";
}

TEST_P(Reading, EndsWithADriveThatObeysNothing) {
  test::VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  plant = cell.plant;
  t_ns = cell.t_ns;
  const DriveConfig& drive = scene.hardware->drives[1];
  plant->play({{.kind = Trouble::Kind::kIgnoreCommands,
                .from_s = 0.0,
                .until_s = 1e6,
                .bus = drive.bus,
                .id = static_cast<std::uint32_t>(drive.node_id)}},
              t_ns);
  while (!reader->isDone() && t_ns < cell.t_ns + 10'000'000'000) cycle();
  ASSERT_TRUE(reader->isDone());
  if (reader->report().fault != Fault::kNone) {
    EXPECT_EQ(reader->report().joint, 1) << faultName(reader->report().fault);
  } else {
    EXPECT_FALSE(hasTorque()) << "it is off all the same";
  }
}

TEST_P(Reading, NamesADriveThatDoesNotAnswer) {
  is_silent = true;
  readAll();
  EXPECT_EQ(reader->report().fault, Fault::kDriveSetupRefused) << faultName(reader->report().fault);
  EXPECT_EQ(reader->report().joint, 0);
  EXPECT_NE(reader->report().drive.setup_failure.index, 0) << "what it was asked";
}

TEST_P(Reading, NamesABusThatIsDown) {
  bus_faults.back() = Fault::kBusDown;
  cycle();
  ASSERT_TRUE(reader->isDone());
  EXPECT_EQ(reader->report().fault, Fault::kBusDown);
  EXPECT_EQ(reader->report().bus, static_cast<int>(bus_faults.size()) - 1);
}

/// Its object 605A is one that stays in quick stop active.
TEST(ReadingOfCanopen, NamesADriveThatIsNeverOff) {
  ReadingRig rig("scenario1_tactus");
  const auto id =
      cob_id::kTpdo1 + static_cast<std::uint32_t>(rig.scene.hardware->drives[1].node_id);
  int shown = 0;
  rig.on_frame = [&](CanFrame& frame) {
    if (frame.id != id) return;
    frame.data[0] = 0x07;  // of the status word
    ++shown;
  };
  rig.readAll();
  EXPECT_EQ(rig.reader->report().fault, Fault::kDriveStateLost);
  EXPECT_EQ(rig.reader->report().joint, 1) << "the first one, with such an id on each bus";
  EXPECT_EQ(rig.reader->report().drive.state, DriveState::kQuickStopActive);
  const double deadline_s = rig.scene.hardware->canopen.stop_deadline_s;
  EXPECT_GE(shown, 3 * static_cast<int>(deadline_s / rig.scene.period_s)) << "it has its time";
}

INSTANTIATE_TEST_SUITE_P(Drives, Reading,
                         testing::Values("scenario1_tactus", "robots/planar2_moteus"));

}  // namespace
}  // namespace tactus
