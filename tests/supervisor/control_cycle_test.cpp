#include "tactus/supervisor/control_cycle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "support/allocation_guard.h"
#include "support/random.h"
#include "support/shipped_scene.h"
#include "support/virtual_robot_cell.h"
#include "tactus/record/fault_text.h"
#include "tactus/record/replay.h"

namespace tactus {
namespace {

using test::shippedScene;
using test::VirtualRobotCell;

ModeReport bootWith(Scene scene, const std::function<void(VirtualRobotCell&)>& prepare) {
  VirtualRobotCell cell(scene);
  prepare(cell);
  for (int i = 0; i < 8000 && !cell.cycle.isFinished(); ++i) {
    cell.step();
    EXPECT_EQ(cell.largestSetpoint(), 0);
    EXPECT_NE(cell.cycle.report().mode, Mode::kRunning);
  }
  EXPECT_TRUE(cell.cycle.isFinished());
  return cell.cycle.report();
}

TEST(ControlCycleBoot, RefusesToTareInContact) {
  const auto press = [](VirtualRobotCell& cell) {
    cell.on_frame = [](int bus, CanFrame& frame) {
      if (bus == 3 && frame.id == 0x100) frame.data[4] = 5;  // 3.3 N
    };
  };
  EXPECT_EQ(bootWith(shippedScene("scenario1_null_space"), press).fault, Fault::kTareRefused);
}

/// Whatever memory held before.
TEST(ControlCycleBoot, CommandsNoSpeedBeforeItsFirstCycleOfMotion) {
  struct alignas(VirtualRobotCell) Memory {
    unsigned char bytes[sizeof(VirtualRobotCell)];
  };
  const auto memory = std::make_unique<Memory>();
  volatile unsigned char* const bytes = memory->bytes;
  for (std::size_t i = 0; i < sizeof(VirtualRobotCell); ++i) bytes[i] = 0x41;  // numbers of 2e6
  auto* const cell = new (memory->bytes) VirtualRobotCell(shippedScene("scenario1_null_space"));
  int largest = 0;
  for (int i = 0; i < 5000 && !cell->runUntil(Mode::kRunning, 1); ++i)
    largest = std::max(largest, cell->largestSetpoint());
  EXPECT_EQ(cell->cycle.report().mode, Mode::kRunning);
  EXPECT_EQ(largest, 0);
  std::destroy_at(cell);
}

/// Drives that are being set up may shake what carries the sensor.
TEST(ControlCycleBoot, TaresOnceTheDrivesAreSetUp) {
  VirtualRobotCell cell(shippedScene("scenario1_null_space"));
  int cycles = 0;
  cell.on_frame = [&](int bus, CanFrame& frame) {
    if (bus == 3 && frame.id == 0x100 && cycles < 30) frame.data[4] = 5;  // 3.3 N
  };
  for (; cycles < 4000 && cell.cycle.report().mode != Mode::kRunning; ++cycles) cell.step();
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning) << faultName(cell.cycle.report().fault);
}

/// What a cover weighs on its module depends on where the joints are.
TEST(ControlCycleBoot, TaresNeitherBeforeDrivesAreSetUpNorBeforeTheirPlacesAreKnown) {
  VirtualRobotCell cell(shippedScene("scenario1_null_space"));
  const CanRobot& robot = cell.cycle.robot();
  int early = 0;
  while (cell.cycle.report().mode == Mode::kBoot && cell.t_ns < 4'000'000'000) {
    cell.step();
    const bool is_configured = robot.drives().are_configured;
    if (is_configured && robot.hasPositions()) continue;
    early += is_configured || robot.hasPositions() ? 1 : 0;
    for (const TactileReceiver& module : robot.tactileModules())
      ASSERT_EQ(module.tareState(), TareState::kNone) << cell.t_ns;
  }
  EXPECT_NE(cell.cycle.report().mode, Mode::kFault) << faultName(cell.cycle.report().fault);
  EXPECT_GT(early, 0) << "this test is blind";
}

/// Nor in a fault, whatever drives and joints say meanwhile: the next boot does it.
TEST(ControlCycleBoot, TaresNotInAFault) {
  Scene scene = shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace().enable.emplace();
  VirtualRobotCell cell(scene);
  const CanRobot& robot = cell.cycle.robot();
  while (!robot.drives().are_configured && !robot.hasPositions() && cell.t_ns < 4'000'000'000)
    cell.step();
  ASSERT_NE(robot.drives().are_configured, robot.hasPositions());
  cell.input.lines.emergency_stop = true;
  for (int i = 0; i < 1000; ++i) {
    cell.step();
    ASSERT_EQ(cell.cycle.report().mode, Mode::kFault);
    ASSERT_EQ(robot.tactileModules()[0].tareState(), TareState::kNone) << i;
  }
  EXPECT_TRUE(robot.drives().are_configured && robot.hasPositions()) << "this test is blind";
}

TEST(ControlCycleBoot, RefusesAnArmThatIsNotAtTheStart) {
  Scene scene = shippedScene("scenario1_null_space");
  const Scene elsewhere = shippedScene("scenario1_null_space");
  VirtualRobotCell cell(elsewhere);
  scene.controller.q_start[2] += 1.2 * scene.hardware->start_tolerance;  // not as far away
  scene.controller.q_start[4] += 1.5 * scene.hardware->start_tolerance;
  cell.cycle = ControlCycle(scene.controller, *scene.hardware, scene.period_s);
  for (int i = 0; i < 8000 && !cell.cycle.isFinished(); ++i) {
    cell.step();
    ASSERT_NE(cell.cycle.report().mode, Mode::kReady) << i;
  }
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNotAtStart);
  // Where it is: at the plant's start, which is home.
  EXPECT_NE(describeMode(cell.cycle.report(), scene)
                .find("joint j5 is at 0.44598 rad, expected within 0.02 of 0.47598: "),
            std::string::npos)
      << describeMode(cell.cycle.report(), scene);
}

/// Within its tolerance it starts from where it is: drives follow that, and not the scene's start.
TEST(ControlCycleBoot, TakesAnArmForWhereItIs) {
  Scene scene = shippedScene("scenario1_null_space");
  VirtualRobotCell cell(scene);
  const double off = 1.5 * scene.hardware->drives[4].max_following_error;
  scene.hardware->start_tolerance = 2.0 * off;
  scene.controller.q_start[4] += off;
  cell.cycle = ControlCycle(scene.controller, *scene.hardware, scene.period_s);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
  EXPECT_NEAR(cell.record().q[4], scene.controller.q_start[4] - off, 1e-3);
  for (int i = 0; i < 100; ++i) cell.step();
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNone) << faultName(cell.cycle.report().fault);
}

