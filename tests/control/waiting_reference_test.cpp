#include <gtest/gtest.h>

#include "support/controller_run.h"
#include "support/period.h"
#include "support/rail_robot.h"
#include "tactus/control/path_progress.h"
#include "tactus/math/rotation.h"

/// The reference waits for a tool that is held back, and its clock forgets nothing.
namespace tactus {
namespace {

using test::kPeriod_s;
constexpr double kPathSpeed_m_per_s = 0.1;
constexpr double kPathRamp_s = 0.5;
constexpr double kWay_m = 0.4;
constexpr double kPathWaitsBeyond_m = 0.02;

/// A rail whose tool shall go 0.4 m and gets no faster than the two carriages together.
ControllerConfig railThatReaches(double tool_speed_m_per_s) {
  ControllerConfig config = test::railController(Variant::kNone);
  config.tactile_modules.clear();
  config.force_control.reset();
  config.limits.max_velocity.setConstant(0.5 * tool_speed_m_per_s);
  config.gains.task.drift_gain_per_s = 5.0;
  config.gains.task.wait_beyond_m = kPathWaitsBeyond_m;
  Waypoint line;
  line.displacement_m = Vector3(0.0, kWay_m, 0.0);
  line.speed_m_per_s = kPathSpeed_m_per_s;
  line.ramp_s = kPathRamp_s;
  config.task.trajectory = {0.1, {line}};
  return config;
}

/// A tool on its way, whose carriages change their speed limit with the controller that moves it.
struct RailRun {
  ControllerState state = Controller(railThatReaches(1.0)).initialState();
  ControllerOutput output;
  double t_s = 0.0;
  double largest_lag_m = 0.0;

  void step(const Controller& controller) {
    controller.update({}, controller.initialGains(), t_s, kPeriod_s, state, output);
    if (!state.is_stopping) t_s += kPeriod_s;
    largest_lag_m = std::max(largest_lag_m, output.error.norm());
  }

