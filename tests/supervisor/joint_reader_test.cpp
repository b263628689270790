#include "tactus/supervisor/joint_reader.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/plant/plant.h"

/// Of both kinds of drives, of which the plant's stand elsewhere than the scene begins.
namespace tactus {
namespace {

class Reading : public testing::TestWithParam<const char*> {
 protected:
  Reading() : scene(test::shippedScene(GetParam())), q(scene.controller.q_start) {
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
      if (!is_silent || bus != 0) reader->receive(bus, frames.frames());
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
  bool is_silent = false;
  std::int64_t t_ns = 0;
};

TEST_P(Reading, FindsTheArm) {
  readAll();
  EXPECT_EQ(reader->report().fault, Fault::kNone);
  ASSERT_EQ(reader->q().size(), q.size());
  for (int joint = 0; joint < q.size(); ++joint)
    EXPECT_NEAR(reader->q()[joint], q[joint], 1e-4) << joint;
}

/// The daemon's set-up follows, and the arm begins where it was found.
TEST_P(Reading, LetsTheDrivesGoForWhoComesNext) {
  readAll();
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

INSTANTIATE_TEST_SUITE_P(Drives, Reading,
                         testing::Values("scenario1_tactus", "robots/planar2_moteus"));

}  // namespace
}  // namespace tactus
