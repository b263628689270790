#include "tactus/control/cover_compensation.h"

#include <algorithm>
#include <numbers>

#include "tactus/math/butterworth_step.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

/// A cut-off above rate / pi is no filter for this cycle; its model would ring.
constexpr double kMaxFilterK = 1.0;

/// tan(x) to 1e-6 where x is a twentieth, without libm, whose results differ between processors.
double filterK(double cutoff_hz, double period_s) noexcept {
  const double x = std::numbers::pi * cutoff_hz * period_s;
  return std::min(kMaxFilterK, x + x * x * x / 3.0);
}

}  // namespace

CoverCompensation::CoverCompensation(const ControllerConfig& config,
                                     const TactileModuleConfig& module)
    : chain_(config.chain),
      geared_links_(config.geared_links),
      link_(module.link),
      cover_(module.cover.value_or(CoverConfig{})),
      feels_moment_x_(module.feels_moment_x),
      gravity_Base_(config.gravity_Base),
      filter_cutoff_hz_(module.filter_cutoff_hz) {
  ChainPose pose;
  chain_.computePose(config.q_start, pose);
  at_tare_ = coverLoad(cover_, framePose(pose, link_).R_AB, gravity_Base_);
}

TactileSample CoverCompensation::relieve(const TactileSample& sample, const JointVector& q,
                                         double period_s,
                                         CoverCompensationState& state) const noexcept {
  const Wrench5 input = load(q, period_s, state) - state.origin;
  Wrench5 felt;
  butterworthStep(input, filterK(filter_cutoff_hz_, period_s), state.s0, state.s1, state.s2, felt);
  for (Wrench5* fading : {&state.s0, &state.s1, &state.s2})
    for (double& x : fading->array()) x = flushed(x);
  felt += state.origin - at_tare_;
  const double moment_x_Nm = feels_moment_x_ ? sample.moment_x_Nm - felt[4] : 0.0;
  return {sample.force_y_N - felt[0],
          sample.force_z_N - felt[1],
          sample.moment_y_Nm - felt[2],
          sample.moment_z_Nm - felt[3],
          sample.sequence,
          moment_x_Nm};
}

/// The first cycle's becomes the origin: the arm has stood there for long, or its motion is not
/// known.
Wrench5 CoverCompensation::load(const JointVector& q, double period_s,
                                CoverCompensationState& state) const noexcept {
  if (!state.has_started) state = {};
  const double step_s = period_s + state.missed_s;
  if (geared_links_) observeLinks(chain_, *geared_links_, q, step_s, state.links);
  ChainPose pose;
  chain_.computePose(geared_links_ ? state.links.q : q, pose);
  const Pose X_BaseModule = framePose(pose, link_);
  const Vector3 p_Base = X_BaseModule.p_AB + X_BaseModule.R_AB * cover_.p_ModuleCenter;
  if (!state.has_started) {
    state.has_started = true;
    state.p_BaseCenter = p_Base;
    state.origin = coverLoad(cover_, X_BaseModule.R_AB, gravity_Base_);
  }
  const Vector3 v_Base = (p_Base - state.p_BaseCenter) / step_s;
  const Vector3 a_Base = (v_Base - state.v_BaseCenter) / step_s;
  state.p_BaseCenter = p_Base;
  state.v_BaseCenter = v_Base;
  state.missed_s = 0.0;
  return coverLoad(cover_, X_BaseModule.R_AB, gravity_Base_ - a_Base);
}

}  // namespace tactus
