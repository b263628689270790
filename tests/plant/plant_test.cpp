#include "tactus/plant/plant.h"

#include <gtest/gtest.h>

#include "plant/scripted_master.h"
#include "support/allocation_guard.h"
#include "support/random.h"

namespace tactus {
namespace {

using test::canFrame;
using test::crops9Hardware;
using test::kPeriod_ns;
using test::kPeriod_s;
using test::ScriptedMaster;

/// A band at the cover from the start: the arm is in contact without having to move.
std::vector<ObstacleConfig> touching() {
  std::vector<ObstacleConfig> obstacles = test::scenario1();
  obstacles[0].x_m = 0.55;
  obstacles[0].y_m = -0.15;
  return obstacles;
}

class PlantOfReferenceRobot : public testing::Test {
 protected:
  void build(const std::vector<ObstacleConfig>& obstacles, std::vector<Trouble> troubles = {}) {
    plant_.emplace(robot_, test::crops9Plant(obstacles), hardware_, kPeriod_s, std::move(troubles));
    master_.emplace(*plant_, hardware_);
  }

  ControllerConfig robot_ = test::crops9Controller(Variant::kNullSpace);
  HardwareConfig hardware_ = crops9Hardware();
  std::optional<Plant> plant_;
  std::optional<ScriptedMaster> master_;
};

TEST_F(PlantOfReferenceRobot, IsBroughtToOperationByAMasterOfTheStandard) {
  build({});
  EXPECT_FALSE(plant_->wasEnabled());
  master_->start();
  EXPECT_TRUE(plant_->wasEnabled());
  master_->cycles(50);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(master_->status(i) & 0x6F, 0x27);
    EXPECT_NEAR(master_->position(i), robot_.q_start[i], 1e-6) << "starts at the start pose";
    EXPECT_EQ(plant_->drive(i).nmtState(), NodeState::kOperational);
  }
  for (int bus = 0; bus < 3; ++bus)
    for (std::uint32_t node = 1; node <= 3; ++node) {
      EXPECT_EQ(master_->timesHeard(bus, 0x80 + node), 0) << "an emergency";
      EXPECT_GE(master_->timesHeard(bus, 0x700 + node), 4) << "boot-up and heartbeats";
    }
  EXPECT_EQ(plant_->counters().frames_refused, 0u);
  EXPECT_EQ(plant_->counters().stale_setpoints_applied, 0u);
}

TEST_F(PlantOfReferenceRobot, GivesFeedbackOfEveryDriveInEveryCycle) {
  build({});
  master_->start();
  master_->cycles(2);
  const int before = master_->feedbacks(0);
  for (int cycle = 1; cycle <= 1000; ++cycle) {
    master_->cycle();
    for (int i = 0; i < 9; ++i) ASSERT_EQ(master_->feedbacks(i), before + cycle) << cycle;
  }
  EXPECT_EQ(plant_->counters().frames_not_taken, 0u);
}

TEST_F(PlantOfReferenceRobot, MovesAsItsSetpointsSay) {
  build({});
  PlantConfig ideal = test::crops9Plant({});
  ideal.drive_lag_s = 0.0;
  plant_.emplace(robot_, ideal, hardware_, kPeriod_s, std::vector<Trouble>{});
  master_.emplace(*plant_, hardware_);
  master_->start();
  for (int i = 0; i < 9; ++i) master_->setVelocity(i, 0.02 * (i - 4));
  master_->cycles(1000);
  for (int i = 0; i < 9; ++i) {
    master_->setVelocity(i, 0.0);
    EXPECT_EQ(plant_->drive(i).velocity(), 0.02 * (i - 4));
  }
  master_->cycles(3);
  RobotInput seen;
  SimulatedRobot world = plant_->world();
  world.read(seen);
  for (int i = 0; i < 9; ++i) {
    EXPECT_NEAR(seen.q_measured[i], robot_.q_start[i] + 0.02 * (i - 4), 1e-9);
    EXPECT_NEAR(master_->position(i), seen.q_measured[i], 0.6e-6);
  }
}

TEST_F(PlantOfReferenceRobot, CountsDrivesThatAreToldToLetGoWhileTheyMove) {
  build({});
  master_->start();
  for (const int drive : {2, 4}) master_->setVelocity(drive, 0.05);
  master_->cycles(20);
  EXPECT_EQ(plant_->counters().powers_taken_in_motion, 0u);
  master_->control_word = 0x00;
  master_->cycles(5);
  EXPECT_EQ(plant_->counters().powers_taken_in_motion, 2u) << "the others stood still";
  EXPECT_GT(plant_->drive(4).velocity(), 0.04) << "nobody holds it";
}

TEST_F(PlantOfReferenceRobot, AQuickStopTakesNoPowerInMotion) {
  build({});
  master_->start();
  master_->setVelocity(4, 0.05);
  master_->cycles(20);
  master_->control_word = 0x02;
  master_->cycles(500);
  EXPECT_EQ(plant_->powerState(4), PowerState::kSwitchOnDisabled);
  EXPECT_EQ(plant_->counters().powers_taken_in_motion, 0u);
}

TEST_F(PlantOfReferenceRobot, FeedbackComesTwoCyclesAfterTheSetpointWhateverThePhase) {
  PlantConfig ideal = test::crops9Plant({});
  ideal.drive_lag_s = 0.0;
  for (int tenths = 0; tenths < 10; ++tenths) {
    plant_.emplace(robot_, ideal, hardware_, kPeriod_s, std::vector<Trouble>{});
    master_.emplace(*plant_, hardware_);
    master_->phase_ns = tenths * kPeriod_ns / 10;
    master_->start();
    master_->cycles(10);
    master_->setVelocity(0, 0.1);
    master_->cycle();  // the setpoint goes out
    master_->setVelocity(0, 0.0);
    master_->cycle();  // it has moved the arm; this cycle's SYNC asks where it is
    EXPECT_NEAR(master_->position(0), robot_.q_start[0], 1e-6);
    master_->cycle();
    EXPECT_NEAR(master_->position(0), robot_.q_start[0] + 1e-4, 1e-6);
  }
}

/// The four frames of each sample, decoded as a reader would.
struct Decoded {
  int sequence;
  Eigen::Vector4d wrench;
};

std::vector<Decoded> decode(const std::vector<CanFrame>& frames, const HardwareConfig& hardware) {
  std::vector<Decoded> samples;
  Eigen::Matrix<double, 8, 1> channels;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const unsigned k = frames[i].id - hardware.tactile_modules.front().first_id;
    EXPECT_EQ(k, i % 4) << "out of order";
    EXPECT_EQ(frames[i].data[0], frames[i - k].data[0]) << "mixed samples";
    EXPECT_EQ(frames[i].data[1], 0);
    for (unsigned half = 0; half < 2; ++half) {
      const auto raw = test::number(frames[i], static_cast<int>(2 + 3 * half), 3) << 8;
      channels[2 * k + half] = (static_cast<std::int32_t>(raw) >> 8) /
                               hardware.tactile_modules.front().channels.counts_per_N;
    }
    if (k == 3)
      samples.push_back(
          {frames[i].data[0], hardware.tactile_modules.front().channels.calibration * channels});
  }
  return samples;
}

