#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "support/random.h"
#include "support/random_robot.h"
#include "tactus/commission/commission_cycle.h"
#include "tactus/plant/plant.h"

namespace tactus::test {

/// What is true of a joint, and nobody knows.
struct HiddenJoint {
  bool is_prismatic = false;
  int bus = 0, node_id = 0, sign = 1;
  double counts_per_unit = 1e6, offset = 0.0, start = 0.0;
  double lower = -2.0, upper = 2.0;  ///< as far as it may go
  bool is_absent = false;
};

inline HardwareConfig hardwareOf(const std::vector<HiddenJoint>& joints, int buses,
                                 bool with_absent) {
  HardwareConfig hardware;
  for (int bus = 0; bus < buses; ++bus) hardware.buses.push_back({"can" + std::to_string(bus)});
  for (std::size_t i = 0; i < joints.size(); ++i) {
    if (joints[i].is_absent && !with_absent) continue;
    DriveConfig drive;
    drive.joint = static_cast<int>(i);
    drive.bus = joints[i].bus;
    drive.node_id = joints[i].node_id;
    drive.counts_per_unit = joints[i].counts_per_unit;
    drive.offset = joints[i].offset;
    drive.sign = joints[i].sign;
    hardware.drives.push_back(drive);
  }
  return hardware;
}

/// A robot in software of which the true set-up is hidden, an engineer who sees and measures it,
/// and the cycle that commissions it, in virtual time.
class CommissionRig {
 public:
  static constexpr double kPeriod_s = 0.001;

  CommissionRig(const std::vector<HiddenJoint>& hidden, const CommissionConfig& given,
                std::uint64_t seed)
      : truth(hidden),
        config(given),
        random(seed),
        hardware_(hardwareOf(hidden, static_cast<int>(given.hardware.buses.size()), false)),
        plant(robotOf(hidden), laggingDrives(), hardware_, kPeriod_s, {}),
        seen_(hidden.size(), 0.0),
        at_question_(hidden.size(), 0.0) {
    for (std::size_t j = 0; j < truth.size(); ++j) seen_[j] = at_question_[j] = position(int(j));
    restart();
  }

  /// Anew, as a program that is started again: the plant is as it was left.
  void restart() { cycle = std::make_unique<CommissionCycle>(config); }

  const SlaveDrive& drive(int joint) const { return plant.drive(indexOf(joint)); }
  double position(int joint) const {
    if (truth[joint].is_absent) return truth[joint].start;
    const std::int32_t counts = drive(joint).objects().getSigned(0x6064);
    return truth[joint].sign * counts / truth[joint].counts_per_unit + truth[joint].offset;
  }

