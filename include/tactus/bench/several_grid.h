#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tactus/bench/several_run.h"
#include "tactus/bench/surroundings.h"
#include "tactus/bench/table.h"

namespace tactus {

/// How the posts of a case stand to each other.
enum class SeveralKind {
  kAtOnce,     ///< before two links at the same moment of their paths
  kSequence,   ///< one later than the other
  kOpposite,   ///< the second behind its link, where the arm gives way to
  kSqueezed,   ///< behind another link, with little room
  kVanishing,  ///< the first is gone a while after the second has come
  kMoving,     ///< the second comes and goes slowly
  // Both before one module, see same_module.h:
  kSameSide,   ///< of it
  kAcross,     ///< the second lies across, so that forces differ by 90 degrees
  kBothSides,  ///< the second is behind the link
};
inline constexpr int kSeveralKinds = 9;
inline constexpr int kDrawnKinds = 6;  ///< by drawSeveral(), in turn
const char* severalKindName(SeveralKind kind);

struct SeveralCase {
  SeveralKind kind;
  Surroundings surroundings = Surroundings::kOpen;
  int modules = 0;  ///< that have a post of their own
  RunSetup setup;
};

/// Environments for a robot with several modules: starts and paths as drawEnvironments(), two or
/// three posts of 100 to 1e6 N/m before their links, each kind in each surroundings in turn. Draws
/// whose links do not come to their posts, or that do not start clear, are left out.
std::vector<SeveralCase> drawSeveral(const RunSetup& base, std::uint64_t seed, int count);

/// Without limits of acceleration and force, which would judge instead of the law.
RunSetup withoutLimits(RunSetup base);

/// A row of the table for each kind and each surroundings that there is, over the runs that say
/// something, and one of all. Those of surroundings are without posts that move.
Table emptySeveralTable(const std::string& name);
void addSeveralRows(const std::string& trial, const std::vector<SeveralCase>& cases,
                    const std::vector<SeveralRun>& runs, Table& table);

}  // namespace tactus
