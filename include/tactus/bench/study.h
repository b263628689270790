#pragma once

#include <string>
#include <vector>

#include "tactus/bench/plot.h"
#include "tactus/bench/table.h"

namespace tactus {

struct BenchOptions {
  std::vector<std::string> scenes;  ///< files for the studies that run scenes
  std::string scenes_folder;        ///< of those that come along
  bool is_quick = false;            ///< a look: few repetitions, short sweeps
  /// The program to run under valgrind to count instructions; empty: times only.
  std::string counting_program;
};

/// What a study set out to show: measured <= limit.
struct Goal {
  std::string text;
  double limit = 0.0;
  double measured = kNotMeasured;
};

/// A section of the report.
struct StudyResult {
  std::string title;
  std::string text;  ///< what was measured, and how
  std::vector<Goal> goals;
  std::vector<Plot> plots;
  std::vector<Table> tables;  ///< each also a CSV file
};

/// To add one: a function that returns its tables, and a line in studies.cpp.
struct Study {
  const char* name;
  const char* help;
  bool needs_scenes;
  bool is_default;  ///< runs if no study is asked for
  StudyResult (*run)(const BenchOptions& options);
};

const std::vector<Study>& studies();

/// All goals of all results as one table.
Table goalTable(const std::vector<StudyResult>& results);

StudyResult studyPseudoinverse(const BenchOptions& options);
StudyResult studyStep(const BenchOptions& options);
StudyResult studyClosedLoop(const BenchOptions& options);
StudyResult studyStability(const BenchOptions& options);
StudyResult studyLaw(const BenchOptions& options);
StudyResult studyContact(const BenchOptions& options);
StudyResult studyPhysics(const BenchOptions& options);
StudyResult studySeveral(const BenchOptions& options);
StudyResult studyClutter(const BenchOptions& options);
StudyResult studyBody(const BenchOptions& options);

}  // namespace tactus
