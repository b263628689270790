#pragma once

#include "support/crops9.h"
#include "tactus/control/controller.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus::test {

/// Controller and simulated robot, cycle by cycle.
class ClosedLoop {
 public:
  ClosedLoop(const ControllerConfig& config, const PlantConfig& plant, double period_s)
      : controller_(config),
        robot_(config, plant, period_s),
        state_(controller_.initialState()),
        period_s_(period_s) {}

  void step() noexcept {
    robot_.read(input_);
    controller_.update(input_, controller_.initialGains(), static_cast<double>(cycle_) * period_s_,
                       period_s_, state_, output_);
    robot_.write(output_.velocity);
    ++cycle_;
  }

  void runUntil(double t_s) {
    while (static_cast<double>(cycle_) * period_s_ < t_s - 0.5 * period_s_) step();
  }

  double time_s() const { return static_cast<double>(cycle_) * period_s_; }
  const ControllerOutput& output() const { return output_; }
  const ControllerState& state() const { return state_; }
  const RobotInput& input() const { return input_; }
  const SimulatedRobot& robot() const { return robot_; }

 private:
  Controller controller_;
  SimulatedRobot robot_;
  ControllerState state_;
  RobotInput input_;
  ControllerOutput output_;
  double period_s_;
  long cycle_ = 0;
};

}  // namespace tactus::test
