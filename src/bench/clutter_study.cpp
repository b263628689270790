#include <algorithm>
#include <string>

#include "tactus/bench/base_scene.h"
#include "tactus/bench/clutter_grid.h"
#include "tactus/bench/parallel.h"
#include "tactus/bench/study.h"

namespace tactus {
namespace {

constexpr const char* kClutterBase = "/whole_arm/planar3_clutter.yaml";
constexpr std::uint64_t kClutterSeed = 20'261'126;
constexpr int kClutterDraws = 12;

std::vector<Cell> clutterRow(ClutterKind kind, int posts, ClutterLaw law,
                             const std::vector<ClutterRun>& runs) {
  double reached = 0, touching = 0, contact_s = 0, high_s = 0, largest_N = 0, low = 0, restless = 0,
         rest_N = 0, felt_N = 0, faults = 0;
  for (const ClutterRun& run : runs) {
    faults += run.fault != Fault::kNone;
    reached += run.isReached();
    touching += run.contact_s > 0.0;
    low += run.isReached() && run.high_s == 0.0;
    contact_s += run.contact_s;
    high_s += run.high_s;
    largest_N = std::max(largest_N, run.largest_N);
    restless += !(run.restlessness_N <= JudgedRun::kMaxRestlessness_N);
    rest_N = std::max(rest_N, run.largest_at_rest_N);
    felt_N = std::max(felt_N, run.largest_felt_at_rest_N);
  }
  const double high_share = contact_s > 0.0 ? high_s / contact_s : 0.0;
  return {std::string(clutterKindName(kind)),
          static_cast<double>(posts),
          std::string(clutterLawName(law)),
          static_cast<double>(runs.size()),
          touching,
          reached,
          low,
          high_share,
          largest_N,
          rest_N,
          felt_N,
          restless,
          faults};
}

Table emptyClutterTable() {
  return {"clutter",
          {"kind", "posts", "law", "runs", "with_contact", "reached", "reached_with_low_forces",
           "high_share_of_contact_time", "largest_force_N", "largest_force_at_rest_N",
           "largest_felt_at_rest_N", "restless", "faults"},
          {}};
}

/// Of null_limit, among posts that give way: what stands may hold a link from both sides.
double largestHighShare(const Table& table) {
  double largest = 0.0;
  for (std::size_t row = 0; row < table.rows.size(); ++row)
    if (table.word(row, "law") == clutterLawName(ClutterLaw::kNullLimit) &&
        table.word(row, "kind") != clutterKindName(ClutterKind::kHard))
      largest = std::max(largest, table.number(row, "high_share_of_contact_time"));
  return largest;
}

}  // namespace

StudyResult studyClutter(const BenchOptions& options) {
  const std::string path =
      options.scenes.empty() ? options.scenes_folder + kClutterBase : options.scenes.front();
  const RunSetup base = setupOf(loadBase(path, {}));
  StudyResult result;
  result.title = "Reaching in clutter";
  result.text =
      "A planar arm reaches for goals among posts that were drawn: soft ones of 100 N/m, ones of "
      "1000 N/m that slide away at 2 N, and ones of 1000 N/m that stand. Reached: the tool ends "
      "within 2 cm of its goal; a force is high above 1.05 of 5 N. Forces are those of single "
      "posts. Where it comes from, and what others measured, is in docs/gate.md.";
  Table table = emptyClutterTable();
  for (int k = 0; k < kClutterKinds; ++k)
    for (const int posts : {20, 40, 80, 120}) {
      const auto kind = static_cast<ClutterKind>(k);
      const std::vector<RunSetup> setups = drawClutter(base, kind, posts, kClutterSeed + posts,
                                                       options.is_quick ? 3 : kClutterDraws);
      for (int l = 0; l < kClutterLaws; ++l) {
        const auto law = static_cast<ClutterLaw>(l);
        std::vector<ClutterRun> runs(setups.size());
        inParallel(setups.size(), [&](std::size_t i) {
          RunSetup setup = setups[i];
          useLaw(law, setup);
          runs[i] = runClutter(setup);
        });
        table.rows.push_back(clutterRow(kind, posts, law, runs));
      }
    }
  result.goals = {
      {"reaching in clutter that gives way: largest share of contact time with a high force", 0.01,
       largestHighShare(table)}};
  result.tables = {std::move(table)};
  return result;
}

}  // namespace tactus
