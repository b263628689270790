#include "tactus/analysis/predicted_touch.h"

#include <algorithm>
#include <cmath>

#include "tactus/analysis/contact_rates.h"
#include "tactus/analysis/variant_loops.h"
#include "tactus/control/contact_point.h"
#include "tactus/control/contact_transition.h"
#include "tactus/control/control_law.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr double kMostCycles = 1e6;

/// Positions and speeds are along the force on the robot, negative towards the obstacle, which
/// begins at zero. The members follow Controller and SimulatedRobot.
class TouchRun {
 public:
  TouchRun(const PredictedTouch& touch, double lead_s)
      : touch_(touch),
        loop_(touch.loop),
        force_(touch.gains.force),
        rates_(contactRates(loop_)),
        filter_(loop_.filter_cutoff_hz,
                loop_.filters_at_samples ? 1.0 / loop_.sample_period_s : loop_.filter_rate_hz),
        model_filter_(modelCutoff_hz(loop_), 1.0 / loop_.period_s),
        drive_share_(lagShare(rates_.step_s, loop_.drive_lag_s)),
        model_share_(lagShare(loop_.period_s, loop_.model_drive_lag_s)),
        commanded_m_(touch.speed_m_per_s * (lead_s - loop_.drive_lag_s)),
        position_m_(touch.speed_m_per_s * lead_s),
        origin_m_(commanded_m_) {}

  void step(long n) {
    if (n % rates_.cycle == 0) control();
    commanded_m_ += rates_.step_s * speed_m_per_s_;
    position_m_ += drive_share_ * (commanded_m_ - position_m_);
    if (n % rates_.filter == 0) sense(n % rates_.sample == 0);
  }

  double sample_N() const { return sample_N_; }

 private:
  double P() const {
    const double gain = loop_.order == 2 ? 2.0 * force_.damping : 1.0;
    return gain / (force_.time_constant_s * touch_.law_stiffness_N_per_m);
  }

  bool hasSecondSpace() const { return isOfTwoSpaces(touch_.variant); }

  bool isLimited() const { return touch_.variant == Variant::kNullLimit; }

  void control() {
    F_p_N_ = std::max(0.0, sample_N_ - force_.contact_threshold_N);
    const double decay = passTouch();
    double signed_N = F_p_N_;
    if (isLimited() && transition_.touched) {
      signed_N = signedContactForce_N(force_, sample_N_);
      if (signed_N < 0.0) signed_N *= transition_.gamma;
    }
    V_m_per_s_ *= signed_N < 0.0 ? decay + transition_.gamma * (1.0 - decay) : decay;
    const double x_eff =
        sign_ * (-touch_.speed_m_per_s - touch_.gains.task.drift_gain_per_s * tool_m_);
    const double answer = P() * signed_N + V_m_per_s_;
    double second = 0.0;
    if (hasSecondSpace())
      second = std::max(0.0, P() * (F_p_N_ - force_.activation_force_N) + It_m_per_s_);
    speed_m_per_s_ = x_eff - transition_.gamma * std::min(x_eff, 0.0) + answer + second;
    speed_m_per_s_ *= sign_;
    limitApproach();
    integrate(signed_N);
    moveTool(sign_ * second);
  }

  /// The factor by which V fades.
  double passTouch() {
    const Vector3 p_Contact = commanded_m_ * Vector3::UnitX();
    return passTransition(force_.transition, F_p_N_, p_Contact, loop_.period_s, transition_);
  }

  void integrate(double signed_N) {
    if (loop_.order == 1) return;
    const double rate = loop_.period_s / (force_.time_constant_s * force_.time_constant_s *
                                          touch_.law_stiffness_N_per_m);
    if (!is_limiting_) V_m_per_s_ = std::max(0.0, V_m_per_s_ + rate * signed_N);
    if (hasSecondSpace())
      It_m_per_s_ = std::max(0.0, It_m_per_s_ + rate * (F_p_N_ - force_.activation_force_N));
  }

  void moveTool(double second) {
    const double pull = -touch_.gains.task.drift_gain_per_s * tool_m_;
    if (hasSecondSpace()) tool_m_ += loop_.period_s * (second + pull);
    if (touch_.variant == Variant::kTaskSpace)
      tool_m_ += loop_.period_s * (speed_m_per_s_ + touch_.speed_m_per_s);
  }

