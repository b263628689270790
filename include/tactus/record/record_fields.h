#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/supervisor/cycle_record.h"

/// The one table of what a CycleRecord holds. The format of the log, the header of the CSV and the
/// comparison of a replay are all derived from it.
namespace tactus {

enum class FieldShape : std::uint8_t {
  kScalar,
  kPerJoint,
  kPerTaskComponent,
  kPerModule,   ///< a scalar for each tactile module
  kOfRotation,  ///< a scalar that only tasks with a rotation have
  kOfMomentX,   ///< likewise for each module, if any of them tells M_x
  kOfLoss,      ///< a scalar of robots that go on without a module
};
enum class FieldType : std::uint8_t { kDouble, kInt64, kUint64 };

/// What a field is to the controller; only outputs must come out of a replay again.
enum class FieldRole : std::uint8_t { kInput, kOutput, kObservation };

struct RecordField {
  const char* name;
  const char* unit;  ///< "" for a number without one
  FieldShape shape;
  FieldType type;
  FieldRole role;
  std::size_t offset;          ///< of the first word in a CycleRecord, bytes
  bool may_be_absent = false;  ///< from logs of older versions
};

/// All fields, in the order of CycleRecord's members, and of the CSV's columns for one module.
std::span<const RecordField> recordFields() noexcept;

/// How many entries the arrays of a record have.
struct RecordShape {
  int joints = 0;
  int task_size = 0;
  bool has_rotation = false;  ///< of the task
  int modules = 1;            ///< tactile; zeros for the one that a robot does not have
  bool has_moment_x = false;  ///< any of them
  bool has_loss = false;      ///< the arm may go on without one

  std::size_t entries(const RecordField& field) const noexcept;
  /// Whether the field is logged as an array, if only of one entry.
  bool isArray(const RecordField& field) const noexcept;
  bool operator==(const RecordShape&) const = default;
};

/// The type's name in a log: "double", "int64_t", "uint64_t".
const char* typeName(FieldType type) noexcept;

/// A column of the CSV: one word of a record.
struct RecordColumn {
  std::string name;        ///< "q_1" for the first entry of q; of a second module with "_2"
  std::string_view field;  ///< "q"
  FieldType type;
  FieldRole role;
  std::size_t offset;
};

/// What is of a second tactile module and of further ones comes after all else.
std::vector<RecordColumn> recordColumns(const RecordShape& shape);

/// What a record has there; of an integer the nearest number.
double numberAt(const CycleRecord& record, const RecordColumn& column) noexcept;

/// A stretch of bytes that lies in one piece both in a CycleRecord and in a message of the log.
struct CopyRun {
  std::size_t record_offset;
  std::size_t message_offset;
  std::size_t size;
};

/// Appends a run, joined to the last one where both sides continue it.
void appendRun(const CopyRun& run, std::vector<CopyRun>& runs);

}  // namespace tactus
