#include "campaign/self_test.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "campaign/going_on.h"
#include "campaign/judges.h"
#include "campaign/play.h"
#include "campaign/stage.h"

namespace tactus::campaign {
namespace {

using enum Mode;

constexpr int kJoints = 9;
constexpr double kSpeed = 0.1;

/// Parts of a life in which nothing is wrong: a hold, a fault, a new start and an end.
enum Part {
  kRun,
  kRampDown,
  kHold,
  kGoOn,
  kStopsAtOnce,
  kRests,
  kCleared,
  kBoots,
  kReadyAgain,
  kOpens,
  kRunsAgain,
  kEnds,
  kAtEnd,
};

Observation ordinary(Mode mode, Fault fault, bool enable, bool is_brake_open, double speed) {
  Observation one;
  one.mode = mode;
  one.fault = fault;
  one.enable = enable;
  one.is_brake_open = is_brake_open;
  one.has_torque = is_brake_open;
  one.is_stop_requested = mode == kStopping || mode == kOff;
  one.command = one.setpoint = one.velocity = JointVector::Constant(kJoints, speed);
  one.position = JointVector::Zero(kJoints);
  return one;
}

struct Instant {
  Part part;
  int ms;  ///< since the part began
  Observation seen;
};

std::vector<Instant> life() {
  constexpr Fault kNo = Fault::kNone;
  constexpr Fault kStop = Fault::kEmergencyStop;
  struct Row {
    Part part;
    int ms;
    Observation seen;
  };
  const std::vector<Row> rows = {
      {kRun, 2500, ordinary(kRunning, kNo, true, true, kSpeed)},
      {kRampDown, 1, ordinary(kHolding, kNo, false, true, 0.0)},
      {kHold, 500, ordinary(kHolding, kNo, false, true, 0.0)},
      {kGoOn, 500, ordinary(kRunning, kNo, true, true, kSpeed)},
      {kStopsAtOnce, 20, ordinary(kFault, kStop, true, false, 0.0)},
      {kRests, 1500, ordinary(kFault, kStop, true, false, 0.0)},
      {kCleared, 60, ordinary(kFault, kStop, false, false, 0.0)},
      {kBoots, 200, ordinary(kBoot, kNo, true, false, 0.0)},
      {kReadyAgain, 2, ordinary(kReady, kNo, true, false, 0.0)},
      {kOpens, 100, ordinary(kEnabling, kNo, true, true, 0.0)},
      {kRunsAgain, 500, ordinary(kRunning, kNo, true, true, kSpeed)},
      {kEnds, 120, ordinary(kStopping, kNo, true, false, 0.0)},
      {kAtEnd, 1500, ordinary(kOff, kNo, true, false, 0.0)},
  };
  std::vector<Instant> life;
  for (const Row& row : rows)
    for (int ms = 0; ms < row.ms; ++ms) {
      life.push_back({row.part, ms, row.seen});
      life.back().seen.t_ms = static_cast<int>(life.size());
    }
  return life;
}

Promise promise() {
  Promise promise;
  promise.limits.max_velocity = JointVector::Constant(kJoints, 5.0);
  promise.limits.max_acceleration = JointVector::Constant(kJoints, 200.0);
  promise.counts_per_unit = JointVector::Constant(kJoints, 1e6);
  promise.quick_stop = JointVector::Constant(kJoints, 10.0);
  return promise;
}

/// One harm, by what it changes in an ordinary life, and the words that it must be told with.
struct Harm {
  const char* judge;
  const char* what;
  Part part;
  std::function<void(Observation&, int ms)> change;
};

std::vector<Harm> harms() {
  const auto always = [](auto change) { return [change](Observation& o, int) { change(o); }; };
  const auto moves = [](double v) { return JointVector::Constant(kJoints, v); };
  return {
      {"limits", "command not finite", kRun, [](Observation& o, int) { o.command[3] = NAN; }},
      {"limits", "command beyond the velocity", kRun,
       [](Observation& o, int) { o.command[3] = 5.01; }},
      {"limits", "setpoint beyond the velocity", kRun,
       [](Observation& o, int) { o.setpoint[8] = -5.01; }},
      {"limits", "setpoint beyond the velocity", kRests,
       [](Observation& o, int) { o.setpoint[8] = NAN; }},
      {"limits", "command beyond the acceleration", kRun,
       [](Observation& o, int ms) { o.command[0] += ms == 9 ? 0.21 : 0.0; }},
      {"limits", "setpoint is not the command", kRun,
       [](Observation& o, int) { o.setpoint[1] += 1e-5; }},
      {"stop", "setpoint in fault", kStopsAtOnce,
       [](Observation& o, int ms) { o.setpoint[2] = ms == 0 ? 1e-6 : 0.0; }},
      {"stop", "setpoint in enabling", kOpens, [](Observation& o, int) { o.setpoint[2] = 1e-6; }},
      {"stop", "setpoint after the ramp of holding", kHold,
       [](Observation& o, int) { o.setpoint[2] = 1e-6; }},
      {"stop", "a retreat without end", kRun, always([](Observation& o) { o.mode = kRetreating; })},
      {"stop", "setpoint after the ramp of stopping", kEnds,
       [](Observation& o, int) { o.setpoint[2] = 1e-6; }},
      {"enable", "setpoint while the enable line is off", kHold,
       [](Observation& o, int ms) { o.setpoint[2] = ms == 400 ? 1e-6 : 0.0; }},
      {"enable", "running while not enabled", kGoOn,
       always([](Observation& o) { o.enable = false; })},
      {"enable", "enabling without off and on", kCleared,
       always([](Observation& o) { o.enable = true; })},
      {"enable", "enabling without off and on after the cause", kBoots,
       [](Observation& o, int ms) { o.has_cause = ms == 0; }},
      {"brake", "open at the end", kAtEnd, always([](Observation& o) { o.is_brake_open = true; })},
      {"brake", "open before enabling", kBoots,
       always([](Observation& o) { o.is_brake_open = true; })},
      {"brake", "open in an emergency", kRun,
       always([](Observation& o) { o.is_emergency = true; })},
      {"brake", "opens in fault", kRests,
       [](Observation& o, int ms) { o.is_brake_open = ms == 300; }},
      {"brake", "open in fault after the deadline", kRests,
       [](Observation& o, int ms) { o.is_brake_open = ms < 700; }},
      {"brake", "open while no drive has torque", kRun,
       [](Observation& o, int ms) { o.has_torque = ms < 100; }},
      {"rest", "a drive moves in fault", kRests,
       [moves](Observation& o, int) { o.velocity = moves(0.002); }},
      {"rest", "a drive moves in off", kAtEnd,
       [moves](Observation& o, int ms) { o.velocity = moves(ms > 1200 ? 0.002 : 0.0); }},
      {"rest", "a drive has torque in ready", kReadyAgain,
       [](Observation& o, int ms) { o.has_torque = true, o.t_ms += 200 * ms; }},
      {"rest", "a drive has torque after the end", kAtEnd,
       always([](Observation& o) { o.has_torque = true; })},
      {"rest", "a joint goes far after a stop", kRests,
       [](Observation& o, int ms) { o.position[4] = 1e-4 * ms; }},
      {"place", "enabling after a push", kOpens, always([](Observation& o) { o.pushed_ms = 20; })},
      {"place", "running after a push", kRunsAgain,
       always([](Observation& o) { o.pushed_ms = 20; })},
      {"cause", "running with a cause", kRun,
       [](Observation& o, int ms) { o.has_cause = ms == 50; }},
      {"cause", "running with drive_silent", kRun,
       [](Observation& o, int ms) { o.hidden_cause = ms == 50 ? "drive_silent" : nullptr; }},
      {"name", "not in the table of modes", kCleared,
       [](Observation& o, int ms) { o.mode = ms == 0 ? kRunning : o.mode; }},
      {"name", "no reason", kStopsAtOnce,
       [](Observation& o, int ms) { o.fault = ms == 0 ? Fault::kNone : o.fault; }},
      {"name", "fault emergency_stop became none", kRests,
       [](Observation& o, int ms) { o.fault = ms > 9 ? Fault::kNone : o.fault; }},
      {"name", "fault emergency_stop became bus_off", kRests,
       [](Observation& o, int ms) { o.fault = ms > 9 ? Fault::kBusOff : o.fault; }},
      {"end", "a stop request leaves it in stopping", kEnds,
       [](Observation& o, int ms) { o.t_ms += ms > 10 ? 8001 : 0; }},
      {"stale", "a drive followed an old setpoint", kRun,
       [](Observation& o, int ms) { o.stale_setpoints = ms > 9 ? 1 : 0; }},
      {"power", "a drive lets go in motion", kStopsAtOnce,
       [](Observation& o, int ms) { o.powers_taken = ms > 9 ? 1 : 0; }},
      {"force", "the sensor's zero is elsewhere", kRun,
       always([](Observation& o) { o.force_error_N = 2.0; })},
  };
}

std::vector<Violation> judged(const std::vector<Instant>& life) {
  const Promise promised = promise();
  std::vector<Violation> found;
  Judges judges;
  for (std::size_t i = 1; i < life.size(); ++i)
    judges.look({promised, life[i - 1].seen, life[i].seen, found});
  return found;
}

/// 0, or 1 and a line.
int expect(bool is_right, const std::string& what) {
  if (!is_right) fmt::print("self-test: {}\n", what);
  return is_right ? 0 : 1;
}

int judgesSeeHarm() {
  int wrong = 0;
  for (const Violation& violation : judged(life()))
    wrong += expect(false, fmt::format("sees {} where nothing is wrong", violation.what));
  for (const Harm& harm : harms()) {
    std::vector<Instant> spoilt = life();
    for (Instant& moment : spoilt)
      if (moment.part == harm.part) harm.change(moment.seen, moment.ms);
    const std::vector<Violation> found = judged(spoilt);
    const bool is_seen = std::any_of(found.begin(), found.end(), [&](const Violation& violation) {
      return violation.judge == std::string(harm.judge) && violation.what.starts_with(harm.what);
    });
    wrong += expect(is_seen, fmt::format("{}: blind to: {}", harm.judge, harm.what));
  }
  return wrong;
}

/// A hold of a real cell, and the same with a peak that is not its own.
int goingOnSeesHarm(const Stage& stage) {
  Plan plan;
  Play play(stage, plan);
  GoingOnJudge judge;
  std::vector<Violation> found;
  Observation before = play.now();
  while (play.now_ms() < 4000) {
    CycleInput input;
    input.lines.enable = play.now_ms() < 100 || play.now_ms() > 600;
    play.step(input);
    judge.look({stage.promise, before, play.now(), found});
    before = play.now();
  }
  judge.end(play.now_ms());
  long long cycles = 0;
  int wrong = expect(judge.all.size() == 1, "going on: a return to running is not seen");
  wrong += expect(judge.all.back().is_hold, "going on: a hold is not seen");
  judge.all.back().is_hold = false;
  judge.all.back().peak += 0.26;  // and so beyond what needs no comparison
  compareGoingOn(stage, plan, judge, found, cycles);
  wrong += expect(found.size() == 1, "going on: blind to a peak");
  judge.all.back().peak -= 0.02;
  compareGoingOn(stage, plan, judge, found, cycles);
  wrong += expect(found.size() == 1, "going on: sees a peak that is none");
  judge.all.back().is_hold = true;
  judge.all.back().peak += 0.5;
  compareGoingOn(stage, plan, judge, found, cycles);
  wrong += expect(found.size() == 2, "going on: blind to a peak after a hold");
  return wrong;
}

/// A while with these troubles and a quick stop, as a hash of what daemon and drives see and do.
std::size_t history(const Stage& stage, const Plan& plan) {
  std::size_t hash = 0;
  const auto add = [&hash](auto value) { hash = 31 * hash + std::hash<decltype(value)>()(value); };
  Play play(stage, plan);
  while (play.now_ms() < 900) {
    CycleInput input = play.input();
    input.are_lines_lost |= play.now_ms() > 400;
    play.step(input);
    const ControlCycle& cycle = play.cell().cycle;
    add(static_cast<int>(play.now().mode));
    add(play.now().is_brake_open);
    for (int i = 0; i < kJoints; ++i) {
      add(cycle.robot().drive(i).position);
      add(play.now().velocity[i]);
      add(static_cast<int>(play.cell().plant.drive(i).powerState()));
    }
  }
  return hash;
}

/// No trouble is one in name alone, and a run is the same whenever it is run. A frame that comes
/// twice says nothing new.
int kindsDoSomething(const Stage& stage) {
  test::Random random(1);
  Plan plan;
  plan.moment = Moment::kFirm;
  const std::size_t undisturbed = history(stage, plan);
  int wrong = expect(history(stage, plan) == undisturbed, "a run differs from itself");
  for (const InjectionKind* kind : injectionKinds()) {
    Injection x = drawInjection(random, stage.scene, *kind, 100);
    x.until_ms = 800;
    if (kind->where == InjectionKind::Where::kBus) x.bus = 1, x.id = 0;
    plan.injections = {x};
    const bool is_seen = history(stage, plan) != undisturbed;
    const bool is_double = std::string(kind->name) == "frames_doubled";
    wrong += expect(is_seen || is_double, fmt::format("{} does nothing", kind->name));
  }
  return wrong;
}

}  // namespace

int selfTest() {
  const Stage stage = bootStage("null_space");
  const int wrong = judgesSeeHarm() + goingOnSeesHarm(stage) + kindsDoSomething(stage);
  if (wrong == 0)
    fmt::print("self-test: every judge sees its harm, {} in all\n", harms().size() + 1);
  return wrong == 0 ? 0 : 1;
}

}  // namespace tactus::campaign
