#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tactus/rt/refusal.h"

namespace tactus {

/// How much a finding means for hard real time.
enum class Level {
  kOk,
  kNote,     ///< nothing to mend, but to know
  kWarning,  ///< may cost a cycle now and then
  kNotFit    ///< the robot must not run like this
};

/// Something that was looked at, for a person to judge and mend.
struct Finding {
  std::string name;  ///< what was looked at, for scripts: "cpu_governor"
  Level level = Level::kOk;
  std::string what;
  std::string why_it_matters{};  ///< empty if there is nothing to mend, as is the next
  std::string how_to_mend{};
};

/// "ok", "note", "warning", "not_fit".
std::string_view levelName(Level level) noexcept;

/// Whether nothing was found that must not be.
bool isFit(const std::vector<Finding>& findings) noexcept;

/// What the real-time layer could not get is what the daemon refuses to run without.
Finding findingOf(const std::string& name, const Refusal& refusal);

}  // namespace tactus
