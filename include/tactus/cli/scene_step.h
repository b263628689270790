#pragma once

#include "tactus/control/controller.h"
#include "tactus/scene/scene.h"
#include "tactus/sim/simulated_robot.h"

namespace tactus {

/// The control step of a scene, contact included, on a simulated robot: one cycle a call, the scene
/// over and over. Allocates nothing once it is made.
class SceneStep {
 public:
  explicit SceneStep(const Scene& scene);

  void run() noexcept;

 private:
  void restart() noexcept;

  Controller controller_;
  Gains gains_;
  SimulatedRobot fresh_robot_, robot_;
  double period_s_;
  long long cycles_a_run_;
  long long cycle_ = 0;
  ControllerState initial_state_, state_;
  PreparedCycle prepared_;
  RobotInput input_;
  ControllerOutput output_;
};

}  // namespace tactus
