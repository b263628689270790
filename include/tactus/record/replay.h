#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "tactus/control/controller.h"
#include "tactus/record/csv_writer.h"
#include "tactus/record/log_continuity.h"
#include "tactus/record/record_fields.h"

namespace tactus {

/// Feeds the inputs of a log to a controller.
class Replayer {
 public:
  /// `controller` has to outlive this and to have `joints` joints. has_missed: see LogContinuity.
  Replayer(const Controller& controller, int joints, double period_s, bool has_missed = true);

  void beginPart(int part) noexcept { continuity_.beginPart(part); }

  /// The next cycle: the recorded inputs and observations with the controller's present outputs.
  CycleRecord replay(const CycleRecord& recorded);

  /// Whether the outputs of that cycle mean something: the controller's state is known.
  bool isKnown() const noexcept { return is_known_; }
  const std::vector<UnknownStretch>& unknown() const noexcept { return continuity_.stretches(); }

 private:
  void follow(const CycleRecord& recorded) noexcept;

  const Controller& controller_;
  int joints_;
  double period_s_;
  LogContinuity continuity_;
  bool is_known_ = true;
  Mode mode_before_ = Mode::kBoot;
  ControllerState state_;
  ControllerOutput output_;
};

/// One number that a log and its replay disagree on.
struct ReplayDifference {
  long long cycle = 0;  ///< counts from 0, those that were not compared included
  double t_s = 0.0;
  std::string column;
  double recorded = 0.0, replayed = 0.0;
  double size() const noexcept;  ///< |recorded - replayed|
};

/// Compares a log with its replay, cycle by cycle.
class ReplayComparison {
 public:
  explicit ReplayComparison(const RecordShape& shape);

  void add(const CycleRecord& recorded, const CycleRecord& replayed);
  /// A cycle that is not compared.
  void skip() noexcept { ++skipped_; }

  long long cycles() const noexcept { return cycles_; }  ///< compared
  long long skipped() const noexcept { return skipped_; }
  long long differingCycles() const noexcept { return differing_cycles_; }

  /// The first output that is not equal bit for bit.
  const std::optional<ReplayDifference>& first() const noexcept { return first_; }

  /// The largest differences of the commanded velocity and of u_n, u_j and u_t; without an entry
  /// where there is none.
  std::vector<ReplayDifference> largest() const;

 private:
  struct Group {
    std::vector<RecordColumn> columns;
    std::optional<ReplayDifference> largest;
  };

  void compareBits(const CycleRecord& recorded, const CycleRecord& replayed);
  void compareSizes(const CycleRecord& recorded, const CycleRecord& replayed, Group& group) const;
  ReplayDifference difference(const RecordColumn& column, const CycleRecord& recorded,
                              const CycleRecord& replayed) const;

  std::vector<RecordColumn> outputs_;
  std::array<Group, 4> groups_;
  long long cycles_ = 0, skipped_ = 0;
  long long differing_cycles_ = 0;
  std::optional<ReplayDifference> first_;
};

/// Recorded and replayed side by side: t_s, dq_i_recorded.., dq_i_replayed.., then pairs of the
/// columns of the force law.
class ReplayCsv {
 public:
  /// Errors as of OutputFile.
  ReplayCsv(const std::string& path, const RecordShape& shape);

  void add(const CycleRecord& recorded, const CycleRecord& replayed);
  void close() { csv_.close(); }

 private:
  CsvWriter csv_;
  std::vector<RecordColumn> dq_, law_;
};

}  // namespace tactus
