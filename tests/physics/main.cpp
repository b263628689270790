#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <thread>
#include <vector>

#include "physics/grid.h"

/// The controller before the built-in plant and before MuJoCo, side by side.
namespace tactus::physics {
namespace {

/// Work for as many threads as there are jobs; `work` gets every number below count once.
template <typename Work>
void share(int jobs, int count, const Work& work) {
  std::atomic<int> next{0};
  std::vector<std::thread> threads;
  for (int job = 0; job < jobs; ++job)
    threads.emplace_back([&] {
      for (int i = next++; i < count; i = next++) work(i);
    });
  for (std::thread& thread : threads) thread.join();
}

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

std::string peakAndRest(const Trial& trial) {
  return fmt::format("{:.1f} / {:.1f}{}", trial.peak_N, trial.rest_N,
                     trial.fault == Fault::kNone ? "" : " F");
}

std::string speed(const Trial& trial) {
  return fmt::format("{:.0f}", trial.simulated_s / trial.run_time_s);
}

void summarise(const std::vector<Comparison>& all) {
  std::vector<double> errors;
  for (const Comparison& one : all)
    if (!one.isChaotic()) errors.push_back(std::abs(one.error()));
  const auto beyond =
      std::count_if(errors.begin(), errors.end(), [](double e) { return e > 0.25; });
  fmt::print(
      "\nPeak of the built-in plant against MuJoCo: median {:.1f} %, largest {:.0f} %, {} of {} "
      "beyond "
      "25 %; {} chaotic ones left out.\n\n",
      100.0 * median(errors),
      100.0 * (errors.empty() ? 0.0 : *std::max_element(errors.begin(), errors.end())), beyond,
      errors.size(), all.size() - errors.size());
}

void printRow(const Case& one, const Comparison& comparison) {
  fmt::print("| {} | {} | {} | {} | {} | {} | {:+.0f} %{} | {} | {} |\n", nameOf(one),
             peakAndRest(comparison.quasi_static), peakAndRest(comparison.built_in),
             peakAndRest(comparison.built_in_half), peakAndRest(comparison.mujoco),
             comparison.mujoco_half ? peakAndRest(*comparison.mujoco_half) : "-",
             100.0 * comparison.error(), comparison.isChaotic() ? ", chaotic" : "",
             speed(comparison.built_in), speed(comparison.mujoco));
  std::fflush(stdout);
}

/// A row as soon as it is known: a table takes minutes.
void printTable(const char* title, const std::vector<Case>& cases, int jobs) {
  fmt::print("# {}\n\n", title);
  fmt::print(
      "| scene | obstacle | gears | mu | quasi-static | built-in | half step | MuJoCo | half step "
      "| "
      "error of the peak | built-in, times real time | MuJoCo |\n");
  fmt::print("|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  std::vector<Comparison> all(cases.size());
  std::mutex printing;
  share(jobs, static_cast<int>(cases.size()), [&](int i) {
    all[i] = compare(cases[i]);
    const std::lock_guard lock(printing);
    printRow(cases[i], all[i]);
  });
  summarise(all);
}

/// One line a plant and step: how far its peaks are from MuJoCo's with its smallest step.
void printSteps(int jobs) {
  const std::vector<Case> cases = {{"scenario3_tactus", Gears::kRigid, 1e4, 0.0},
                                   {"scenario3_tactus", Gears::kBare, 1e5, 0.0},
                                   {"scenario3_tactus", Gears::kFlexible, 1e6, 0.0}};
  struct Row {
    Plant plant;
    double step_s;
  };
  const std::vector<Row> rows = {
      {Plant::kMujoco, 0.0000625}, {Plant::kMujoco, 0.000125},   {Plant::kMujoco, 0.00025},
      {Plant::kMujoco, 0.0005},    {Plant::kBuiltIn, 0.0000625}, {Plant::kBuiltIn, 0.000125},
      {Plant::kBuiltIn, 0.00025},  {Plant::kBuiltIn, 0.0005},    {Plant::kBuiltIn, 0.001}};
  std::vector<Trial> trials(rows.size() * cases.size());
  share(jobs, static_cast<int>(trials.size()), [&](int i) {
    const Row& row = rows[i / cases.size()];
    trials[i] = tryOut(sceneOf(cases[i % cases.size()]), row.plant, row.step_s);
  });
  fmt::print(
      "# Error against run time\n\n| plant | step, ms | median error of the peak | largest | times "
      "real time |\n|---|---|---|---|---|\n");
  for (std::size_t row = 0; row < rows.size(); ++row) {
    std::vector<double> errors, speeds;
    for (std::size_t i = 0; i < cases.size(); ++i) {
      const Trial& trial = trials[row * cases.size() + i];
      errors.push_back(std::abs(trial.peak_N / trials[i].peak_N - 1.0));
      speeds.push_back(trial.simulated_s / trial.run_time_s);
    }
    fmt::print("| {} | {:.4g} | {:.1f} % | {:.1f} % | {:.0f} |\n",
               rows[row].plant == Plant::kMujoco ? "MuJoCo" : "built-in", 1e3 * rows[row].step_s,
               100.0 * median(errors), 100.0 * *std::max_element(errors.begin(), errors.end()),
               median(speeds));
  }
}

}  // namespace
}  // namespace tactus::physics

int main(int count, char** arguments) {
  using namespace tactus::physics;
  int jobs = 1;
  std::string_view only;
  for (int i = 1; i + 1 < count; i += 2) {
    const std::string_view key = arguments[i];
    if (key == "--jobs") jobs = std::max(1, std::atoi(arguments[i + 1]));
    if (key == "--only") only = arguments[i + 1];
  }
  const auto asks = [&](std::string_view name) { return only.empty() || only == name; };
  if (count % 2 == 0) {
    std::fputs("usage: tactus_physics_tables [--jobs N] [--only scenes|contacts|arm|steps]\n",
               stderr);
    return 2;
  }
  fmt::print(
      "True peak / rest in N. F: the run ended with a fault, mostly of the module's range. "
      "Chaotic: halving its own step changes one of the peaks by more than a tenth.\n\n");
  if (asks("scenes")) printTable("The paper's scenes", paperCases(), jobs);
  if (asks("contacts")) printTable("Static contacts", contactCases(), jobs);
  if (asks("arm")) printTable("Another arm", otherArmCases(), jobs);
  if (asks("steps")) printSteps(jobs);
  return 0;
}
