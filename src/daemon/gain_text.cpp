#include "tactus/daemon/gain_text.h"

#include <fmt/format.h>

namespace tactus {

const char* gainStateName(GainState state) noexcept {
  switch (state) {
    case GainState::kWaiting:
      return "waiting";
    case GainState::kRamping:
      return "ramping";
    case GainState::kOnTrial:
      return "on_trial";
    case GainState::kGoingBack:
      return "going_back";
    case GainState::kKept:
      break;
  }
  return "kept";
}

std::string gainTroubleText(const GainReport& report) {
  switch (report.trouble) {
    case GainTrouble::kSwings:
      return fmt::format("the force swings by {:.2f} N, and does not settle (limit {:.2f} N)",
                         report.figure, report.limit);
    case GainTrouble::kLosses:
      return fmt::format("contact is lost {:.1f} times a second (limit {:.1f})", report.figure,
                         report.limit);
    case GainTrouble::kAtLimits:
      return fmt::format(
          "a joint moves as fast as it may for {:.0f} % of the time in contact "
          "(limit {:.0f} %)",
          100.0 * report.figure, 100.0 * report.limit);
    case GainTrouble::kFault:
      return "the arm has a fault";
    case GainTrouble::kTimeIsOver:
      return fmt::format("{:g} s are over", report.limit);
    case GainTrouble::kNone:
      break;
  }
  return "";
}

}  // namespace tactus
