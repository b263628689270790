#include "tactus/doctor/finding.h"

#include <algorithm>

namespace tactus {

std::string_view levelName(Level level) noexcept {
  switch (level) {
    case Level::kOk:
      return "ok";
    case Level::kNote:
      return "note";
    case Level::kWarning:
      return "warning";
    case Level::kNotFit:
      break;
  }
  return "not_fit";
}

bool isFit(const std::vector<Finding>& findings) noexcept {
  return std::ranges::none_of(findings, [](const Finding& f) { return f.level == Level::kNotFit; });
}

Finding findingOf(const std::string& name, const Refusal& refusal) {
  return {name, Level::kNotFit, refusal.what, refusal.why_it_matters, refusal.how_to_grant};
}

}  // namespace tactus
