#include "tactus/bench/several_run.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tactus/bench/post_placing.h"
#include "tactus/bench/spread.h"
#include "tactus/bench/surroundings.h"
#include "tactus/control/controller.h"
#include "tactus/sim/obstacle.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {
namespace {

constexpr double kFree_s = 1.0;

/// One obstacle on one module, to see when they meet and how fast. What comes back before it was
/// free for long only bounces.
struct FirstTouch {
  FirstTouch(const RunSetup& setup, std::size_t on_module, ObstacleConfig config)
      : module(on_module),
        friction(std::hypot(1.0, config.friction_coefficient)),
        stiffness_N_per_m(inSeries(config.stiffness_N_per_m, setup.plant.robot_stiffness_N_per_m)),
        obstacle(withUnitSpring(std::move(config)), kNoLimit) {}

  static ObstacleConfig withUnitSpring(ObstacleConfig config) {
    config.stiffness_N_per_m = 1.0;  // force is depth
    config.foam.clear();
    config.friction_coefficient = 0.0;
    return config;
  }

  std::size_t module;
  double friction;  ///< the largest force over that along the normal
  double stiffness_N_per_m;
  Obstacle obstacle;
  double depth_m = 0.0;  ///< a cycle before
  double free_s = 0.0;
  double unfelt_s = 0.0;  ///< what is left of the time in which no answer can come
  double before_N = 0.0;  ///< what the module felt then
  bool is_over = false, has_been = false;
};

class TouchWatch {
 public:
  explicit TouchWatch(const RunSetup& setup) : setup_(setup) {
    for (std::size_t i = 0; i < setup.controller.tactile_modules.size(); ++i)
      for (const ObstacleConfig& obstacle : setup.plant.obstacles)
        touches_.emplace_back(setup, i, obstacle);
  }

  void update(const JointVector& q, double t_s, SeveralRun& run, const ControllerOutput& output) {
    setup_.controller.chain.computePose(q, pose_);
    for (FirstTouch& touch : touches_) {
      const TactileModuleConfig& module = setup_.controller.tactile_modules[touch.module];
      const Pose X = framePose(pose_, module.link);
      const double depth_m = touch.obstacle
                                 .touch({X.p_AB, X.R_AB.col(0), module.length_m,
                                         setup_.plant.modules[touch.module].cover_radius_m},
                                        t_s)
                                 .force_N;
      touch.free_s = depth_m > 0.0 ? 0.0 : touch.free_s + setup_.period_s;
      if (touch.free_s > kFree_s) touch.is_over = false;
      const double speed_m_per_s = (depth_m - touch.depth_m) / setup_.period_s;
      if (!touch.is_over && touch.depth_m > 0.0 && speed_m_per_s > 0.0) {
        touch.is_over = true;
        touch.unfelt_s = feedbackDelay_s(setup_.plant);
        touch.before_N = output.sensed[touch.module].force_N;
      }
      touch.unfelt_s -= setup_.period_s;
      if (touch.unfelt_s > 0.0) note(touch, speed_m_per_s, run.modules[touch.module]);
      touch.depth_m = depth_m;
    }
  }

 private:
  /// What others feel may turn the arm towards a post that nobody feels yet.
  void note(FirstTouch& touch, double speed_m_per_s, SeveralRun::Module& module) {
    const ForceGains& force = setup_.controller.gains.force;
    const double unseen_N = touch.stiffness_N_per_m * speed_m_per_s * feedbackDelay_s(setup_.plant);
    const double limit_N = force.activation_force_N + force.contact_threshold_N;
    const double felt_N = std::max(touch.before_N, force.contact_threshold_N);
    module.scale_N =
        std::max(module.scale_N, touch.friction * std::max(limit_N, felt_N + unseen_N));
    if (!touch.has_been) ++module.posts;
    touch.has_been = true;
    module.was_touched = true;
  }

