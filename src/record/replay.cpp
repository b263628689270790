#include "tactus/record/replay.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>

#include "tactus/supervisor/apply_mode.h"

namespace tactus {
namespace {

constexpr std::array<std::string_view, 7> kLawColumns = {
    "force_contact_N", "stiffness_N_per_m", "gamma", "x_dot_eff_m_per_s", "u_n", "u_j", "u_t"};

/// The columns of one field: "q" has q_1, q_2 and so on.
std::vector<RecordColumn> columnsOf(std::string_view field, const RecordShape& shape) {
  std::vector<RecordColumn> columns = recordColumns(shape);
  std::erase_if(columns, [field](const RecordColumn& column) { return column.field != field; });
  return columns;
}

const char* wordAt(const CycleRecord& record, const RecordColumn& column) noexcept {
  return reinterpret_cast<const char*>(&record) + column.offset;
}

}  // namespace

Replayer::Replayer(const Controller& controller, int joints, double period_s, bool has_missed)
    : controller_(controller),
      joints_(joints),
      period_s_(period_s),
      continuity_(controller.config(), period_s, has_missed),
      state_(controller.initialState()) {}

CycleRecord Replayer::replay(const CycleRecord& recorded) {
  CycleRecord replayed = recorded;
  const RobotInput input = recordedInput(recorded, joints_);
  const Mode mode = static_cast<Mode>(recorded.mode);
  const bool was_known = is_known_;
  is_known_ = continuity_.add(recorded);
  const int missed = continuity_.missedCycles();
  const double waited_s = state_.waited_s;
  if (missed > 0) controller_.coast(missed, period_s_, state_);
  if (mode != Mode::kRunning) state_.waited_s = waited_s;  // nor did the task's clock go on
  if (is_known_ && !was_known) state_.waited_s = 0.0;
  if (state_.tool_motion && !isSame(state_.tool_motion->plan(), recorded.tool_motion))
    state_.tool_motion.emplace(recorded.tool_motion);
  applyMode(controller_, mode, mode_before_, input, recorded.gains, state_);
  controller_.update(input, recorded.gains, recorded.task_time_s, period_s_, state_, output_);
  mode_before_ = mode;
  if (!is_known_) follow(recorded);
  fillRecord(recorded.t_s, input, recorded.gains, output_,
             Eigen::Map<const Vector3>(recorded.tool_error_m), replayed);
  return replayed;
}

/// Where the arm was commanded to be next, and where and how hard it was touched at last, whatever
/// the controller makes of a state that is unknown: a reset keeps that.
void Replayer::follow(const CycleRecord& recorded) noexcept {
  const JointLimits& limits = controller_.config().limits;
  for (int i = 0; i < joints_; ++i) {
    const double q = recorded.q[i] + period_s_ * recorded.dq[i];
    state_.q_desired[i] = std::clamp(q, limits.lower[i], limits.upper[i]);
    state_.velocity_before[i] = recorded.dq[i];  // kept up in missed cycles
  }
  for (std::size_t i = 0; i < controller_.config().tactile_modules.size(); ++i) {
    ContactPointState& contact = state_.modules[i].contact;
    contact.force_N = recorded.force_sensor_N[i];
    contact.position_m = recorded.contact_position_m[i];
    contact.direction = {recorded.contact_dir_x[i], recorded.contact_dir_y[i],
                         recorded.contact_dir_z[i]};
  }
}

double ReplayDifference::size() const noexcept { return std::abs(recorded - replayed); }

ReplayComparison::ReplayComparison(const RecordShape& shape) : outputs_(recordColumns(shape)) {
  std::erase_if(outputs_,
                [](const RecordColumn& column) { return column.role != FieldRole::kOutput; });
  constexpr std::array<std::string_view, 4> kComparedFields = {"dq", "u_n", "u_j", "u_t"};
  for (std::size_t i = 0; i < kComparedFields.size(); ++i)
    groups_[i].columns = columnsOf(kComparedFields[i], shape);
}

void ReplayComparison::add(const CycleRecord& recorded, const CycleRecord& replayed) {
  compareBits(recorded, replayed);
  for (Group& group : groups_) compareSizes(recorded, replayed, group);
  ++cycles_;
}

std::vector<ReplayDifference> ReplayComparison::largest() const {
  std::vector<ReplayDifference> result;
  for (const Group& group : groups_) {
    if (group.largest) result.push_back(*group.largest);
  }
  return result;
}

void ReplayComparison::compareBits(const CycleRecord& recorded, const CycleRecord& replayed) {
  const auto differs = [&](const RecordColumn& column) {
    return std::memcmp(wordAt(recorded, column), wordAt(replayed, column), sizeof(double)) != 0;
  };
  const auto found = std::find_if(outputs_.begin(), outputs_.end(), differs);
  if (found == outputs_.end()) return;
  ++differing_cycles_;
  if (!first_) first_ = difference(*found, recorded, replayed);
}

void ReplayComparison::compareSizes(const CycleRecord& recorded, const CycleRecord& replayed,
                                    Group& group) const {
  for (const RecordColumn& column : group.columns) {
    const double size = std::abs(numberAt(recorded, column) - numberAt(replayed, column));
    if (size > (group.largest ? group.largest->size() : 0.0)) {
      group.largest = difference(column, recorded, replayed);
    }
  }
}

ReplayDifference ReplayComparison::difference(const RecordColumn& column,
                                              const CycleRecord& recorded,
                                              const CycleRecord& replayed) const {
  return {cycles_ + skipped_, recorded.t_s, column.name, numberAt(recorded, column),
          numberAt(replayed, column)};
}

ReplayCsv::ReplayCsv(const std::string& path, const RecordShape& shape)
    : csv_(path), dq_(columnsOf("dq", shape)) {
  for (const std::string_view name : kLawColumns) law_.push_back(columnsOf(name, shape).front());
  csv_.add("t_s");
  for (const RecordColumn& column : dq_) csv_.add(column.name + "_recorded");
  for (const RecordColumn& column : dq_) csv_.add(column.name + "_replayed");
  for (const RecordColumn& column : law_) {
    csv_.add(column.name + "_recorded");
    csv_.add(column.name + "_replayed");
  }
  csv_.endLine();
}

void ReplayCsv::add(const CycleRecord& recorded, const CycleRecord& replayed) {
  csv_.add(recorded.t_s);
  for (const RecordColumn& column : dq_) csv_.add(recorded, column);
  for (const RecordColumn& column : dq_) csv_.add(replayed, column);
  for (const RecordColumn& column : law_) {
    csv_.add(recorded, column);
    csv_.add(replayed, column);
  }
  csv_.endLine();
}

}  // namespace tactus
