#include "campaign/play.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

namespace tactus::campaign {
namespace {

constexpr int kLateFrame_ms = 50;    ///< after a trouble of frames
constexpr int kLastSample_ms = 10;   ///< until a sample knows that a hand has gone
constexpr int kStaleSample_ms = 32;  ///< until the module is seen to say nothing
constexpr int kSilent_ms = 10;       ///< and a drive

/// Also one that pats: it hides nothing.
bool isHand(const Injection& x) { return std::string_view(x.kind->name).ends_with("hand"); }

constexpr std::int64_t kMillisecond_ns = 1'000'000;

}  // namespace

Play::Play(const Stage& stage, const Plan& plan)
    : Play(stage, stage.moments[static_cast<int>(plan.moment)], plan,
           [](VirtualRobotCell& cell) { cell.cycle.prepare(); }) {}

Play::Play(const Stage& stage, VirtualRobotCell cell, const Plan& plan,
           std::function<void(VirtualRobotCell&)> finish)
    : stage_(stage),
      cell_(std::move(cell)),
      finish_(std::move(finish)),
      start_ns_(cell_.t_ns),
      injections_(plan.injections),
      gate_(plan.frame),
      reversed_from_ms_(plan.reversed_from_ms),
      reversed_until_ms_(plan.reversed_until_ms) {
  cell_.on_frame = [this](int bus, CanFrame& frame) { changeReceived(bus, frame); };
  if (reversed_until_ms_ > 0)
    cell_.on_batch = [this](int, FrameBatch& frames) { changeOrder(frames); };
  cell_.on_send = [this](int bus, CanFrame& frame) { return changeSent(bus, frame); };
  cell_.on_bus = [this](int bus, BusMonitor& monitor) { changeBus(bus, monitor); };
  cell_.plant.play(script(), cell_.t_ns);
  observe();
}

template <typename Do>
void Play::forActive(const Do& act) {
  const int t_ms = now_ms();
  for (Injection& x : injections_) {
    if (!x.isAtWork(t_ms) || (x.kind->is_followed && !are_forces_there_)) continue;
    x.t_ms = t_ms - x.from_ms;
    act(x);
  }
}

void Play::act() {
  forActive([&](Injection& x) {
    if (x.kind->act) x.kind->act(x, cell_);
  });
}

void Play::changeReceived(int bus, CanFrame& frame) {
  if (frame.kind != FrameKind::kData) return;
  const int copies = gate_.pass({false, bus, frame.id, now_ms()}, frame).copies;
  if (copies == 2) cell_.cycle.receive(bus, {&frame, 1});
  if (copies == 0) frame.id = kNobody;
  forActive([&](Injection& x) {
    if (x.kind->receive) x.kind->receive(x, bus, frame);
  });
}

bool Play::changeSent(int bus, CanFrame& frame) {
  const int copies = gate_.pass({true, bus, frame.id, now_ms()}, frame).copies;
  if (copies == 2) cell_.plant.send(bus, frame, cell_.t_ns);
  bool arrives = copies > 0;
  forActive([&](Injection& x) {
    if (x.kind->send) arrives = x.kind->send(x, bus, frame) && arrives;
  });
  return arrives;
}

void Play::changeOrder(FrameBatch& frames) const {
  const int t_ms = now_ms();
  if (t_ms < reversed_from_ms_ || t_ms >= reversed_until_ms_) return;
  const FrameBatch inOrder = frames;
  frames.clear();
  for (std::size_t i = inOrder.size(); i > 0; --i) frames.push(inOrder.begin()[i - 1]);
}

void Play::deliverHeld() {
  const auto held = gate_.takeHeld();
  if (!held) return;
  if (held->seen.is_sent)
    cell_.plant.send(held->seen.bus, held->frame, cell_.t_ns);
  else
    cell_.cycle.receive(held->seen.bus, {&held->frame, 1});
}

void Play::changeBus(int bus, BusMonitor& monitor) {
  forActive([&](Injection& x) {
    if (x.kind->monitor && x.bus == bus) x.kind->monitor(x, monitor);
  });
}

std::vector<Trouble> Play::script() const {
  std::vector<Trouble> script;
  for (const Injection& x : injections_) {
    if (!x.kind->script) continue;
    const bool is_drive = x.kind->where == InjectionKind::Where::kDrive;
    script.push_back({*x.kind->script, 1e-3 * x.from_ms, 1e-3 * x.until_ms, x.bus,
                      is_drive ? x.node : x.id, x.size});
  }
  return script;
}

CycleInput Play::input() {
  CycleInput input;
  forActive([&](Injection& x) {
    if (x.kind->input) x.kind->input(x, input);
  });
  return input;
}

void Play::step(CycleInput input) {
  forActive([&](Injection& x) {
    if (x.kind->missed) input.missed_cycles += x.kind->missed(x);
  });
  if (input.missed_cycles > 0)
    input.late_in_a_row = std::max(input.late_in_a_row, input.missed_cycles + 1);
  has_stopped_ = has_stopped_ || input.stop_requested;
  has_forbidden_ = has_forbidden_ || input.has_forbidden_call;
  input.stop_requested = has_stopped_;
  input.has_forbidden_call = has_forbidden_;
  cell_.t_ns += input.missed_cycles * kMillisecond_ns;
  cell_.plant.advance(cell_.t_ns);
  act();
  deliverHeld();
  cell_.input = input;
  cell_.step();
  finish_(cell_);
  observe();
}

void Play::stepAlone() {
  act();
  cell_.plant.advance(cell_.t_ns += kMillisecond_ns);
  observe();
  now_.setpoint.setZero();
  now_.command.setZero();
}

void Play::observe() {
  const CycleInput& input = cell_.input;
  const ModeReport& report = cell_.cycle.report();
  now_.t_ms = now_ms();
  const Mode judged_in = std::exchange(now_.mode, report.mode);
  now_.fault = report.fault;
  now_.enable = input.lines.enable && input.lines.is_valid;
  now_.is_stop_requested = input.stop_requested;
  now_.is_emergency = input.lines.emergency_stop;
  const RealTimeConfig& real_time = stage_.scene.hardware->real_time;
  const bool is_late = input.late_in_a_row > real_time.max_late_cycles && judged_in != Mode::kBoot;
  const bool has_bus_fault = std::any_of(input.bus_faults.begin(), input.bus_faults.end(),
                                         [](Fault fault) { return fault != Fault::kNone; });
  now_.has_cause = input.lines.emergency_stop || input.are_lines_lost || has_bus_fault || is_late ||
                   input.has_forbidden_call;
  now_.is_brake_open = cell_.cycle.lines().release_brake;
  const CycleRecord record = cell_.record();
  const int joints = stage_.scene.controller.chain.size();
  now_.command = Eigen::Map<const Eigen::VectorXd>(record.dq, joints);
  now_.force_error_N = std::abs(record.force_sensor_N[0] - cell_.plant.world().trueForce_N());
  observeSetpoints();
  observePlant();
  observeInjections();
}

void Play::observeSetpoints() {
  const auto& drives = stage_.scene.hardware->drives;
  now_.setpoint = JointVector::Zero(static_cast<int>(drives.size()));
  for (std::size_t i = 0; i < drives.size(); ++i) {
    if (!cell_.monitors[drives[i].bus].maySend()) continue;
    for (const CanFrame& frame : cell_.cycle.outbox(drives[i].bus))
      if (frame.id == 0x200U + static_cast<unsigned>(drives[i].node_id))
        now_.setpoint[static_cast<int>(i)] =
            drives[i].sign * VirtualRobotCell::velocityCounts(frame) / drives[i].counts_per_unit;
  }
}

void Play::observePlant() {
  const int joints = stage_.scene.controller.chain.size();
  now_.velocity.resize(joints);
  now_.position.resize(joints);
  for (int i = 0; i < joints; ++i) {
    const SlaveDrive& drive = cell_.plant.drive(i);
    now_.velocity[i] = drive.velocity();
    now_.position[i] =
        drive.objects().getSigned(0x6064) / stage_.scene.hardware->drives[i].counts_per_unit;
  }
  now_.has_torque = !cell_.areDrivesLimp();
  now_.stale_setpoints = cell_.plant.counters().stale_setpoints_applied;
  now_.powers_taken = cell_.plant.counters().powers_taken_in_motion;
}

/// When it could first be seen: another trouble of the tactile module, that is over now, hid it. A
/// sample that lost a frame is news when it is sent again whole.
int Play::shownSince_ms(const Injection& x, int t_ms) const {
  int since_ms = x.from_ms;
  if (x.kind->where != InjectionKind::Where::kTactile) return since_ms;
  for (const Injection& other : injections_) {
    const bool hides = other.kind->where == x.kind->where && !isHand(other);
    if (hides && !other.isAtWork(t_ms) && other.from_ms <= t_ms)
      since_ms = std::max(since_ms, other.until_ms);
  }
  return since_ms;
}

void Play::observeInjections() {
  const int t_ms = now_ms() - 1;  // when it was done
  now_.is_calm = now_.is_free = true;
  now_.has_hand = false;
  const bool is_frame_new = gate_.troubled_ms() >= 0 && t_ms < gate_.troubled_ms() + kLateFrame_ms;
  now_.is_late_frame = is_frame_new;
  now_.may_let_go = gate_.hasSpoiltCommand() && is_frame_new;
  now_.hidden_cause = nullptr;
  now_.pushed = 0.0;
  for (const Injection& x : injections_) {
    const bool is_bus = x.kind->where == InjectionKind::Where::kBus;
    const bool is_new = t_ms >= x.from_ms && t_ms < x.until_ms + kLateFrame_ms;
    now_.is_late_frame |= is_bus && is_new;
    now_.may_let_go |= x.kind->lets_go && is_new;
    const bool is_hand = x.kind->receive == hand().receive;
    now_.has_hand |= is_hand && t_ms >= x.from_ms && t_ms < x.until_ms + kLastSample_ms;
    if (!x.isAtWork(t_ms)) continue;
    const bool is_in_place =
        x.kind == &push() && std::abs(x.offset) <= stage_.promise.start_tolerance;
    now_.is_free = now_.is_free && x.kind == &push() && x.offset == 0.0;
    now_.is_calm = now_.is_calm && (is_hand || is_in_place);
    // What else is at work may hide it, until no news at all comes.
    const bool is_tactile = x.kind->where == InjectionKind::Where::kTactile;
    const int silence_ms = injections_.size() < 2 ? 0 : is_tactile ? kStaleSample_ms : kSilent_ms;
    const int detected_ms = std::max(x.kind->detected_ms, silence_ms);
    if (x.kind->detected_ms > 0 && t_ms - shownSince_ms(x, t_ms) > detected_ms)
      now_.hidden_cause = x.kind->name;
    if (x.kind == &push()) now_.pushed = std::max(now_.pushed, std::abs(x.offset));
  }
  now_.pushed_ms = now_.pushed > 1.05 * stage_.promise.start_tolerance ? now_.pushed_ms + 1 : 0;
}

}  // namespace tactus::campaign
