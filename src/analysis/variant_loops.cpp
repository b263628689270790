#include "tactus/analysis/variant_loops.h"

#include "tactus/analysis/cover_geometry.h"

namespace tactus {
namespace {

ContactLoop loopOf(const ControllerConfig& config, const PlantConfig& plant, double period_s,
                   int index) {
  const ForceGains& force = config.gains.force;
  const SimulatedModuleConfig& module = plant.modules[index];
  const bool is_acceleration = config.force_control->level == ControlLevel::kAcceleration;
  return {.is_acceleration = is_acceleration,
          .order = config.force_control->order,
          .time_constant_s = force.time_constant_s,
          .damping = force.damping,
          .period_s = period_s,
          .drive_lag_s = plant.drive_lag_s,
          .filter_cutoff_hz = module.filter_cutoff_hz,
          .filter_rate_hz = module.filter_rate_hz,
          .sample_period_s = module.channels.sample_period_s,
          .filters_at_samples = module.filter_place == FilterPlace::kReader,
          .answer_lag_s = is_acceleration ? 1.0 / force.velocity_gain_per_s : 0.0};
}

Vector3 acrossLink(const ControllerConfig& config, int module) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  const CoverEnds cover = coverEnds(pose, config.tactile_modules[module]);
  const Vector3 across = (cover.p_BaseEnd - cover.p_BaseStart).cross(Vector3::UnitZ());
  return across.norm() > 1e-6 ? across.normalized() : Vector3::UnitX();
}

}  // namespace

std::vector<VariantLoop> variantLoops(const ControllerConfig& config, const PlantConfig& plant,
                                      double period_s, int module) {
  if (!config.force_control) return {};
  const ContactLoop one = loopOf(config, plant, period_s, module);
  ContactLoop both = one;
  both.law = LoopLaw::kTwoSpaces;
  const auto pulled = [&](ContactLoop loop) {
    loop.drift_gain_per_s = config.gains.task.drift_gain_per_s;
    return loop;
  };
  using enum AnswerSpace;
  switch (config.force_control->variant) {
    case Variant::kNone:
      return {};
    case Variant::kNullSpace:
      return {{"one space", one, kNull}};
    case Variant::kJointSpace:
      return {{"one space", one, kJoint}};
    case Variant::kTaskSpace:
      return {{"one space", one, kTask}, {"one space, with beta", pulled(one), {}}};
    case Variant::kNullTask:
    case Variant::kNullJoint:
      return {{"both spaces", both, {}},
              {"both spaces, with beta", pulled(both), {}},
              {"one space", one, kNull}};
    case Variant::kNullLimit: {
      ContactLoop limit = one;
      limit.law = LoopLaw::kApproachLimit;
      limit.order = 1;
      limit.model_drive_lag_s = config.drive_lag_s;
      limit.model_filter_cutoff_hz = config.tactile_modules[module].filter_cutoff_hz;
      // Several contacts have that form in both levels.
      if (hasContactRows(config)) return {{"approach limit", limit, kNull}};
      return {{"one space", one, kNull}, {"approach limit", limit, kNull}};
    }
  }
  return {};
}

void addGears(const ControllerConfig& config, const ArmDynamicsConfig& arm, double law_N_per_m,
              std::vector<VariantLoop>& loops, int module) {
  const Vector3 n_Base = acrossLink(config, module);
  for (VariantLoop& loop : loops) {
    if (!loop.space) continue;
    GearedContact contact = gearedContact(config, arm, config.q_start, n_Base, *loop.space, module);
    if (contact.way.isZero(0.0)) continue;
    contact.law_N_per_m = law_N_per_m;
    loop.loop.geared = contact;
  }
}

}  // namespace tactus