/// Of the first 0.5 s, of an arm that stands so many tolerances beside its start.
double fastestAtItsStart(double tolerances) {
  Scene scene = shippedScene("scenario1_null_space", {{"task.drift_gain_per_s", "200"}});
  VirtualRobotCell cell(scene);
  for (int joint = 0; joint < 9; ++joint)
    scene.controller.q_start[joint] +=
        (joint % 2 == 0 ? tolerances : -tolerances) * scene.hardware->start_tolerance;
  cell.cycle = ControlCycle(scene.controller, *scene.hardware, scene.period_s);
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 5000)) << faultName(cell.cycle.report().fault);
  const Controller controller(scene.controller);
  Replayer replayer(controller, 9, scene.period_s);
  ReplayComparison comparison(RecordShape{9, 3});
  double fastest = 0.0;
  for (int i = 0; i < 500; ++i, cell.step()) {
    const CycleRecord record = cell.record();
    comparison.add(record, replayer.replay(record));
    for (int joint = 0; joint < 9; ++joint) fastest = std::max(fastest, std::abs(record.dq[joint]));
  }
  EXPECT_EQ(comparison.differingCycles(), 0);
  EXPECT_EQ(cell.cycle.report().fault, Fault::kNone) << faultName(cell.cycle.report().fault);
  return fastest;
}

/// As one that its drives had let go.
TEST(ControlCycleBoot, LeadsAnArmGentlyToItsPathFromBesideItsStart) {
  EXPECT_LT(fastestAtItsStart(0.0), 0.01) << "the path does not begin slowly: this test is blind";
  EXPECT_LT(fastestAtItsStart(0.9), 0.2);
}

