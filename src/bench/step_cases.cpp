#include "tactus/bench/plain_controller.h"
#include "tactus/bench/step_case.h"
#include "tactus/control/controller.h"

namespace tactus {
namespace {

/// States, inputs and the controller of one case.
template <typename Controller, typename State>
struct Recorded {
  Controller controller;
  std::vector<State> recorded, states;
  std::vector<RobotInput> inputs;
  JointVector velocity;
};

double timeOf(int cycle) { return cycle * kBenchPeriod_s; }

/// Well into the contact, so that filters and integrals have left their start.
constexpr int kFirstCycle = 40;

template <typename Cycle, typename State>
void record(const BenchRobot& robot, State state, const Cycle& cycle, std::vector<State>& states,
            std::vector<RobotInput>& inputs) {
  for (int i = 0; i < kFirstCycle + kStepStates; ++i) {
    const RobotInput input = benchInput(robot, i);
    if (i >= kFirstCycle) {
      states.push_back(state);
      inputs.push_back(input);
    }
    cycle(input, timeOf(i), state);
  }
}

StepCase describe(const char* code, const BenchRobot& robot) {
  StepCase step_case;
  step_case.code = code;
  step_case.joints = robot.config.chain.size();
  step_case.task_components = robot.config.task.size;
  step_case.contacts = robot.config.force_control ? 1 : 0;
  return step_case;
}

template <typename Run>
StepCase makeCase(const char* code, const BenchRobot& robot, std::shared_ptr<Run> run) {
  StepCase step_case = describe(code, robot);
  step_case.prepare = [run] { run->states = run->recorded; };
  step_case.step = [run](int i) { run->step(i); };
  step_case.command = [run] { return run->velocity; };
  return step_case;
}

struct OurRun : Recorded<Controller, ControllerState> {
  explicit OurRun(const BenchRobot& robot)
      : Recorded{Controller(robot.config), {}, {}, {}, {}}, gains(robot.config.gains) {
    record(
        robot, controller.initialState(),
        [this](const RobotInput& input, double t_s, ControllerState& state) {
          controller.update(input, gains, t_s, kBenchPeriod_s, state, output);
        },
        recorded, inputs);
  }
  void step(int i) {
    controller.update(inputs[i], gains, timeOf(kFirstCycle + i), kBenchPeriod_s, states[i], output);
    velocity = output.velocity;
  }
  Gains gains;
  ControllerOutput output;
};

/// Only what is left when prepare() has run before.
struct PreparedRun : OurRun {
  explicit PreparedRun(const BenchRobot& robot) : OurRun(robot), prepared(kStepStates) {}
  void prepare() {
    for (int i = 0; i < kStepStates; ++i)
      controller.prepare(gains, timeOf(kFirstCycle + i), states[i], prepared[i]);
  }
  void step(int i) {
    controller.update(inputs[i], gains, timeOf(kFirstCycle + i), kBenchPeriod_s, prepared[i],
                      states[i], output);
    velocity = output.velocity;
  }
  std::vector<PreparedCycle> prepared;
};

struct PlainRun : Recorded<PlainController, PlainControllerState> {
  PlainRun(const BenchRobot& robot, std::unique_ptr<PlainKinematics> kinematics)
      : Recorded{PlainController(robot, std::move(kinematics)), {}, {}, {}, {}} {
    record(
        robot, controller.initialState(),
        [this](const RobotInput& input, double t_s, PlainControllerState& state) {
          controller.update(input, t_s, kBenchPeriod_s, state);
        },
        recorded, inputs);
  }
  void step(int i) {
    velocity = controller.update(inputs[i], timeOf(kFirstCycle + i), kBenchPeriod_s, states[i]);
  }
};

StepCase preparedCase(const BenchRobot& robot) {
  const auto run = std::make_shared<PreparedRun>(robot);
  StepCase step_case = makeCase(kCodePrepared, robot, run);
  step_case.prepare = [run] {
    run->states = run->recorded;
    run->prepare();
  };
  return step_case;
}

}  // namespace

std::vector<StepCase> stepCases(int joints, int task_components, int contacts) {
  const BenchRobot robot = makeBenchRobot(joints, task_components, contacts);
  std::vector<StepCase> cases = {
      makeCase(kCodeOurs, robot, std::make_shared<OurRun>(robot)), preparedCase(robot),
      makeCase(kCodeSvd, robot, std::make_shared<PlainRun>(robot, svdKinematics(robot))),
      makeCase(kCodeKdl, robot, std::make_shared<PlainRun>(robot, wdlsKinematics(robot)))};
  if (contacts > 0) return cases;
  for (StepCase& step_case : kdlSolverCases(joints, task_components))
    cases.push_back(std::move(step_case));
  return cases;
}

}  // namespace tactus
