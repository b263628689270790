#include "campaign/rest_meter.h"

#include <fmt/format.h>

#include <algorithm>

namespace tactus::campaign {
namespace {

constexpr double kStandstill = 1e-3;  ///< m/s or rad/s
/// In which a fault has closed the brakes and switched drives off or cut them off: the deadline,
/// and the heartbeat that a drive then misses.
constexpr int kOff_ms = 800;

bool mayRun(Mode mode) { return mode == Mode::kRunning || mode == Mode::kEnabling; }

}  // namespace

void RestMeter::look(const Look& look) {
  const Observation& now = look.now;
  has_let_go_ = has_let_go_ || now.powers_taken > look.before.powers_taken;
  if (now.t_ms > plan_.clear_ms) return;
  mode_ = now.mode;
  fault_ = now.fault;
  fault_ms_ = now.mode == Mode::kFault ? fault_ms_ + now.t_ms - look.before.t_ms : 0;
  if (mayRun(now.mode)) stop_ms_ = -1;
  if (!mayRun(now.mode) && stop_ms_ < 0) stop_ms_ = now.t_ms;
  const double speed = now.velocity.cwiseAbs().maxCoeff();
  if (stop_ms_ >= 0 && speed > kStandstill) rest_ms_ = std::max(rest_ms_, now.t_ms - stop_ms_);
  // Who comes by chance may come in the middle of a stop.
  if (now.t_ms == plan_.clear_ms && plan_.comes_late) judgeRest(look);
}

void RestMeter::judgeRest(const Look& look) const {
  const Observation& now = look.now;
  if (mayRun(now.mode)) return;
  const double speed = now.velocity.cwiseAbs().maxCoeff();
  // One that has let go rolls on into its brake, which the plant lacks.
  if (speed > kStandstill && !has_let_go_)
    look.complain("rest", fmt::format("no rest in {}", modeName(now.mode)),
                  fmt::format("{:.3g}", speed));
  if (fault_ms_ < kOff_ms) return;
  if (now.is_brake_open) look.complain("rest", "a brake is open in fault at rest");
  if (now.has_torque) look.complain("rest", "a drive has torque in fault at rest");
}

}  // namespace tactus::campaign