  RunSetup setup_;
  std::vector<FirstTouch> touches_;
  ChainPose pose_{};
};

double restLimit_N(const RunSetup& setup) {
  const ForceGains& force = setup.controller.gains.force;
  double friction = 0.0;
  for (const ObstacleConfig& obstacle : setup.plant.obstacles)
    friction = std::max(friction, obstacle.friction_coefficient);
  return (force.activation_force_N + force.contact_threshold_N) * std::hypot(1.0, friction);
}

/// What speeds change by beyond what they changed by in the cycle before: an arm that accelerates
/// makes no step, but where its limit of acceleration begins or ends to hold it back.
struct StepWatch {
  explicit StepWatch(const RunSetup& setup)
      : most(0.999 * setup.period_s * setup.controller.limits.max_acceleration),
        velocity(JointVector::Zero(most.size())),
        change(velocity) {}

  void update(const JointVector& now, bool is_new, SeveralRun& run) {
    const JointVector change_now = now - velocity;
    const bool is_limited = (change_now.cwiseAbs().array() >= most.array()).any();
    // The cycle after a limited one is in part what that had left.
    to_judge = is_limited ? -1 : is_new ? 0 : to_judge + 1;
    if (to_judge > 1) {
      const double step = (change_now - change).cwiseAbs().maxCoeff();
      run.step_between_samples = std::max(run.step_between_samples, step);
    }
    velocity = now;
    change = change_now;
  }

  JointVector most, velocity, change;
  int to_judge = -1;  ///< cycles in a row, after the first two
};

void sumUp(const std::vector<Spread>& rest, SeveralRun& run) {
  for (std::size_t i = 0; i < rest.size(); ++i) {
    SeveralRun::Module& module = run.modules[i];
    module.restlessness_N = rest[i].deviation();
    module.mean_at_rest_N = rest[i].mean;
    run.restlessness_N = std::max(run.restlessness_N, module.restlessness_N);
    run.peak_at_rest_N = std::max(run.peak_at_rest_N, module.peak_at_rest_N);
    if (!module.was_touched) continue;
    ++run.touched_modules;
    run.largest_peak_to_scale = std::max(run.largest_peak_to_scale, module.peak_N / module.scale_N);
    run.contact_peak_to_scale =
        std::max(run.contact_peak_to_scale, module.contact_peak_N / module.scale_N);
    run.touched_posts = std::max(run.touched_posts, module.posts);
  }
}

}  // namespace

SeveralRun runSeveral(const RunSetup& setup) {
  const Controller controller(setup.controller);
  SimulatedRobot robot(setup.controller, setup.plant, setup.period_s);
  TouchWatch touches(setup);
  EndWatch ends(setup);
  ClearanceWatch clearance(setup.controller);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  SeveralRun run;
  run.limit_N = restLimit_N(setup);
  std::vector<Spread> rest(setup.controller.tactile_modules.size());
  StepWatch steps(setup);
  const long cycles = std::lround(setup.duration_s / setup.period_s);
  const long rest_from = cycles - std::lround(JudgedRun::kRest_s / setup.period_s);
  for (long cycle = 0; cycle < cycles; ++cycle) {
    const double t_s = static_cast<double>(cycle) * setup.period_s;
    robot.read(input);
    controller.update(input, setup.controller.gains, t_s, setup.period_s, state, output);
    const Vector3 goal = output.w_d.size() >= 3 ? Vector3(output.w_d.head<3>()) : Vector3::Zero();
    run.tcp_error_final_m = (goal - robot.toolPosition()).norm();
    robot.write(output.velocity);
    bool is_new = false;
    for (std::size_t i = 0; i < rest.size(); ++i) {
      is_new = is_new || output.sensed[i].isNew();
      const double force_N = robot.trueForce_N(static_cast<int>(i));
      run.modules[i].peak_N = std::max(run.modules[i].peak_N, force_N);
      run.modules[i].contact_peak_N =
          std::max(run.modules[i].contact_peak_N, robot.hardestContact_N(static_cast<int>(i)));
      if (cycle < rest_from) continue;
      rest[i].add(force_N);
      run.modules[i].peak_at_rest_N = std::max(run.modules[i].peak_at_rest_N, force_N);
    }
    steps.update(output.velocity, is_new, run);
    run.clearance_left_m = std::min(run.clearance_left_m, clearance.left_m(output.q_desired));
    touches.update(input.q_measured, t_s, run, output);
    run.is_out = run.is_out || ends.isOut(input.q_measured, t_s);
  }
  sumUp(rest, run);
  run.fault = output.fault;
  return run;
}

}  // namespace tactus