  /// What the limit's model of drives and filter makes of the command, and the speed that it
  /// leaves.
  void limitApproach() {
    if (!isLimited()) return;
    lagged_m_ += model_share_ * (commanded_m_ - origin_m_ - lagged_m_);
    const double filtered_m = model_filter_.update(lagged_m_);
    if (is_sample_new_) sensed_m_ = filtered_m;
    is_sample_new_ = false;
    if (F_p_N_ > 0.0) {
      memory_N_per_m_ =
          std::max(touch_.law_stiffness_N_per_m, force_.min_approach_stiffness_N_per_m);
    } else {
      memory_N_per_m_ -= lagShare(loop_.period_s, force_.time_constant_s) * memory_N_per_m_;
    }
    is_limiting_ = false;
    if (memory_N_per_m_ < 1e-3) return;
    const double ahead_m = sensed_m_ - (commanded_m_ - origin_m_);
    const double ahead_N = std::max(0.0, F_p_N_ + memory_N_per_m_ * ahead_m);
    const double least =
        -(force_.activation_force_N - ahead_N) / (force_.time_constant_s * memory_N_per_m_);
    is_limiting_ = speed_m_per_s_ < least;
    speed_m_per_s_ = std::max(speed_m_per_s_, least);
  }

  void sense(bool is_sample) {
    if (loop_.filters_at_samples && !is_sample) return;
    const double filtered_N =
        filter_.update(std::max(0.0, -touch_.stiffness_N_per_m * position_m_));
    if (!is_sample) return;
    sample_N_ = std::abs(filtered_N);
    if (sample_N_ > kMinForceForDirection_N) sign_ = std::copysign(1.0, filtered_N);
    is_sample_new_ = true;
  }

  const PredictedTouch& touch_;
  const ContactLoop& loop_;
  const ForceGains& force_;
  ContactRates rates_;
  ButterworthLowPass filter_, model_filter_;
  double drive_share_, model_share_;
  double commanded_m_, position_m_;
  double origin_m_;    ///< of the model
  double sign_ = 1.0;  ///< of the sample: the filter rings where a force is gone
  double speed_m_per_s_ = 0.0, sample_N_ = 0.0, F_p_N_ = 0.0;
  double V_m_per_s_ = 0.0, It_m_per_s_ = 0.0, tool_m_ = 0.0;
  ContactTransitionState transition_;
  double lagged_m_ = 0.0, sensed_m_ = 0.0, memory_N_per_m_ = 0.0;
  bool is_sample_new_ = false, is_limiting_ = false;
};

/// Of the law that holds the least: the approach limit's has the model, too.
ContactLoop loopOfVariant(const std::vector<VariantLoop>& loops, int order) {
  ContactLoop loop = loops.back().loop;
  loop.order = order;
  return loop;
}

}  // namespace

std::optional<PredictedTouch> predictedTouch(const ControllerConfig& config,
                                             const PlantConfig& plant, double period_s, int module,
                                             const Gains& gains) {
  const std::optional<ForceControlConfig>& law = config.force_control;
  if (!law || law->level == ControlLevel::kAcceleration || law->variant == Variant::kJointSpace)
    return std::nullopt;
  ControllerConfig under = config;
  under.gains = gains;
  const std::vector<VariantLoop> loops = variantLoops(under, plant, period_s, module);
  if (loops.empty() || stepsOfCommonPeriod(loops.front().loop) == 0) return std::nullopt;
  const ContactLoop loop = loopOfVariant(loops, law->order);
  return PredictedTouch{.loop = loop,
                        .variant = law->variant,
                        .gains = gains,
                        .law_stiffness_N_per_m = gains.force.assumed_stiffness_N_per_m};
}

std::vector<PredictedForce> predictForce(const PredictedTouch& touch, double duration_s) {
  const ContactRates rates = contactRates(touch.loop);
  const auto common = static_cast<double>(stepsOfCommonPeriod(touch.loop)) * rates.step_s;
  // Long enough for drives and model to follow a constant speed, and half a sample behind it.
  const double settled_s = 20.0 * std::max(touch.loop.drive_lag_s, touch.loop.model_drive_lag_s) +
                           2.0 / touch.loop.model_filter_cutoff_hz;
  const double lead_s = common * std::ceil(settled_s / common) + 0.5 * touch.loop.sample_period_s;
  TouchRun run(touch, lead_s);
  const double cycles = std::min(kMostCycles, (lead_s + duration_s) / touch.loop.period_s);
  std::vector<PredictedForce> forces;
  for (long n = 0; n < std::lround(cycles) * rates.cycle; ++n) {
    const double t_s = static_cast<double>(n) * rates.step_s - lead_s;
    if (n % rates.cycle == 0 && t_s >= 0.0) forces.push_back({t_s, run.sample_N()});
    run.step(n);
  }
  return forces;
}

}  // namespace tactus