TEST_F(PlantOfReferenceRobot, ContactAppearsInTheTactileFramesAsTheModuleMeasuredIt) {
  build(touching());
  std::vector<CanFrame> frames;
  int checked = 0;
  for (std::int64_t t_ns = 0; t_ns < 2000 * kPeriod_ns; t_ns += kPeriod_ns) {
    plant_->advance(t_ns);
    FrameBatch batch;
    plant_->take(3, batch);
    frames.insert(frames.end(), batch.begin(), batch.end());
    const auto samples = decode(frames, hardware_);
    if (frames.size() % 4 != 0 || samples.empty()) continue;
    SimulatedRobot world = plant_->world();
    RobotInput seen;
    world.read(seen);
    if (static_cast<std::uint8_t>(seen.tactile[0].sequence) != samples.back().sequence) continue;
    const TactileSample& s = seen.tactile[0];
    const Eigen::Vector4d measured(s.force_y_N, s.force_z_N, s.moment_y_Nm, s.moment_z_Nm);
    ASSERT_EQ(samples.back().wrench, measured) << "lost a bit";
    ++checked;
  }
  EXPECT_GT(checked, 400);
  const auto samples = decode(frames, hardware_);
  EXPECT_EQ(samples.size(), 500u) << "one each 4 ms";
  for (std::size_t i = 1; i < samples.size(); ++i)
    EXPECT_EQ(samples[i].sequence, (samples[i - 1].sequence + 1) % 256);
  EXPECT_GT(samples.back().wrench.head<2>().norm(), 0.5) << "no contact";
  EXPECT_NEAR(samples.back().wrench.head<2>().norm(), plant_->world().trueForce_N(), 1e-3);
}