  void run(const Controller& controller, double duration_s) {
    for (double s = 0.0; s < duration_s; s += kPeriod_s) step(controller);
  }
};

TEST(WaitingReference, StandsStillWhileTheToolIsHeld) {
  const Controller held(railThatReaches(1e-9));
  RailRun rail;
  rail.run(held, 60.0);
  const double w_d = rail.output.w_d[0];
  EXPECT_GT(w_d, kPathWaitsBeyond_m);
  rail.run(held, 1.0);
  EXPECT_LT(rail.largest_lag_m, 2.0 * kPathWaitsBeyond_m + 1e-6);
  EXPECT_LT(rail.output.w_d[0] - w_d, 1e-5);
  EXPECT_LT(rail.output.w_d_dot[0], 1e-5);
  EXPECT_LT(rail.output.path_time_s, 2.0) << "of 61 s";
}

TEST(WaitingReference, GoesOnToTheEndOfItsPathOnceTheToolIsFree) {
  const Controller held(railThatReaches(1e-9));
  const Controller free(railThatReaches(1.0));
  RailRun rail;
  rail.run(held, 20.0);
  const double waited_s = rail.state.waited_s;
  EXPECT_GT(waited_s, 17.0);
  rail.run(free, kWay_m / kPathSpeed_m_per_s + kPathRamp_s + 2.0);
  EXPECT_LT(rail.state.waited_s - waited_s, 1.0) << "it waits no longer";
  EXPECT_NEAR(rail.output.w_d[0], kWay_m, 1e-12);
  EXPECT_NEAR(rail.output.w[0], kWay_m, 1e-4);
}

TEST(WaitingReference, GoesAsFastAsASlowTool) {
  const Controller slow(railThatReaches(0.4 * kPathSpeed_m_per_s));
  RailRun rail;
  rail.run(slow, 5.0);
  EXPECT_NEAR(rail.output.w_d_dot[0], 0.4 * kPathSpeed_m_per_s, 1e-4);
  EXPECT_GT(rail.largest_lag_m, kPathWaitsBeyond_m);
  EXPECT_LT(rail.largest_lag_m, 2.0 * kPathWaitsBeyond_m);
  rail.run(slow, 8.0);
  EXPECT_NEAR(rail.output.w[0], kWay_m, 1e-3) << "all of its path";
}

/// Over slowing down, standing still and going on: w_d is the integral of w_d_dot, which is smooth.
TEST(WaitingReference, HasTheSpeedThatItSays) {
  const Controller free(railThatReaches(1.0));
  const Controller held(railThatReaches(1e-9));
  const Controller slow(railThatReaches(0.4 * kPathSpeed_m_per_s));
  RailRun rail;
  rail.step(free);
  const double ramp_m_per_s2 = kPathSpeed_m_per_s * M_PI / (2.0 * kPathRamp_s);
  // By the ramps, and by a progress that changes by 1.5 / wait_beyond_m of the lag, which shrinks
  // at beta times itself.
  const double lag_change_m_per_s = 5.0 * 2.0 * kPathWaitsBeyond_m;
  const double largest_change =
      kPeriod_s *
      (ramp_m_per_s2 + kPathSpeed_m_per_s * 1.5 / kPathWaitsBeyond_m * lag_change_m_per_s);
  double slowest = kPathSpeed_m_per_s;
  for (int i = 0; i < 14000; ++i) {
    const double w_d = rail.output.w_d[0];
    const double w_d_dot = rail.output.w_d_dot[0];
    rail.step(i < 1500 || i > 7000 ? free : i < 4000 ? held : slow);
    ASSERT_NEAR((rail.output.w_d[0] - w_d) / kPeriod_s, w_d_dot, kPeriod_s * ramp_m_per_s2) << i;
    ASSERT_LE(std::abs(rail.output.w_d_dot[0] - w_d_dot), largest_change) << i;
    if (i > 1500 && i < 4000) slowest = std::min(slowest, w_d_dot);
  }
  EXPECT_LT(slowest, 1e-3);
  EXPECT_NEAR(rail.output.w_d[0], kWay_m, 1e-12);
}

TEST(WaitingReference, DoesNotMoveWhileTheArmIsStopped) {
  const Controller held(railThatReaches(1e-9));
  RailRun rail;
  rail.run(held, 0.8);
  ASSERT_GT(rail.state.waited_s, 0.01);
  ASSERT_GT(rail.output.w_d_dot[0], 0.01) << "in the middle of slowing down";
  rail.state.is_stopping = true;
  rail.step(held);
  const double w_d = rail.output.w_d[0];
  for (int i = 0; i < 3000; ++i) {
    if (i % 100 == 50) held.coast(3, kPeriod_s, rail.state);
    rail.step(held);
    ASSERT_EQ(rail.output.w_d[0], w_d) << i;
  }
  rail.state.is_stopping = false;
  rail.step(held);
  EXPECT_EQ(rail.output.w_d[0], w_d) << "no jump when it goes on";
  rail.step(held);
  EXPECT_NEAR(rail.output.w_d[0], w_d, 1e-3 * kPathSpeed_m_per_s);
  EXPECT_GT(rail.output.w_d[0], w_d);
}

TEST(WaitingReference, StaysWhereItIsWhenTheArmStartsAgain) {
  test::Random random(272);
  ControllerConfig config = test::fullController(random, 7, Variant::kNullTask);
  const Controller controller(config);
  test::RandomTouches touches(random);
  ControllerState state = controller.initialState();
  ControllerOutput output;
  for (int i = 0; i < 500; ++i)
    controller.update(touches.next(state.q_desired), controller.initialGains(), i * kPeriod_s,
                      kPeriod_s, state, output);
  state.waited_s = 1.25;
  state.fault = Fault::kTactileStale;
  const JointVector q = config.q_start + random.vector(7, -0.1, 0.1);
  controller.restart(controller.initialGains(), state);
  controller.place(q, controller.initialGains(), state);
  EXPECT_EQ(state.waited_s, 1.25);
  const ControllerState fresh = controller.initialState(q);
  EXPECT_EQ(state.q_desired, fresh.q_desired);
  EXPECT_EQ(state.velocity_before, fresh.velocity_before);
  EXPECT_EQ(state.fault, Fault::kNone);
  EXPECT_EQ(state.progress, 1.0);
  EXPECT_EQ(state.contact.transition.gamma, 0.0);
  EXPECT_EQ(state.contact.law.V_m_per_s, 0.0);
}

TEST(WaitingReference, OfATaskWithoutTheKeyNeverWaits) {
  ControllerConfig config = railThatReaches(1e-9);
  config.gains.task.wait_beyond_m = kNoLimit;
  const Controller held(config);
  RailRun rail;
  for (int i = 0; i < 6000; ++i) {
    const double t_s = rail.t_s;
    rail.step(held);
    ASSERT_EQ(rail.output.path_time_s, t_s);
  }
  EXPECT_NEAR(rail.largest_lag_m, kWay_m, 1e-6);
}

/// A run of a random arm with contact, missed cycles, stops, restarts and faults.
class EventfulRun {
 public:
  explicit EventfulRun(std::uint64_t seed) : random_(seed), touches_(random_) {
    do {
      config_ = test::fullController(random_, random_.integer(3, 9), Variant::kNullTask);
    } while (!hasPosition());
    config_.gains.task.wait_beyond_m = random_.logUniform(1e-4, 1e-2);
    config_.gains.task.max_return_speed_m_per_s = random_.logUniform(1e-3, 1e-1);
    config_.limits.max_velocity.setConstant(random_.logUniform(0.02, 1.0));
  }

