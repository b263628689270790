#include "tactus/bench/step_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/bench/instruction_count.h"
#include "tactus/bench/study.h"
#include "tactus/bench/timing.h"

namespace tactus {
namespace {

/// Somewhere for results to go, so that no compiler can leave the work out.
volatile double g_sink = 0.0;

TimeStatistics warmTime(const StepCase& step_case, int batches) {
  const auto batch = [&] {
    for (int i = 0; i < kStepStates; ++i) step_case.step(i);
    g_sink = step_case.command().sum();
  };
  return timeWarm(batches, kStepStates, step_case.prepare, batch);
}

TimeStatistics coldTime(const StepCase& step_case, int calls, CacheWalker& walker) {
  const auto prepare = [&](int i) {
    if (i % kStepStates == 0) step_case.prepare();
  };
  const TimeStatistics time =
      timeCold(calls, walker, prepare, [&](int i) { step_case.step(i % kStepStates); });
  g_sink = step_case.command().sum();
  return time;
}

double numberOf(const Table& table, const char* code, int joints, int task_components, int contacts,
                const char* column) {
  return findNumber(table, column,
                    {{"code", std::string(code)},
                     {"joints", double(joints)},
                     {"task_components", double(task_components)},
                     {"contacts", double(contacts)}});
}

/// The largest share of ours in the other's, over all sizes.
Goal shareGoal(const Table& table, const StepSizes& sizes, const char* other, int contacts,
               int other_contacts, double limit, const char* column) {
  Goal goal;
  goal.text = fmt::format("step, {} contacts: share of {}'s {}, largest over all sizes", contacts,
                          other, column);
  goal.limit = limit;
  double largest = 0.0;
  for (const int n : sizes.joints) {
    largest = std::max(largest, numberOf(table, kCodeOurs, n, 3, contacts, column) /
                                    numberOf(table, other, n, 3, other_contacts, column));
    if (std::isnan(numberOf(table, kCodeOurs, n, 3, contacts, column))) return goal;
  }
  goal.measured = largest;
  return goal;
}

Plot makePlot(const Table& table, const char* column, const char* label) {
  Plot plot;
  plot.title = fmt::format("{} of one step over the number of joints.", label);
  plot.note = "Position task (3 components), unless 6 are named.";
  plot.table = table.name;
  plot.x_label = plot.x_column = "joints";
  plot.y_label = plot.y_column = column;
  plot.x_scale = Scale::kLinear;
  struct Line {
    const char* code;
    int task_components, contacts;
  };
  const Line lines[] = {{kCodePrepared, 3, 1}, {kCodeOurs, 3, 0},     {kCodeOurs, 3, 1},
                        {kCodeOurs, 6, 1},     {kCodeSvd, 3, 0},      {kCodeSvd, 3, 1},
                        {kCodeSvd, 6, 1},      {kCodeKdl, 3, 0},      {kCodeKdl, 3, 1},
                        {kCodeKdl, 6, 1},      {kCodeWdlsOnce, 3, 0}, {kCodeNsoOnce, 6, 0}};
  for (const Line& line : lines)
    plot.series.push_back(
        {fmt::format("{}{}, {}", line.code, line.task_components == 6 ? " (6)" : "",
                     line.contacts > 0 ? "contact" : "free"),
         {{"code", std::string(line.code)},
          {"task_components", double(line.task_components)},
          {"contacts", double(line.contacts)}}});
  return plot;
}

/// What is left between the reading of the sensor and the command.
Goal slackGoal(const Table& table, const StepSizes& sizes, int contacts, const char* column) {
  Goal goal = shareGoal(table, sizes, kCodeOurs, contacts, contacts, 1.0 / 3.0, column);
  goal.text = fmt::format("step, {} contacts: share of the whole step's {} from sensor to command",
                          contacts, column);
  double largest = 0.0;
  for (const int n : sizes.joints)
    largest = std::max(largest, numberOf(table, kCodePrepared, n, 3, contacts, column) /
                                    numberOf(table, kCodeOurs, n, 3, contacts, column));
  if (!std::isnan(goal.measured)) goal.measured = largest;
  return goal;
}

Goal linearGoal(const Table& table, int contacts) {
  Goal goal;
  goal.text = fmt::format(
      "step, {} contacts: instructions over joints, deviation from a straight line", contacts);
  goal.limit = 0.05;
  const auto points = findPoints(
      table, "joints", "instructions",
      {{"code", std::string(kCodeOurs)}, {"task_components", 3.0}, {"contacts", double(contacts)}});
  goal.measured = deviationFromLine(points);
  return goal;
}

}  // namespace

std::vector<StepCase> allStepCases(const std::vector<int>& joints) {
  std::vector<StepCase> cases;
  for (const int n : joints) {
    for (const int task_components : {3, 6}) {
      for (const int contacts : {0, 1}) {
        if (n <= task_components && contacts > 0) continue;  // nothing left to give way with
        for (StepCase& step_case : stepCases(n, task_components, contacts))
          cases.push_back(std::move(step_case));
      }
    }
  }
  return cases;
}

Table measureSteps(const StepSizes& sizes, const std::map<std::string, double>& instructions) {
  Table table{"step",
              {"code", "joints", "task_components", "contacts", "warm_ns", "warm_median_ns",
               "cold_ns", "cold_p90_ns", "instructions"},
              {}};
  CacheWalker walker;
  for (const StepCase& step_case : allStepCases(sizes.joints)) {
    const TimeStatistics warm = warmTime(step_case, sizes.batches);
    const TimeStatistics cold = coldTime(step_case, sizes.cold_steps, walker);
    const auto count = instructions.find(countLabel(step_case));
    table.rows.push_back({step_case.code, double(step_case.joints),
                          double(step_case.task_components), double(step_case.contacts),
                          warm.fastest, warm.median, cold.median, cold.p90,
                          count == instructions.end() ? kNotMeasured : count->second});
  }
  return table;
}

double deviationFromLine(const std::vector<std::array<double, 2>>& points) {
  const auto count = static_cast<double>(points.size());
  double x_mean = 0.0, y_mean = 0.0, xx = 0.0, xy = 0.0;
  for (const auto& [x, y] : points) {
    x_mean += x / count;
    y_mean += y / count;
  }
  for (const auto& [x, y] : points) {
    xx += (x - x_mean) * (x - x_mean);
    xy += (x - x_mean) * (y - y_mean);
  }
  double largest = 0.0;
  for (const auto& [x, y] : points) {
    const double deviation = std::abs(y_mean + xy / xx * (x - x_mean) - y) / y;
    largest = std::isnan(deviation) ? deviation : std::max(largest, deviation);
  }
  return largest;
}

StudyResult studyStep(const BenchOptions& options) {
  StepSizes sizes;
  if (options.is_quick) {
    sizes.batches = 3;
    sizes.cold_steps = 8;
  }
  std::map<std::string, double> instructions;
  if (!options.counting_program.empty())
    instructions = countInstructions({options.counting_program, "--count-steps"});
  const Table table = measureSteps(sizes, instructions);

  StudyResult result;
  result.title = "Whole control step";
  result.text = fmt::format(
      "From the reading of the robot to the command. Ours, plain Eigen and KDL compute the same "
      "laws "
      "(null and task space, estimator, joint limits) and the same commands; plain Eigen forms J# "
      "by "
      "an SVD and N = I - J# J, KDL solves by wdls for each of w, N dH/dq and N a. One solve is "
      "the "
      "tool's error and one call of KDL's solver: less than a step. Warm: the fastest of {} "
      "batches "
      "of "
      "{} steps; cold: medians, {} MiB of memory walked before each step. Instructions: {}.",
      sizes.batches, kStepStates, CacheWalker::kBytes >> 20,
      instructions.empty() ? "not counted, valgrind is missing" : "counted by callgrind");
  result.plots = {makePlot(table, "instructions", "Instructions"),
                  makePlot(table, "warm_ns", "Time, warm,"),
                  makePlot(table, "cold_ns", "Time, cold,")};
  for (const char* column : {"instructions", "warm_ns", "cold_ns"}) {
    for (const int contacts : {0, 1}) {
      result.goals.push_back(
          shareGoal(table, sizes, kCodeKdl, contacts, contacts, 1.0 / 20.0, column));
      result.goals.push_back(
          shareGoal(table, sizes, kCodeWdlsOnce, contacts, 0, 1.0 / 20.0, column));
      result.goals.push_back(
          shareGoal(table, sizes, kCodeSvd, contacts, contacts, 1.0 / 8.0, column));
    }
    result.goals.push_back(slackGoal(table, sizes, 1, column));
  }
  for (const int contacts : {0, 1}) result.goals.push_back(linearGoal(table, contacts));
  result.tables.push_back(table);
  return result;
}

}  // namespace tactus