TEST_F(PlantOfReferenceRobot, SendsUnfilteredSamplesWhereTheDaemonFilters) {
  hardware_.tactile_modules.front().filter_cutoff_hz = 15.0;
  hardware_.tactile_modules.front().channels.sample_period_s = 0.001;
  build(touching());
  plant_->advance(9 * kPeriod_ns);
  FrameBatch batch;
  plant_->take(3, batch);
  const auto samples = decode({batch.begin(), batch.end()}, hardware_);
  ASSERT_GE(samples.size(), 8u);
  for (const Decoded& sample : samples)
    EXPECT_NEAR(sample.wrench.head<2>().norm(), plant_->world().trueForce_N(), 1e-3);
}

TEST_F(PlantOfReferenceRobot, AModuleAtItsLimitsSaysSo) {
  std::vector<ObstacleConfig> obstacles = touching();
  obstacles[0].stiffness_N_per_m = 1e9;
  PlantConfig world = test::crops9Plant(obstacles);
  world.robot_stiffness_N_per_m = kNoLimit;
  plant_.emplace(robot_, world, hardware_, kPeriod_s, std::vector<Trouble>{});
  plant_->advance(200 * kPeriod_ns);
  FrameBatch batch;
  plant_->take(3, batch);
  ASSERT_FALSE(batch.empty());
  EXPECT_EQ((batch.end() - 1)->data[1] & 1, 1);
}

TEST_F(PlantOfReferenceRobot, NoSampleIsCutInTwoByTheMastersWakingWhateverThePhase) {
  for (int tenths = 0; tenths < 10; ++tenths) {
    build({});
    master_->phase_ns = tenths * kPeriod_ns / 10;
    master_->start();
    master_->cycles(8);
    master_->forget();
    for (int cycle = 0; cycle < 400; ++cycle) {
      master_->cycle();
      ASSERT_EQ(master_->timesHeard(3, 0x100), master_->timesHeard(3, 0x103)) << "cut in two";
    }
    EXPECT_EQ(master_->timesHeard(3, 0x103), 100);
  }
}

TEST_F(PlantOfReferenceRobot, ObstaclesCountTheirTimeFromEnabling) {
  std::vector<ObstacleConfig> obstacles = touching();
  obstacles[0].appears_s = 0.5;
  build(obstacles);
  master_->start();
  master_->cycles(400);
  EXPECT_EQ(plant_->world().trueForce_N(), 0.0);
  master_->cycles(150);
  EXPECT_GT(plant_->world().trueForce_N(), 0.1);
}

/// Five drives on one bus need 1205 of 1000 bits a cycle, four 975.
TEST_F(PlantOfReferenceRobot, FourDrivesFillABusAndAFifthIsTooMuch) {
  for (const int count : {4, 5}) {
    hardware_ = crops9Hardware();
    hardware_.drives.resize(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
      hardware_.drives[i].bus = 0;
      hardware_.drives[i].node_id = i + 1;
    }
    build({});
    master_->start();
    const int before = master_->feedbacks(0);
    master_->cycles(300);
    if (count == 4) {
      EXPECT_EQ(plant_->counters().frames_refused, 0u);
      for (int i = 0; i < 4; ++i) EXPECT_GE(master_->feedbacks(i), before + 299);
    } else {
      EXPECT_GT(plant_->counters().frames_refused, 100u);
      EXPECT_LT(master_->feedbacks(0), before + 290) << "SYNCs never came";
    }
  }
}