  const ControllerConfig& config() const { return config_; }

  /// Calls update(input, t_s, period_s, state) after each event, and check(clock, state) after it,
  /// the clock telling how far the task's time went on since the update before.
  template <class Update, class Check>
  void run(const Controller& controller, const Update& update, const Check& check) {
    ControllerState state = controller.initialState();
    double t_s = 0.0;
    for (int i = 0; i < 1500; ++i) {
      const double period_s = 1e-3 * random_.uniform(0.1, 3.0);
      const int missed = random_.chance(0.05) ? random_.integer(1, 5) : 0;
      const bool was_stopping = state.is_stopping;
      if (missed > 0) controller.coast(missed, before_s_, state);
      const double passed_s = i > 0 && !was_stopping ? (1 + missed) * before_s_ : 0.0;
      if (random_.chance(0.01)) controller.restart(controller.initialGains(), state);
      if (random_.chance(0.01)) is_stopping_ = !is_stopping_;
      state.is_stopping = is_stopping_;
      RobotInput input = touches_.next(state.q_desired);
      if (random_.chance(0.002)) input.tactile[0] = test::touchAt(0.1, kNoLimit, 0.0, 1000000 + i);
      t_s += passed_s;
      update(input, t_s, period_s, state);
      check(passed_s, state);
      before_s_ = period_s;
    }
  }

 private:
  bool hasPosition() const {
    const int* const end = config_.task.components.data() + config_.task.size;
    return std::any_of(config_.task.components.data(), end, [](int c) { return c < 3; });
  }

