#include <algorithm>
#include <string>

#include "tactus/bench/body_trial.h"
#include "tactus/bench/parallel.h"
#include "tactus/bench/study.h"

namespace tactus {
namespace {

constexpr const char* kBodyBase = "/scenario2_estimated.yaml";
constexpr std::array kBodySpeeds_m_per_s = {0.1, 0.2, 0.3, 0.4, 0.5};
constexpr std::array kBodyLaws = {Variant::kNone, Variant::kNullLimit};

struct BodyRow {
  std::size_t arm = 0;  ///< of kArms
  BodyTrial trial;
  JudgedRun run;
  double free_N = kNotMeasured;
};

const char* bodyLawName(Variant law) { return law == Variant::kNone ? "none" : "null_limit"; }

std::vector<BodyRow> bodyRows(const ArmBases& bases, bool is_quick) {
  std::vector<BodyRow> rows;
  for (std::size_t arm = 0; arm < bases.size(); ++arm)
    for (const Variant law : kBodyLaws)
      for (const BodyRegion& region : bodyRegions())
        for (const double speed : kBodySpeeds_m_per_s)
          rows.push_back({arm, {law, region, speed}, {}});
  if (is_quick)
    std::erase_if(rows, [](const BodyRow& row) {
      return row.arm > 0 || (row.trial.speed_m_per_s > 0.1 && row.trial.speed_m_per_s < 0.5);
    });
  inParallel(rows.size(), [&](std::size_t i) {
    const RunSetup setup = bodySetup(bases[rows[i].arm], rows[i].trial);
    rows[i].run = judgeRun(setup);
    rows[i].free_N = freeBlow_N(setup, rows[i].trial, rows[i].run);
  });
  return rows;
}

bool isBelow(const BodyRow& row) {
  return row.run.peak_true_force_N <= row.trial.region.max_force_N;
}

Table runTable(const std::vector<BodyRow>& rows) {
  Table table{"body_runs",
              {"arm", "law", "region", "max_force_N", "stiffness_N_per_m", "speed_m_per_s",
               "touch_speed_m_per_s", "peak_force_N", "force_at_rest_N", "free_blow_N"},
              {}};
  for (const BodyRow& row : rows)
    table.rows.push_back({std::string(kArms[row.arm]), std::string(bodyLawName(row.trial.law)),
                          std::string(row.trial.region.name), row.trial.region.max_force_N,
                          row.trial.region.stiffness_N_per_m, row.trial.speed_m_per_s,
                          row.run.touch_speed_m_per_s, row.run.peak_true_force_N,
                          row.run.peak_at_rest_N, row.free_N});
  return table;
}

/// For each arm, law and region: the speed up to which, as far as was looked, all peaks are below.
Table speedTable(const std::vector<BodyRow>& rows) {
  Table table{"body_speeds", {"arm", "law", "region", "areas", "max_force_N", "up_to_m_per_s"}, {}};
  for (auto begin = rows.begin(); begin != rows.end();) {
    const auto is_other = [&](const BodyRow& row) {
      return row.arm != begin->arm || row.trial.law != begin->trial.law ||
             row.trial.region.name != begin->trial.region.name;
    };
    const auto end = std::find_if(begin, rows.end(), is_other);
    const auto above = std::find_if_not(begin, end, isBelow);
    const double up_to = above == begin ? 0.0 : (above - 1)->trial.speed_m_per_s;
    const BodyRegion& region = begin->trial.region;
    table.rows.push_back({std::string(kArms[begin->arm]),
                          std::string(bodyLawName(begin->trial.law)), std::string(region.name),
                          static_cast<double>(region.areas), region.max_force_N, up_to});
    begin = end;
  }
  return table;
}

}  // namespace

StudyResult studyBody(const BenchOptions& options) {
  const ArmBases bases =
      armBases(options.scenes.empty() ? options.scenes_folder + kBodyBase : options.scenes.front());
  const std::vector<BodyRow> rows = bodyRows(bases, options.is_quick);
  StudyResult result;
  result.title = "Regions of the body";
  result.text =
      "A link runs into each region of the body model of ISO/TS 15066 that cannot get away: a "
      "spring with friction of 0.3. Without a law, and null_limit that bears 0.5; the largest true "
      "force, the largest of the last 2 s, and the speed up to which the first stays below the "
      "quasi-static limit of the region. This is no validation of safety: body, arm and sensor are "
      "simulated, and pressure is not looked at.";
  result.tables = {runTable(rows), speedTable(rows)};
  return result;
}

}  // namespace tactus