TEST(ControlCycleBoot, NamesTheDriveThatDoesNotAnswer) {
  const auto mute = [](VirtualRobotCell& cell) {
    cell.on_frame = [](int bus, CanFrame& frame) {
      if (bus == 2 && frame.id == 0x582) frame.id = 0x7FF;
    };
  };
  const ModeReport report = bootWith(shippedScene("scenario1_null_space"), mute);
  EXPECT_EQ(report.fault, Fault::kDriveSetupRefused);
  EXPECT_EQ(report.joint, 7);
  EXPECT_EQ(report.drive.setup_failure.abort_code, 0u);
}

TEST(ControlCycleBoot, NamesTheObjectThatADriveRefuses) {
  const auto refuse = [](VirtualRobotCell& cell) {
    cell.on_frame = [](int bus, CanFrame& frame) {
      const bool is_mode = frame.data[1] == 0x60 && frame.data[2] == 0x60;
      if (bus != 0 || frame.id != 0x581 || !is_mode) return;
      frame.data = {0x80, 0x60, 0x60, 0, 0x30, 0, 0x09, 0x06};  // 0609 0030
    };
  };
  const ModeReport report = bootWith(shippedScene("scenario1_null_space"), refuse);
  EXPECT_EQ(report.fault, Fault::kDriveSetupRefused);
  EXPECT_EQ(report.joint, 0);
  EXPECT_EQ(report.drive.setup_failure.index, 0x6060);
  EXPECT_EQ(report.drive.setup_failure.abort_code, 0x06090030u);
}

TEST(ControlCycleBoot, NeedsSamplesOfTheModule) {
  const auto mute = [](VirtualRobotCell& cell) {
    cell.on_frame = [](int bus, CanFrame& frame) {
      if (bus == 3) frame.id = 0x7FF;
    };
  };
  EXPECT_EQ(bootWith(shippedScene("scenario1_null_space"), mute).fault, Fault::kTactileStale);
}

TEST(ControlCycleStop, EndsAtRestWithDrivesOffFromEveryMoment) {
  for (const int after : {0, 1, 5, 40, 100, 200, 260, 280, 300, 320, 340, 400, 4000}) {
    VirtualRobotCell cell(shippedScene("scenario1_multi_space"));
    for (int i = 0; i < after; ++i) cell.step();
    cell.input.stop_requested = true;
    int cycles = 0;
    for (; cycles < 1000 && !cell.cycle.isFinished(); ++cycles) cell.step();
    EXPECT_TRUE(cell.cycle.isFinished()) << after;
    EXPECT_LE(cycles, 50) << after;
    EXPECT_EQ(cell.cycle.report().fault, Fault::kNone) << after;
    EXPECT_TRUE(cell.areDrivesOff()) << after;
    for (int i = 0; i < 200; ++i) cell.plant.advance(cell.t_ns += 1'000'000);
    for (int joint = 0; joint < 9; ++joint) {
      EXPECT_NE(cell.plant.drive(joint).powerState(), PowerState::kFault)
          << "the end of the master's heartbeat is no fault";
    }
    EXPECT_FALSE(cell.cycle.lines().release_brake);
  }
}

TEST(ControlCycleBrake, OpensBeforeMotionAndClosesBeforeDrivesLetGo) {
  Scene scene = shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->brake.emplace();
  scene.hardware->gpio->brake_switching_s = 0.15;
  VirtualRobotCell cell(scene);
  int open_cycles = 0;
  for (int i = 0; i < 5000 && cell.cycle.report().mode != Mode::kRunning; ++i) {
    open_cycles += cell.cycle.lines().release_brake ? 1 : 0;
    EXPECT_TRUE(!cell.cycle.lines().release_brake || !cell.areDrivesLimp());
    cell.step();
  }
  EXPECT_GE(open_cycles, 150);
  for (int i = 0; i < 2000; ++i) cell.step();
  cell.input.stop_requested = true;
  int closed_cycles = 0;
  for (int i = 0; i < 1000 && !cell.cycle.isFinished(); ++i) {
    cell.step();
    closed_cycles += !cell.cycle.lines().release_brake && !cell.areDrivesLimp() ? 1 : 0;
  }
  EXPECT_TRUE(cell.cycle.isFinished());
  EXPECT_GE(closed_cycles, 150);
}