  test::Random random_;
  ControllerConfig config_{.chain = test::railChain()};
  test::RandomTouches touches_;
  double before_s_ = 0.0;
  bool is_stopping_ = false;
};

TEST(WaitingReference, ClockNeverRunsBackwardsNorFasterThanTheTasks) {
  int waited = 0;
  for (std::uint64_t seed = 0; seed < 30; ++seed) {
    EventfulRun events(seed);
    const Controller controller(events.config());
    ControllerOutput output;
    double path_before_s = 0.0;
    events.run(
        controller,
        [&](const RobotInput& input, double t_s, double period_s, ControllerState& state) {
          controller.update(input, controller.initialGains(), t_s, period_s, state, output);
        },
        [&](double passed_s, const ControllerState& state) {
          const double passed_on_path_s = output.path_time_s - path_before_s;
          ASSERT_GE(passed_on_path_s, -1e-12) << seed;
          ASSERT_LE(passed_on_path_s, passed_s + 1e-12) << seed;
          ASSERT_GE(state.progress, 0.0);
          ASSERT_LE(state.progress, 1.0);
          path_before_s = output.path_time_s;
          waited += passed_on_path_s < 0.5 * passed_s;
        });
  }
  EXPECT_GT(waited, 500) << "or nothing was tested";
}

TEST(WaitingReference, IsTheSameWhenPreparedAhead) {
  double waited_s = 0.0;
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    for (const bool before_coasting : {false, true}) {
      std::vector<ControllerOutput> outputs[2];
      for (const bool is_prepared : {false, true}) {
        EventfulRun events(seed);
        const Controller controller(events.config());
        PreparedCycle prepared;
        double next_s = 0.0;
        events.run(
            controller,
            [&](const RobotInput& input, double t_s, double period_s, ControllerState& state) {
              if (is_prepared && !before_coasting)
                controller.prepare(controller.initialGains(), t_s, state, prepared);
              outputs[is_prepared].emplace_back();
              ControllerOutput& output = outputs[is_prepared].back();
              if (is_prepared) {
                controller.update(input, controller.initialGains(), t_s, period_s, prepared, state,
                                  output);
              } else {
                controller.update(input, controller.initialGains(), t_s, period_s, state, output);
              }
              next_s = t_s + (state.is_stopping ? 0.0 : period_s);
              if (is_prepared && before_coasting)
                controller.prepare(controller.initialGains(), next_s, state, prepared);
            },
            [&](double, const ControllerState& state) {
              waited_s = std::max(waited_s, state.waited_s);
            });
      }
      for (std::size_t i = 0; i < outputs[0].size(); ++i)
        test::expectSame(outputs[0][i], outputs[1][i]);
      ASSERT_FALSE(HasFailure()) << seed;
    }
  }
  EXPECT_GT(waited_s, 0.5) << "or nothing was tested";
}

/// Joints that are too slow for its turn; the way there ends where it shall all the same.
TEST(WaitingReference, WaitsForTheOrientationAsForThePosition) {
  constexpr double kWait_rad = 0.1;
  test::Random random(274);
  for (const double wait_rad : {kWait_rad, kNoLimit}) {
    ControllerConfig config = test::randomController(random, 9, 6);
    config.limits.max_velocity.setConstant(0.05);
    config.tactile_modules.clear();
    config.gains.task.drift_gain_per_s = 5.0;
    config.gains.task.wait_beyond_rad = wait_rad;
    Waypoint turn;
    turn.rotation_vector_rad = Vector3(0.5, -0.6, 0.3);
    config.task.trajectory = {0.1, {turn}};
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    double largest_rad = 0.0;
    for (int cycle = 0; cycle < 60'000; ++cycle) {
      controller.update({}, controller.initialGains(), cycle * kPeriod_s, kPeriod_s, state, output);
      const PaddedTaskVector error = paddedTask(output.error);
      largest_rad = std::max(largest_rad, toolLag(config.task, error).rotation_rad);
    }
    if (wait_rad == kWait_rad) {
      EXPECT_LT(largest_rad, 2.0 * kWait_rad);
      EXPECT_GT(state.waited_s, 1.0);
      EXPECT_LT(output.error.norm(), 1e-3);
    } else {
      EXPECT_GT(largest_rad, 3.0 * kWait_rad);
      EXPECT_EQ(state.waited_s, 0.0);
    }
  }
}

/// A sum of rotation vectors is no rotation: that of the reference is its own.
TEST(ReferenceRotation, IsThatOfThePathWhereverTheToolIs) {
  test::Random random(273);
  double largest_sum_error = 0.0;
  for (int i = 0; i < 50; ++i) {
    ControllerConfig config = test::randomController(random, 9, 6);
    const Controller controller(config);
    ControllerState state = controller.initialState();
    ChainPose pose;
    config.chain.computePose(config.q_start, pose);
    const Pose X_BaseTool = framePose(pose, config.chain.tip());
    const Vector3 expected = rotationVector(X_BaseTool.R_AB);
    state.q_desired += random.vector(9, -0.5, 0.5);
    ControllerOutput output;
    controller.update({}, controller.initialGains(), 0.0, kPeriod_s, state, output);
    Vector3 sum = expected;
    for (int k = 0; k < 6; ++k) {
      const int component = config.task.components[k];
      if (component < 3) {
        EXPECT_EQ(output.w_d[k], output.w[k] + output.error[k]);
        EXPECT_NEAR(output.w_d[k], X_BaseTool.p_AB[component], 1e-14);
      } else {
        EXPECT_NEAR(output.w_d[k], expected[component - 3], 1e-12);
        sum[component - 3] = output.w[k] + output.error[k];
      }
    }
    largest_sum_error = std::max(largest_sum_error, (sum - expected).norm());
  }
  EXPECT_GT(largest_sum_error, 0.1) << "these poses cannot tell";
}

}  // namespace
}  // namespace tactus