  void step() {
    plant.advance(t_ns);
    for (int bus = 0; bus < plant.buses(); ++bus) {
      FrameBatch frames, data;
      plant.take(bus, frames);
      for (CanFrame frame : frames)
        if (frame.kind == FrameKind::kData && (!on_frame || on_frame(bus, frame))) data.push(frame);
      cycle->receive(bus, data.frames());
    }
    for (const auto& [bus, frame] : own_answers) cycle->receive(bus, {&frame, 1});
    own_answers.clear();
    cycle->update(input);
    for (int bus = 0; bus < plant.buses(); ++bus)
      for (CanFrame frame : cycle->outbox(bus))
        if (!on_send || on_send(bus, frame)) plant.send(bus, frame, t_ns + 100'000);
    t_ns += 1'000'000LL * (1 + input.missed_cycles);
    input.missed_cycles = 0;
    judge();
  }

  bool scan(int most_cycles = 4000) {
    for (int i = 0; i < most_cycles && cycle->phase() == CommissionCycle::Phase::kScanning; ++i)
      step();
    return cycle->phase() == CommissionCycle::Phase::kIdle;
  }

  /// Until the joint is finished, or the cycles are over.
  bool commission(int joint, long most_cycles = 2'000'000) {
    cycle->begin(joint);
    for (long i = 0; i < most_cycles; ++i) {
      if (cycle->phase() == CommissionCycle::Phase::kIdle) return true;
      if (cycle->question()) {
        noteQuestion();
        const Answer given = answer(*cycle->question());
        if (!cycle->answer(given)) {
          ADD_FAILURE() << "no answer to " << static_cast<int>(cycle->question()->asked);
          return false;
        }
      }
      step();
      if (on_cycle) on_cycle();
    }
    return false;
  }

  /// The engineer looks at the arm.
  void noteQuestion() {
    seen_ = at_question_;
    for (std::size_t j = 0; j < truth.size(); ++j) at_question_[j] = position(int(j));
  }

  void cycles(int count) {
    for (int i = 0; i < count; ++i) step();
  }

  /// As right as an engineer is.
  double measured(int joint) {
    const double error = config.bounds(joint).measuring_error;
    return position(joint) + random.uniform(-error, error);
  }

  Answer answer(const Question& question) {
    using Kind = Answer::Kind;
    if (on_question) {
      if (const auto own = on_question(question)) return *own;
    }
    const int joint = question.joint;
    switch (question.asked) {
      case Asked::kReady:
        return {Kind::kYes};
      case Asked::kDirection:
        return direction(joint);
      case Asked::kPlace:
      case Asked::kEndPlace:
        return {Kind::kNumber, measured(joint)};
      case Asked::kJog:
        break;
    }
    return jog(joint);
  }

  bool isOff(int joint) const {
    const PowerState state = drive(joint).powerState();
    return state == PowerState::kNotReadyToSwitchOn || state == PowerState::kSwitchOnDisabled ||
           state == PowerState::kReadyToSwitchOn || state == PowerState::kFault;
  }
  bool isAllOffAndAtRest() const {
    for (std::size_t j = 0; j < truth.size(); ++j) {
      if (truth[j].is_absent) continue;
      if (!isOff(int(j)) || drive(int(j)).velocity() != 0.0) return false;
    }
    return true;
  }

  std::vector<HiddenJoint> truth;
  CommissionConfig config;
  Random random;

 private:
  HardwareConfig hardware_;

 public:
  Plant plant;
  std::unique_ptr<CommissionCycle> cycle;
  CommissionInput input;
  std::int64_t t_ns = 0;
  std::function<bool(int bus, CanFrame&frame)> on_frame, on_send;  ///< false: lost
  std::function<void()> on_cycle;
  std::function<std::optional<Answer>(const Question&)> on_question;
  std::vector<std::pair<int, CanFrame>> own_answers;  ///< to be heard in the next cycle
  double worst_speed = 0.0, worst_travel = 0.0;       ///< shares of what is allowed
  int most_powered = 0;                               ///< drives at once
  bool jogs = true;

 private:
  static PlantConfig laggingDrives() {
    PlantConfig config;
    config.drive_lag_s = 0.004;
    return config;
  }

  static ControllerConfig robotOf(const std::vector<HiddenJoint>& joints) {
    Random chance(7);
    ControllerConfig robot = randomController(chance, static_cast<int>(joints.size()), 2);
    robot.tactile_modules.clear();
    for (std::size_t j = 0; j < joints.size(); ++j)
      robot.q_start[static_cast<int>(j)] = joints[j].start;
    return robot;
  }

  int indexOf(int joint) const {
    int index = 0;
    for (int j = 0; j < joint; ++j) index += truth[j].is_absent ? 0 : 1;
    return index;
  }

  Answer direction(int joint) {
    int moved = -1;
    for (std::size_t j = 0; j < truth.size(); ++j) {
      const double way = std::abs(at_question_[j] - seen_[j]);
      if (way >= config.bounds(int(j)).unseen) moved = int(j);
    }
    if (moved < 0) return {Answer::Kind::kNothing};
    if (moved != joint) return {Answer::Kind::kOtherJoint, 0.0, moved};
    return {at_question_[joint] > seen_[joint] ? Answer::Kind::kPlus : Answer::Kind::kMinus};
  }

  /// To the upper end, then to the lower one.
  Answer jog(int joint) {
    using Kind = Answer::Kind;
    const double step = 1.2 * config.bounds(joint).max_travel, q = position(joint);
    if (!jogs) return {Kind::kDone};
    if (jogged_ != joint) jogged_ = joint, has_upper_ = has_lower_ = false;
    if (!has_upper_) {
      has_upper_ = q + step > truth[joint].upper;
      return {has_upper_ ? Kind::kUpper : Kind::kPlus};
    }
    if (!has_lower_) {
      has_lower_ = q - step < truth[joint].lower;
      return {has_lower_ ? Kind::kLower : Kind::kMinus};
    }
    return {Kind::kDone};
  }

  /// The true motion, whatever anybody believes.
  void judge() {
    if (rest_.empty() || cycle->phase() != CommissionCycle::Phase::kMoving) {
      rest_.assign(truth.size(), 0.0);
      for (std::size_t j = 0; j < truth.size(); ++j) rest_[j] = position(int(j));
    }
    int powered = 0;
    for (std::size_t j = 0; j < truth.size(); ++j) {
      if (truth[j].is_absent) continue;
      const MotionBounds& bounds = config.bounds(int(j));
      powered += isOff(int(j)) ? 0 : 1;
      worst_speed = std::max(worst_speed, std::abs(drive(int(j)).velocity()) / bounds.max_speed);
      worst_travel =
          std::max(worst_travel, std::abs(position(int(j)) - rest_[j]) / bounds.max_travel);
    }
    most_powered = std::max(most_powered, powered);
  }

  std::vector<double> seen_, at_question_, rest_;
  int jogged_ = -1;
  bool has_upper_ = false, has_lower_ = false;
};

}  // namespace tactus::test