TEST(ControlCycleHold, KeepsTheTasksClockAndGoesOnWhereItWas) {
  Scene scene = shippedScene("scenario1_null_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 3000; ++i) cell.step();
  cell.input.lines.enable = false;
  for (int i = 0; i < 20; ++i) cell.step();
  const CycleRecord held = cell.record();
  for (int i = 0; i < 2000; ++i) cell.step();
  const CycleRecord later = cell.record();
  EXPECT_EQ(later.task_time_s, held.task_time_s);
  EXPECT_NEAR(later.t_s - held.t_s, 2.0, 1e-9);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(later.q[i], held.q[i]);
    EXPECT_EQ(later.dq[i], 0.0);
  }
  cell.input.lines.enable = true;
  double fastest = 0.0;
  for (int i = 0; i < 3000; ++i) {
    cell.step();
    for (int k = 0; k < 9; ++k) fastest = std::max(fastest, std::abs(cell.record().dq[k]));
  }
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  EXPECT_LT(fastest, 0.5) << "no jump to make up for the time at rest";
}

/// A whole run with a hold, missed cycles and an end, cycle by cycle.
std::vector<CycleRecord> eventfulRun(const Scene& scene) {
  VirtualRobotCell cell(scene);
  std::vector<CycleRecord> records;
  for (int i = 0; i < 9000 && !cell.cycle.isFinished(); ++i) {
    cell.input.lines.enable = i < 5000 || i > 5200;
    cell.input.missed_cycles = i == 4000 || i == 6000 ? 3 : 0;
    cell.input.stop_requested = i > 8000;
    cell.step();
    if (cell.cycle.isRecorded()) records.push_back(cell.record());
  }
  EXPECT_TRUE(cell.cycle.isFinished());
  return records;
}

TEST(ControlCycleReplay, EveryOutputIsEqualToTheBit) {
  Scene scene = shippedScene("scenario2_estimated");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  const std::vector<CycleRecord> records = eventfulRun(scene);
  ASSERT_GT(records.size(), 7000u);
  const Controller controller(scene.controller);
  Replayer replayer(controller, 9, scene.period_s);
  ReplayComparison comparison({9, 3});
  for (const CycleRecord& record : records) comparison.add(record, replayer.replay(record));
  EXPECT_EQ(comparison.differingCycles(), 0)
      << comparison.first()->column << " in cycle " << comparison.first()->cycle;
}

/// With an e-stop at one time, after which the drives are configured anew and the task goes on.
std::vector<CycleRecord> restartedRun(const Scene& scene, int stop) {
  VirtualRobotCell cell(scene);
  std::vector<CycleRecord> records;
  for (int i = 0; i < 8000; ++i) {
    cell.input.lines.emergency_stop = i >= stop && i < stop + 100;
    cell.input.missed_cycles = i == stop ? 3 : 0;
    cell.input.lines.enable = i < stop || i > stop + 500;
    cell.step();
    if (cell.cycle.isRecorded()) records.push_back(cell.record());
  }
  EXPECT_EQ(cell.cycle.report().mode, Mode::kRunning);
  return records;
}

/// With 400 records missing some time before the fault.
void replayWithAGap(const std::string& name, int stop) {
  Scene scene = shippedScene(name);
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  std::vector<CycleRecord> records = restartedRun(scene, stop);
  const auto fault = std::find_if(records.begin(), records.end(), [](const CycleRecord& record) {
    return record.mode == static_cast<std::uint64_t>(Mode::kFault);
  });
  ASSERT_GT(records.end() - fault, 3000);
  const double fault_s = fault->t_s;
  ASSERT_GT(fault - records.begin(), 2700);
  records.erase(fault - 2700, fault - 2300);
  const Controller controller(scene.controller);
  Replayer replayer(controller, 9, scene.period_s);
  ReplayComparison comparison({9, 3});
  for (const CycleRecord& record : records) {
    const CycleRecord replayed = replayer.replay(record);
    replayer.isKnown() ? comparison.add(record, replayed) : comparison.skip();
  }
  EXPECT_EQ(comparison.differingCycles(), 0)
      << comparison.first()->column << " in cycle " << comparison.first()->cycle;
  EXPECT_EQ(comparison.skipped(), 2300);
  EXPECT_GT(comparison.cycles(), 4000);
  ASSERT_EQ(replayer.unknown().size(), 1u);
  EXPECT_NEAR(replayer.unknown()[0].from_s, fault_s - 2.703, 1e-9);
  EXPECT_NEAR(replayer.unknown()[0].to_s, fault_s - 0.004, 1e-9);
}

