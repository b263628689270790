#include "tactus/bench/extremes_study.h"

#include <algorithm>
#include <atomic>
#include <thread>

#include "tactus/bench/study.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

constexpr const char* kExtremesBase = "/base/crops9_contact.yaml";

/// The longest ones first, so that no processor is left with one at the end.
std::vector<ExtremeRow*> workList(std::vector<ExtremeRow>& rows) {
  std::vector<ExtremeRow*> list;
  for (ExtremeRow& row : rows) list.push_back(&row);
  std::ranges::stable_partition(list, [](const ExtremeRow* row) { return row->extreme.is_long; });
  return list;
}

Goal worst(const std::vector<ExtremeRow>& rows, std::string text, long long ExtremeRun::*cycles) {
  long long most = 0;
  for (const ExtremeRow& row : rows) most = std::max(most, row.run.*cycles);
  return {std::move(text), 0.0, static_cast<double>(most)};
}

}  // namespace

std::vector<ExtremeRow> runExtremes(const std::string& base, const std::vector<ExtremeCase>& cases,
                                    const std::vector<ExtremeLaw>& laws, double duration_share) {
  std::vector<ExtremeRow> rows;
  for (const ExtremeCase& extreme : cases)
    for (const ExtremeLaw& law : laws) rows.push_back({extreme, law, {}});
  const std::vector<ExtremeRow*> list = workList(rows);
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < list.size(); i = next++) {
      ExtremeRow& row = *list[i];
      row.run = runExtreme(base, row.extreme, row.law, row.extreme.is_long ? duration_share : 1.0);
    }
  };
  std::vector<std::jthread> workers;
  for (unsigned i = 1; i < std::thread::hardware_concurrency(); ++i) workers.emplace_back(work);
  work();
  workers.clear();
  return rows;
}

Table extremeTable(const std::vector<ExtremeRow>& rows) {
  Table table{"extremes",
              {"group", "case", "law", "outcome", "refused_key", "refused_by_check_key",
               "peak_force_N", "peak_reading_N", "final_reading_N", "restlessness_N",
               "final_speed_per_s", "tcp_error_final_mm", "cycles", "not_finite_cycles",
               "beyond_limits_cycles", "subnormal_cycles"},
              {}};
  for (const ExtremeRow& row : rows) {
    const ExtremeRun& run = row.run;
    table.rows.push_back({row.extreme.group, row.extreme.name, row.law.name, run.outcome,
                          run.refused_at_load, run.refused_by_check, run.peak_force_N,
                          run.peak_reading_N, run.final_reading_N, run.restlessness_N,
                          run.final_speed, 1e3 * run.tcp_error_final_m, double(run.cycles),
                          double(run.not_finite_cycles), double(run.beyond_limits_cycles),
                          double(run.subnormal_cycles)});
  }
  return table;
}

Table extremeSummary(const std::vector<ExtremeRow>& rows) {
  Table table{"extremes_summary",
              {"group", "law", "rows", "at_rest", "follows_noise", "limit_cycle", "drifts", "fault",
               "refused_at_load", "not_bounded", "restless_though_accepted", "peak_force_N"},
              {}};
  for (const ExtremeRow& row : rows) {
    const Filter place = {{"group", row.extreme.group}, {"law", row.law.name}};
    std::size_t line = 0;
    while (line < table.rows.size() && !matches(table, line, place)) ++line;
    if (line == table.rows.size()) {
      table.rows.push_back({row.extreme.group, row.law.name});
      table.rows.back().resize(table.columns.size(), 0.0);
    }
    const auto cell = [&](const char* name) -> double& {
      return std::get<double>(table.rows[line][table.column(name)]);
    };
    const ExtremeRun& run = row.run;
    const bool is_restless = run.outcome == "limit cycle" || run.outcome == "drifts";
    cell("rows") += 1.0;
    cell("at_rest") += run.outcome == "at rest";
    cell("follows_noise") += run.outcome == "follows noise";
    cell("limit_cycle") += run.outcome == "limit cycle";
    cell("drifts") += run.outcome == "drifts";
    cell("fault") += run.isBounded() && run.fault != Fault::kNone;
    cell("refused_at_load") += run.outcome == "refused at load";
    cell("not_bounded") += !run.isBounded();
    cell("restless_though_accepted") += is_restless && run.refused_by_check.empty();
    cell("peak_force_N") = std::max(cell("peak_force_N"), run.peak_force_N);
  }
  return table;
}

Table extremeStates(const std::vector<ExtremeRow>& rows) {
  Table table{"extremes_state",
              {"case", "law", "number", "early_mean", "late_mean", "early_largest", "late_largest"},
              {}};
  for (const ExtremeRow& row : rows) {
    for (const StateNumber& number : row.run.state) {
      if (number.early_largest == 0.0 && number.late_largest == 0.0) continue;
      table.rows.push_back({row.extreme.name, row.law.name, number.name, number.early_mean,
                            number.late_mean, number.early_largest, number.late_largest});
    }
  }
  return table;
}

StudyResult studyStability(const BenchOptions& options) {
  const std::string base =
      options.scenes.empty() ? options.scenes_folder + kExtremesBase : options.scenes.front();
  loadScene(base, {}, SceneUse::kSimulation);  // a broken one is no row of the table
  std::vector<ExtremeCase> cases = extremeCases();
  if (options.is_quick) {
    std::size_t i = 0;
    std::erase_if(cases,
                  [&](const ExtremeCase& extreme) { return !extreme.is_long && i++ % 40 > 0; });
  }
  const std::vector<ExtremeRow> rows =
      runExtremes(base, cases, extremeLaws(), options.is_quick ? 0.01 : 1.0);
  StudyResult result;
  result.title = "Stability at the extremes";
  result.text =
      "Each case with each law, judged in every cycle: command and state are numbers, and the "
      "command is within the limits of velocity, acceleration and place of every joint. At rest: "
      "over the last 2 s the contact's force has a standard deviation of at most 0.05 N, and no "
      "joint moves faster than 0.02 rad/s or m/s. A limit cycle is bounded, but no rest; where "
      "tactus check refuses the gains for this contact, its key is in the table, and the case was "
      "simulated all the same. A fault is named and ends at rest.";
  result.goals = {
      worst(rows, "cycles of a row with NaN or infinity", &ExtremeRun::not_finite_cycles),
      worst(rows, "cycles of a row with a command beyond a limit",
            &ExtremeRun::beyond_limits_cycles),
      worst(rows, "cycles of a row with subnormal numbers", &ExtremeRun::subnormal_cycles)};
  result.tables = {extremeSummary(rows), extremeTable(rows), extremeStates(rows)};
  return result;
}

}  // namespace tactus
