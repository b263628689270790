#include "tactus/cli/scene_step.h"

#include <algorithm>
#include <cmath>

namespace tactus {

SceneStep::SceneStep(const Scene& scene)
    : controller_(scene.controller),
      gains_(scene.controller.gains),
      fresh_robot_(scene.controller, scene.plant, scene.period_s),
      robot_(fresh_robot_),
      period_s_(scene.period_s),
      cycles_a_run_(std::max(1LL, std::llround(scene.duration_s / scene.period_s))),
      initial_state_(controller_.initialState()),
      state_(initial_state_) {}

void SceneStep::run() noexcept {
  if (cycle_ == cycles_a_run_) restart();
  const double t_s = static_cast<double>(cycle_) * period_s_;
  robot_.read(input_);
  controller_.update(input_, gains_, t_s, period_s_, prepared_, state_, output_);
  robot_.write(output_.velocity);
  ++cycle_;
  controller_.prepare(gains_, static_cast<double>(cycle_) * period_s_, state_, prepared_);
}

void SceneStep::restart() noexcept {
  cycle_ = 0;
  robot_ = fresh_robot_;
  state_ = initial_state_;
}

}  // namespace tactus