TEST(ControlCycleReplay, GoesOnToTheBitWhereTheControllerBeginsAnewBehindMissingRecords) {
  replayWithAGap("scenario2_estimated", 4000);
}

/// Which it took the weight of its cover out of by what it knew of the arm's motion.
TEST(ControlCycleReplay, ThenKnowsTheForceOfTheLastSample) {
  for (int stop = 4000; stop < 4004; ++stop)  // samples come each fourth cycle
    replayWithAGap("whole_arm/crops9_skin_two_links", stop);
}

TEST(ControlCycleReplay, MissedCyclesAreNoMissingRecords) {
  Scene scene = shippedScene("scenario2_estimated");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  const std::vector<CycleRecord> records = eventfulRun(scene);
  std::uint64_t missed = 0;
  double before_s = -scene.period_s;
  LogContinuity continuity(scene.controller, scene.period_s, true);
  for (const CycleRecord& record : records) {
    missed += record.missed_cycles;
    EXPECT_NEAR(record.t_s - before_s,
                (1.0 + static_cast<double>(record.missed_cycles)) * scene.period_s, 1e-9);
    before_s = record.t_s;
    EXPECT_TRUE(continuity.add(record)) << record.t_s;
  }
  EXPECT_EQ(missed, 6u);
  EXPECT_TRUE(continuity.stretches().empty());
}

TEST(ControlCycleMissed, TheDrivesAreWhereTheControllerThinksTheyAre) {
  for (const int missed : {1, 2}) {
    VirtualRobotCell cell(shippedScene("scenario1_null_space"));
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    for (int i = 0; i < 6000; ++i) {
      const bool is_missed = i % 50 == 49;
      if (is_missed) {  // the world goes on without the daemon for so many periods
        cell.plant.advance(cell.t_ns += missed * 1'000'000LL);
        cell.input.missed_cycles = missed;
      }
      cell.step();
      cell.input.missed_cycles = 0;
      ASSERT_EQ(cell.cycle.report().mode, Mode::kRunning) << faultName(cell.cycle.report().fault);
    }
    const CycleRecord record = cell.record();
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(record.q[i], record.q_measured[i], 0.002) << i;
  }
}

/// Drives stop where the daemon is silent for their time: of that, what was missed is a part.
TEST(ControlCycleMissed, TellsDrivesInTimeThatItRuns) {
  VirtualRobotCell cell(shippedScene("scenario1_null_space"));
  int heartbeats = 0;
  cell.on_send = [&](int bus, CanFrame& frame) {
    heartbeats += bus == 0 && frame.id == 0x77F ? 1 : 0;
    return true;
  };
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  const auto untilHeartbeat = [&](int missed) {
    const int before = heartbeats;
    int cycles = 0;
    for (; cycles < 1000 && heartbeats == before; ++cycles) {
      cell.input.missed_cycles = cycles == 1 ? missed : 0;
      cell.step();
    }
    return cycles;
  };
  untilHeartbeat(0);
  const int cycles = untilHeartbeat(0);
  EXPECT_GT(cycles, 5);
  EXPECT_EQ(untilHeartbeat(3), cycles - 3);
  EXPECT_EQ(untilHeartbeat(0), cycles);
}

TEST(ControlCycleAllocation, NoneFromTheFirstCycleToTheLast) {
  Scene scene = shippedScene("scenario2_estimated");
  VirtualRobotCell cell(scene);
  for (int i = 0; i < 6000 && !cell.cycle.isFinished(); ++i) {
    cell.input.stop_requested = i > 5500;
    cell.exchangeInput();
    {
      const test::AllocationGuard guard;
      cell.cycle.update(cell.input);
    }
    cell.sendOutput();
  }
  EXPECT_TRUE(cell.cycle.isFinished());
}

