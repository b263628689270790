#include "tactus/bench/pseudoinverse_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "tactus/bench/pseudoinverse_methods.h"
#include "tactus/bench/study.h"
#include "tactus/bench/timing.h"

namespace tactus {
namespace {

double ratioOf(int decade) { return std::pow(10.0, -decade); }

struct Setting {
  int task_size;
  double ratio;
  int batches;
  std::vector<MotionProblem<double>> problems;
  std::vector<MotionParts<long double>> references;
};

Setting makeSetting(const PseudoinverseSizes& sizes, int task_size, int decade) {
  Setting setting;
  setting.task_size = task_size;
  setting.ratio = ratioOf(decade);
  setting.batches = sizes.batches;
  setting.problems = randomProblems(sizes.problems, task_size, sizes.joints, setting.ratio);
  for (const MotionProblem<double>& problem : setting.problems)
    setting.references.push_back(referenceSolution(problem));
  return setting;
}

struct Errors {
  std::vector<double> task, null;
};

template <typename Scalar>
Errors errorsOf(const std::vector<MotionParts<Scalar>>& parts, const Setting& setting) {
  Errors errors;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const MotionParts<long double>& exact = setting.references[i];
    const auto task = (parts[i].task.template cast<long double>() - exact.task).norm();
    const auto null = (parts[i].null.template cast<long double>() - exact.null).norm();
    errors.task.push_back(static_cast<double>(task / exact.task.norm()));
    errors.null.push_back(static_cast<double>(null));
  }
  std::ranges::sort(errors.task);
  std::ranges::sort(errors.null);
  return errors;
}

/// Time and error of the same calls.
template <typename Scalar>
void measure(const std::vector<PseudoinverseMethod<Scalar>>& methods, const char* scalar,
             const Setting& setting, Table& table) {
  std::vector<MotionProblem<Scalar>> problems;
  for (const MotionProblem<double>& problem : setting.problems)
    problems.push_back(problem.cast<Scalar>());
  for (const PseudoinverseMethod<Scalar>& method : methods) {
    std::vector<MotionParts<Scalar>> parts(problems.size());
    const auto solveAll = [&] {
      for (std::size_t i = 0; i < problems.size(); ++i) method.solve(problems[i], parts[i]);
    };
    const TimeStatistics time = timeWarm(
        setting.batches, static_cast<int>(problems.size()), [] {}, solveAll);
    const Errors errors = errorsOf(parts, setting);
    table.rows.push_back({method.name, std::string(scalar), double(setting.task_size),
                          setting.ratio, errors.task[errors.task.size() / 2], errors.task.back(),
                          errors.null.back(), time.fastest, time.median});
  }
}

}  // namespace

Table measurePseudoinverses(const PseudoinverseSizes& sizes) {
  Table table{"pseudoinverse",
              {"method", "scalar", "task_components", "singular_value_ratio", "error_median",
               "error_max", "null_space_error_max", "time_ns", "time_median_ns"},
              {}};
  for (const int task_size : sizes.task_sizes) {
    for (int decade = 0; decade <= sizes.decades; ++decade) {
      const Setting setting = makeSetting(sizes, task_size, decade);
      measure(ourMethods(), "double", setting, table);
      measure(textbookMethods<double>(), "double", setting, table);
      measure(textbookMethods<float>(), "float", setting, table);
    }
  }
  return table;
}

namespace {

/// A series for each method and scalar.
Plot makePlot(const Table& table, int task_size, const char* x_column) {
  Plot plot;
  plot.table = table.name;
  plot.x_column = x_column;
  plot.y_column = "error_max";
  for (const char* scalar : {"double", "float"}) {
    for (const PseudoinverseMethod<double>& method : textbookMethods<double>())
      plot.series.push_back({fmt::format("{}, {}", method.name, scalar),
                             {{"method", method.name},
                              {"scalar", std::string(scalar)},
                              {"task_components", double(task_size)}}});
  }
  for (const PseudoinverseMethod<double>& method : ourMethods())
    plot.series.insert(plot.series.begin(),
                       {method.name + ", double",
                        {{"method", method.name}, {"task_components", double(task_size)}}});
  plot.y_label = "largest relative error of J# w";
  return plot;
}

Goal errorGoal(const Table& table, int task_size) {
  const Filter filter = {{"method", std::string("ours")},
                         {"task_components", double(task_size)},
                         {"singular_value_ratio", ratioOf(6)}};
  return {fmt::format("pseudoinverse, {} components, ratio 1e-6: largest error", task_size), 1e-10,
          std::max(findNumber(table, "error_max", filter),
                   findNumber(table, "null_space_error_max", filter))};
}

Goal timeGoal(const Table& table, int task_size) {
  const auto time_ns = [&](const char* method) {
    return findNumber(table, "time_ns",
                      {{"method", std::string(method)},
                       {"scalar", std::string("double")},
                       {"task_components", double(task_size)},
                       {"singular_value_ratio", ratioOf(6)}});
  };
  return {fmt::format("pseudoinverse, {} components, ratio 1e-6: time, times normal equations",
                      task_size),
          2.0, time_ns("ours") / time_ns("normal equations")};
}

}  // namespace

StudyResult studyPseudoinverse(const BenchOptions& options) {
  PseudoinverseSizes sizes;
  if (options.is_quick) {
    sizes.problems = 8;
    sizes.batches = 3;
  }
  StudyResult result;
  result.title = "Pseudoinverse";
  result.text =
      "From a Jacobian with nine joints to J# w and N v. Random directions; singular values from 1 "
      "down to the ratio; all in storage of fixed capacity. The reference is a singular value "
      "decomposition in long double. Ours is exact where no singular value is below 0.02; for the "
      "row \"ours\" the matrices are scaled above it, by a power of two, and in \"ours, damped\" "
      "they are not. Damped variants differ near singularities because they should.";
  const Table table = measurePseudoinverses(sizes);
  for (const int task_size : sizes.task_sizes) {
    Plot over_ratio = makePlot(table, task_size, "singular_value_ratio");
    over_ratio.title =
        fmt::format("Error over the ratio of singular values, {} components.", task_size);
    over_ratio.x_label = "smallest singular value over the largest";
    Plot precision = makePlot(table, task_size, "time_ns");
    precision.title = fmt::format("Error against time, {} components.", task_size);
    precision.note = "A point for each ratio of singular values, 1 to 1e-12 from below.";
    precision.x_label = "time in ns";
    precision.has_lines = false;
    result.plots.push_back(std::move(over_ratio));
    result.plots.push_back(std::move(precision));
    result.goals.push_back(errorGoal(table, task_size));
    result.goals.push_back(timeGoal(table, task_size));
  }
  result.tables.push_back(table);
  return result;
}

}  // namespace tactus
