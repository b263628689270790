#include "tactus/record/record_fields.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>

namespace tactus {
namespace {

using enum FieldShape;
using enum FieldType;
using enum FieldRole;

constexpr std::size_t kWord = sizeof(double);
constexpr std::size_t kToolError = offsetof(CycleRecord, tool_error_m);

#define AT(member) offsetof(CycleRecord, member)
constexpr std::array kFields = {
    RecordField{"t_s", "s", kScalar, kDouble, kInput, AT(t_s)},
    RecordField{"force_sensor_N", "N", kPerModule, kDouble, kOutput, AT(force_sensor_N)},
    RecordField{"contact_position_m", "m", kPerModule, kDouble, kOutput, AT(contact_position_m)},
    RecordField{"contact_dir_x", "", kPerModule, kDouble, kOutput, AT(contact_dir_x)},
    RecordField{"contact_dir_y", "", kPerModule, kDouble, kOutput, AT(contact_dir_y)},
    RecordField{"contact_dir_z", "", kPerModule, kDouble, kOutput, AT(contact_dir_z)},
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
    RecordField{"tactile_force_y_N", "N", kPerModule, kDouble, kInput, AT(tactile_force_y_N)},
    RecordField{"tactile_force_z_N", "N", kPerModule, kDouble, kInput, AT(tactile_force_z_N)},
    RecordField{"tactile_moment_y_Nm", "Nm", kPerModule, kDouble, kInput, AT(tactile_moment_y_Nm)},
    RecordField{"tactile_moment_z_Nm", "Nm", kPerModule, kDouble, kInput, AT(tactile_moment_z_Nm)},
    RecordField{"tactile_sequence", "", kPerModule, kUint64, kInput, AT(tactile_sequence)},
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
    RecordField{"tactile_moment_x_Nm", "Nm", kOfMomentX, kDouble, kInput, AT(tactile_moment_x_Nm),
                true},
    RecordField{"modules_lost", "", kOfLoss, kUint64, kOutput, AT(modules_lost), true},
    RecordField{"speed_share", "", kOfLoss, kDouble, kOutput, AT(speed_share), true},
};
#undef AT

bool isOfModule(const RecordField& field) noexcept {
  return field.shape == kPerModule || field.shape == kOfMomentX;
}

}  // namespace

std::span<const RecordField> recordFields() noexcept { return kFields; }

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
    case kPerModule:
      return static_cast<std::size_t>(modules);
    case kOfMomentX:
      return has_moment_x ? static_cast<std::size_t>(modules) : 0;
    case kOfLoss:
      return has_loss ? 1 : 0;
  }
  return 0;
}

bool RecordShape::isArray(const RecordField& field) const noexcept {
  return field.shape == kPerJoint || field.shape == kPerTaskComponent ||
         (isOfModule(field) && modules > 1);
}

const char* typeName(FieldType type) noexcept {
  if (type == kDouble) return "double";
  return type == kInt64 ? "int64_t" : "uint64_t";
}

std::vector<RecordColumn> recordColumns(const RecordShape& shape) {
  std::vector<RecordColumn> columns;
  const auto add = [&](const RecordField& field, std::size_t entry, bool is_numbered) {
    std::string name = field.name;
    if (is_numbered) name += fmt::format("_{}", entry + 1);
    columns.push_back(
        {std::move(name), field.name, field.type, field.role, field.offset + entry * kWord});
  };
  for (const RecordField& field : kFields) {
    const bool is_module = isOfModule(field);
    const std::size_t entries =
        is_module ? std::min<std::size_t>(1, shape.entries(field)) : shape.entries(field);
    for (std::size_t i = 0; i < entries; ++i) add(field, i, !is_module && shape.isArray(field));
  }
  for (std::size_t module = 1; module < static_cast<std::size_t>(shape.modules); ++module) {
    for (const RecordField& field : kFields)
      if (isOfModule(field) && shape.entries(field) > 0) add(field, module, true);
  }
  return columns;
}

double numberAt(const CycleRecord& record, const RecordColumn& column) noexcept {
  const char* const word = reinterpret_cast<const char*>(&record) + column.offset;
  if (column.type == FieldType::kDouble) {
    double number;
    std::memcpy(&number, word, sizeof(number));
    return number;
  }
  std::int64_t number;
  std::memcpy(&number, word, sizeof(number));
  return static_cast<double>(number);
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