CanFrame randomFrame(test::Random& random) {
  // Ids of drives, of the module and of nobody.
  static constexpr std::uint32_t kBases[] = {0x080, 0x180, 0x580, 0x700, 0x100, 0x000, 0x200};
  CanFrame frame;
  frame.id = kBases[random.index(7)] + static_cast<std::uint32_t>(random.integer(0, 4));
  frame.size = static_cast<std::uint8_t>(random.chance(0.8) ? (frame.id < 0x180 ? 8 : 6)
                                                            : random.integer(0, 8));
  for (std::uint8_t& byte : frame.data)
    byte = static_cast<std::uint8_t>(random.chance(0.5) ? random.integer(0, 255) : 0);
  if (random.chance(0.02)) frame.kind = FrameKind::kRemote;
  if (random.chance(0.02)) frame.extended = true;
  return frame;
}

TEST(ControlCycleHostile, RandomFramesNeverLeadBeyondTheLimits) {
  test::Random random(7);
  int ran_on = 0, rested = 0;
  for (int run = 0; run < 40; ++run) {
    Scene scene = shippedScene("scenario1_multi_space");
    VirtualRobotCell cell(scene);
    ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
    for (int i = 0; i < 300; ++i) cell.step();
    const double chance = random.logUniform(1e-4, 1.0);
    for (int i = 0; i < 500 && !cell.cycle.isFinished(); ++i) {
      for (int bus = 0; bus < 4; ++bus) {
        if (!random.chance(chance)) continue;
        const CanFrame frame = randomFrame(random);
        cell.cycle.receive(bus, {&frame, 1});
      }
      cell.step();
      const JointVector& limit = scene.controller.limits.max_velocity;
      for (int k = 0; k < 9; ++k) ASSERT_LE(std::abs(cell.record().dq[k]), limit[k]);
      for (int bus = 0; bus < 3; ++bus) {
        for (const CanFrame& frame : cell.cycle.outbox(bus)) {
          if (frame.id <= 0x200 || frame.id >= 0x280) continue;
          const int joint = 3 * bus + static_cast<int>(frame.id) - 0x201;
          const double largest = limit[joint] * scene.hardware->drives[joint].counts_per_unit + 1.0;
          ASSERT_LE(std::abs(VirtualRobotCell::velocityCounts(frame)), largest);
        }
      }
    }
    const bool is_running = cell.cycle.report().mode == Mode::kRunning;
    if (!is_running) {
      EXPECT_NE(cell.cycle.report().fault, Fault::kNone);
      for (int i = 0; i < 2500 && !cell.cycle.isFinished(); ++i) cell.step();
      EXPECT_TRUE(cell.cycle.isFinished());
      EXPECT_EQ(cell.largestSetpoint(), 0);
    }
    (is_running ? ran_on : rested) += 1;
  }
  EXPECT_GT(ran_on, 0);
  EXPECT_GT(rested, 0);
}

TEST(ControlCyclePowerCut, BringsNoStaleSetpointToADrive) {
  Scene scene = shippedScene("scenario1_multi_space");
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->enable.emplace();
  Trouble cut;
  cut.kind = Trouble::Kind::kPowerCut;
  cut.from_s = 5.0;
  cut.until_s = 10.0;
  cut.bus = 1;
  scene.troubles = {cut};
  VirtualRobotCell cell(scene);
  ASSERT_TRUE(cell.runUntil(Mode::kRunning, 5000));
  for (int i = 0; i < 4900; ++i) cell.step();
  ASSERT_EQ(cell.cycle.report().mode, Mode::kRunning);
  for (int i = 0; i < 7000; ++i) {
    cell.step();
    if (i > 200) {
      ASSERT_EQ(cell.largestSetpoint(), 0);
    }
  }
  EXPECT_EQ(cell.cycle.report().mode, Mode::kFault);
  EXPECT_EQ(cell.plant.counters().stale_setpoints_applied, 0u);
  for (int joint = 0; joint < 9; ++joint) EXPECT_EQ(cell.plant.drive(joint).velocity(), 0.0);
  cell.switchEnable();
  EXPECT_TRUE(cell.runUntil(Mode::kRunning, 3000)) << faultName(cell.cycle.report().fault);
}

}  // namespace
}  // namespace tactus
