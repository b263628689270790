#include "tactus/record/record_fields.h"

#include <fmt/format.h>

#include <array>
#include <utility>

namespace tactus {
namespace {

using enum FieldShape;
using enum FieldType;
using enum FieldRole;

constexpr std::size_t kWord = sizeof(double);
constexpr std::size_t kDirection = offsetof(CycleRecord, contact_direction);
constexpr std::size_t kToolError = offsetof(CycleRecord, tool_error_m);

#define AT(member) offsetof(CycleRecord, member)
constexpr std::array kFields = {
    RecordField{"t_s", "s", kScalar, kDouble, kInput, AT(t_s)},
    RecordField{"force_sensor_N", "N", kScalar, kDouble, kOutput, AT(force_sensor_N)},
    RecordField{"contact_position_m", "m", kScalar, kDouble, kOutput, AT(contact_position_m)},
    RecordField{"contact_dir_x", "", kScalar, kDouble, kOutput, kDirection},
    RecordField{"contact_dir_y", "", kScalar, kDouble, kOutput, kDirection + kWord},
    RecordField{"contact_dir_z", "", kScalar, kDouble, kOutput, kDirection + 2 * kWord},
    RecordField{"force_contact_N", "N", kScalar, kDouble, kOutput, AT(force_contact_N)},
    RecordField{"stiffness_N_per_m", "N/m", kScalar, kDouble, kOutput, AT(stiffness_N_per_m)},
    RecordField{"stiffness_raw_N_per_m", "N/m", kScalar, kDouble, kOutput,
                AT(stiffness_raw_N_per_m)},
    RecordField{"gamma", "", kScalar, kDouble, kOutput, AT(gamma)},
    RecordField{"k_n", "m^2", kScalar, kDouble, kOutput, AT(k_n)},
    RecordField{"k_j", "m^2", kScalar, kDouble, kOutput, AT(k_j)},
    RecordField{"k_t", "m^2", kScalar, kDouble, kOutput, AT(k_t)},
    RecordField{"x_dot_eff_m_per_s", "m/s", kScalar, kDouble, kOutput, AT(x_dot_eff_m_per_s)},
    RecordField{"u_n", "1/(m s)", kScalar, kDouble, kOutput, AT(u_n)},
    RecordField{"u_j", "1/(m s)", kScalar, kDouble, kOutput, AT(u_j)},
    RecordField{"u_t", "1/(m s)", kScalar, kDouble, kOutput, AT(u_t)},
    RecordField{"q", "m or rad", kPerJoint, kDouble, kOutput, AT(q)},
    RecordField{"dq", "m/s or rad/s", kPerJoint, kDouble, kOutput, AT(dq)},
    RecordField{"w", "m or rad", kPerTaskComponent, kDouble, kOutput, AT(w)},
    RecordField{"wd", "m or rad", kPerTaskComponent, kDouble, kOutput, AT(wd)},
    RecordField{"wd_dot", "m/s or rad/s", kPerTaskComponent, kDouble, kOutput, AT(wd_dot)},
    RecordField{"fault", "", kScalar, kUint64, kObservation, AT(fault)},
    RecordField{"wake_latency_ns", "ns", kScalar, kInt64, kObservation, AT(wake_latency_ns)},
    RecordField{"step_ns", "ns", kScalar, kInt64, kObservation, AT(step_ns)},
    RecordField{"q_measured", "m or rad", kPerJoint, kDouble, kInput, AT(q_measured)},
    RecordField{"tactile_force_y_N", "N", kScalar, kDouble, kInput, AT(tactile_force_y_N)},
    RecordField{"tactile_force_z_N", "N", kScalar, kDouble, kInput, AT(tactile_force_z_N)},
    RecordField{"tactile_moment_y_Nm", "Nm", kScalar, kDouble, kInput, AT(tactile_moment_y_Nm)},
    RecordField{"tactile_moment_z_Nm", "Nm", kScalar, kDouble, kInput, AT(tactile_moment_z_Nm)},
    RecordField{"tactile_sequence", "", kScalar, kUint64, kInput, AT(tactile_sequence)},
    RecordField{"tool_error_x_m", "m", kScalar, kDouble, kObservation, kToolError},
    RecordField{"tool_error_y_m", "m", kScalar, kDouble, kObservation, kToolError + kWord},
    RecordField{"tool_error_z_m", "m", kScalar, kDouble, kObservation, kToolError + 2 * kWord},
    RecordField{"task_time_s", "s", kScalar, kDouble, kInput, AT(task_time_s)},
    RecordField{"mode", "", kScalar, kUint64, kInput, AT(mode)},
    RecordField{"read_ns", "ns", kScalar, kInt64, kObservation, AT(read_ns)},
    RecordField{"write_ns", "ns", kScalar, kInt64, kObservation, AT(write_ns)},
    RecordField{"missed_cycles", "", kScalar, kUint64, kInput, AT(missed_cycles), true},
    RecordField{"path_time_s", "s", kScalar, kDouble, kOutput, AT(path_time_s), true},
    RecordField{"tool_rotation_error_rad", "rad", kOfRotation, kDouble, kObservation,
                AT(tool_rotation_error_rad), true},
};
#undef AT

}  // namespace

std::span<const RecordField> recordFields() noexcept { return kFields; }

bool isArray(FieldShape shape) noexcept { return shape == kPerJoint || shape == kPerTaskComponent; }

std::size_t RecordShape::entries(const RecordField& field) const noexcept {
  switch (field.shape) {
    case kScalar:
      return 1;
    case kPerJoint:
      return static_cast<std::size_t>(joints);
    case kPerTaskComponent:
      return static_cast<std::size_t>(task_size);
    case kOfRotation:
      return has_rotation ? 1 : 0;
  }
  return 0;
}

const char* typeName(FieldType type) noexcept {
  if (type == kDouble) return "double";
  return type == kInt64 ? "int64_t" : "uint64_t";
}

std::vector<RecordColumn> recordColumns(const RecordShape& shape) {
  std::vector<RecordColumn> columns;
  for (const RecordField& field : kFields) {
    for (std::size_t i = 0; i < shape.entries(field); ++i) {
      std::string name = field.name;
      if (isArray(field.shape)) name += fmt::format("_{}", i + 1);
      columns.push_back(
          {std::move(name), field.name, field.type, field.role, field.offset + i * kWord});
    }
  }
  return columns;
}

void appendRun(const CopyRun& run, std::vector<CopyRun>& runs) {
  if (!runs.empty()) {
    CopyRun& last = runs.back();
    if (last.record_offset + last.size == run.record_offset &&
        last.message_offset + last.size == run.message_offset) {
      last.size += run.size;
      return;
    }
  }
  runs.push_back(run);
}

}  // namespace tactus