TEST_F(PlantOfReferenceRobot, TimesOfEventsNeverGoBack) {
  build(test::scenario1());
  test::Random random(841);
  std::int64_t t_ns = 0;
  for (int i = 0; i < 20000; ++i) {
    const std::int64_t next_ns = plant_->nextEvent_ns();
    ASSERT_GE(next_ns, t_ns);
    t_ns = random.chance(0.5) ? next_ns : t_ns + random.integer(0, 200'000);
    if (random.chance(0.3)) {
      CanFrame frame = canFrame(static_cast<std::uint32_t>(random.index(0x800)), {});
      frame.size = static_cast<std::uint8_t>(random.index(9));
      for (std::uint8_t& byte : frame.data) byte = static_cast<std::uint8_t>(random.index(256));
      plant_->send(random.index(4), frame, t_ns);
    } else {
      plant_->advance(t_ns);
    }
    ASSERT_GT(plant_->nextEvent_ns(), t_ns - 1);
  }
}

TEST_F(PlantOfReferenceRobot, IgnoresWhatCannotBeSent) {
  build({});
  CanFrame frame = canFrame(0x24, {});
  frame.kind = FrameKind::kError;
  plant_->send(0, frame, 0);
  plant_->send(-1, canFrame(0, {1, 0}), 0);
  plant_->send(4, canFrame(0, {1, 0}), 0);
  frame = canFrame(0x201, {});
  frame.size = 9;
  plant_->send(0, frame, 0);
  EXPECT_EQ(plant_->bus(0).waiting(PlantBus::kOtherSide), 0u);
}

TEST_F(PlantOfReferenceRobot, HowOftenItIsAskedChangesNothing) {
  std::vector<CanFrame> heard[2];
  for (const bool often : {false, true}) {
    build(touching());
    for (int cycle = 0; cycle < 300; ++cycle) {
      const std::int64_t t_ns = cycle * kPeriod_ns;
      plant_->send(0, canFrame(0x80, {}), t_ns);
      plant_->send(0, canFrame(0, {1, 0}), t_ns);
      for (std::int64_t step_ns = 0; often && step_ns < kPeriod_ns; step_ns += 7919)
        plant_->advance(t_ns + step_ns);
      plant_->advance(t_ns + kPeriod_ns - 1);
      for (int bus = 0; bus < 4; ++bus) {
        FrameBatch batch;
        plant_->take(bus, batch);
        heard[often].insert(heard[often].end(), batch.begin(), batch.end());
      }
    }
  }
  EXPECT_GT(heard[0].size(), 300u);
  EXPECT_EQ(heard[0], heard[1]);
}

TEST_F(PlantOfReferenceRobot, TouchesNoHeapWhileItRuns) {
  build(touching(), {{Trouble::Kind::kReorder, 0.0, 1.0, 0, 0, 0.0},
                     {Trouble::Kind::kDelay, 0.0, 1.0, 1, 0, 0.003}});
  master_->start();
  FrameBatch batch;
  std::int64_t t_ns = master_->t_ns();
  for (int cycle = 0; cycle < 500; ++cycle) {
    t_ns += kPeriod_ns;
    test::AllocationGuard guard;
    plant_->send(0, canFrame(0x80, {}), t_ns);
    plant_->advance(t_ns + kPeriod_ns / 2);
    for (int bus = 0; bus < 4; ++bus) plant_->take(bus, batch);
  }
  EXPECT_TRUE(plant_->wasEnabled());
}

TEST_F(PlantOfReferenceRobot, LosesWhatNobodyTakesAndCountsIt) {
  build({});
  plant_->advance(2'000'000'000);
  FrameBatch batch;
  plant_->take(3, batch);
  EXPECT_EQ(batch.size(), FrameBatch::kCapacity);
  EXPECT_EQ(plant_->counters().frames_not_taken, 4u * 500u - FrameBatch::kCapacity);
  plant_->take(3, batch);
  EXPECT_TRUE(batch.empty());
}

}  // namespace
}  // namespace tactus
