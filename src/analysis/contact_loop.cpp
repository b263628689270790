#include "tactus/analysis/contact_loop.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tactus/analysis/contact_rates.h"
#include "tactus/math/filter.h"

namespace tactus {
namespace {

using Eigen::Index;

using Number = std::complex<double>;

constexpr int kMaxSteps = 10000;
constexpr Index kLoopSize = 13;  ///< numbers of state but the arm's

/// A number of the loop as a linear form of the state at the start of the common period.
using Form = LoopState;

/// The loop at work. The sequence of the members is that of the state.
class LiftedLoop {
 public:
  LiftedLoop(const ContactLoop& loop, double stiffness_ratio, double phase_lag_rad)
      : loop_(loop),
        rates_(contactRates(loop)),
        filter_(loop.filter_cutoff_hz,
                loop.filters_at_samples ? 1.0 / loop.sample_period_s : loop.filter_rate_hz),
        model_filter_(modelCutoff_hz(loop), 1.0 / loop.period_s),
        drive_share_(lagShare(rates_.step_s, loop.drive_lag_s)),
        model_share_(lagShare(loop.period_s, loop.model_drive_lag_s)),
        stiffness_ratio_(stiffness_ratio),
        turn_(std::polar(1.0, -phase_lag_rad)),
        is_sample_new_(rates_.sample <= rates_.cycle) {
    if (loop.geared)
      arm_step_ = gearedStep(*loop.geared, stiffness_ratio, rates_.step_s).cast<Number>();
    const Index arm_size = std::max<Index>(0, arm_step_.rows() - 2);  // the command is apart
    const Index size = kLoopSize + arm_size;
    arm_ = LoopMatrix::Identity(size, size).bottomRows(arm_size);
    velocity_ = Form::Zero(size);
    Index i = 0;
    for (Form* form :
         {&commanded_, &position_, &delays_[0], &delays_[1], &delays_[2], &sample_, &integral_,
          &tool_, &lagged_, &model_delays_[0], &model_delays_[1], &model_delays_[2], &sensed_})
      *form = Form::Unit(size, i++);
    // What is not there, or there twice, must not appear as an eigenvalue 1.
    if (loop.order == 1 && !loop.is_acceleration) integral_.setZero();
    if (!isToolApart()) tool_.setZero();
    if (loop.geared) followLinks();
    if (loop.law == LoopLaw::kApproachLimit) return;
    for (Form* form : {&lagged_, &model_delays_[0], &model_delays_[1], &model_delays_[2], &sensed_})
      form->setZero();
  }

  void step(long n) {
    if (n % rates_.cycle == 0) control();
    move();
    if (n % rates_.filter == 0) sense(n % rates_.sample == 0);
  }

  LoopMatrix state() const {
    LoopMatrix matrix(velocity_.size(), velocity_.size());
    matrix << commanded_, position_, delays_[0], delays_[1], delays_[2], sample_, integral_, tool_,
        lagged_, model_delays_[0], model_delays_[1], model_delays_[2], sensed_, arm_;
    return matrix;
  }

 private:
  void control() {
    if (loop_.is_acceleration) return accelerate();
    const double T_s = loop_.time_constant_s;
    const double P_per_s = (loop_.order == 2 ? 2.0 * loop_.damping : 1.0) / T_s;
    const bool predicts = loop_.law == LoopLaw::kApproachLimit;
    if (predicts) followModel();
    const Form seen = predicts ? Form(sample_ + sensed_ - commanded_) : sample_;
    const Form answer = P_per_s * seen + integral_;
    const Form pull = -loop_.drift_gain_per_s * (isToolApart() ? tool_ : commanded_);
    velocity_ = (loop_.law == LoopLaw::kTwoSpaces ? 2.0 : 1.0) * answer + pull;
    if (loop_.order == 2) integral_ += loop_.period_s / (T_s * T_s) * sample_;
    if (isToolApart()) tool_ += loop_.period_s * (answer + pull);
  }

  /// integral_ and tool_ are the speeds that null space and tool give the contact; where the tool
  /// is not apart, integral_ is that of each space, or of the contact.
  void accelerate() {
    const double T_s = loop_.time_constant_s;
    if (loop_.law == LoopLaw::kApproachLimit) {
      followModel();
      const Form least = (sample_ + sensed_ - commanded_) / T_s;
      integral_ += lagShare(loop_.period_s, loop_.answer_lag_s) * (least - integral_);
      velocity_ = integral_;
      return;
    }
    const double spaces = loop_.law == LoopLaw::kTwoSpaces && !isToolApart() ? 2.0 : 1.0;
    velocity_ = spaces * integral_ + tool_;
    const Form push = loop_.period_s / (T_s * T_s) * sample_ -
                      lagShare(loop_.period_s, 0.5 * T_s / loop_.damping) * velocity_;
    integral_ += push;
    if (isToolApart()) tool_ += push - loop_.period_s * loop_.drift_gain_per_s * tool_;
    velocity_ = spaces * integral_ + tool_;
  }

  void followModel() {
    lagged_ += model_share_ * (commanded_ - lagged_);
    const Form filtered = filter(model_filter_, lagged_, model_delays_);
    if (is_sample_new_) sensed_ = filtered;
    is_sample_new_ = false;
  }

  /// In one space the tool leaves its path by as much as the contact moves.
  bool isToolApart() const {
    return loop_.law == LoopLaw::kTwoSpaces && loop_.drift_gain_per_s != 0.0;
  }

  void move() {
    if (loop_.geared) {
      const Index n = arm_.rows();
      arm_ = arm_step_.topLeftCorner(n, n) * arm_ + arm_step_.block(0, n, n, 1) * commanded_ +
             arm_step_.block(0, n + 1, n, 1) * velocity_;
      commanded_ += rates_.step_s * velocity_;
      followLinks();
      return;
    }
    commanded_ += rates_.step_s * velocity_;
    position_ += drive_share_ * (commanded_ - position_);
  }

  void followLinks() {
    const JointVector& a = loop_.geared->a;
    position_ = a.transpose() * arm_.topRows(a.size());
  }

  void sense(bool is_sample) {
    if (loop_.filters_at_samples && !is_sample) return;
    const Form filtered = filter(filter_, -stiffness_ratio_ * position_, delays_);
    if (!is_sample) return;
    sample_ = turn_ * filtered;
    is_sample_new_ = true;
  }

  static Form filter(const ButterworthLowPass& filter, const Form& input,
                     std::array<Form, 3>& delays) {
    const std::array<double, 4>& b = filter.numerator();
    const std::array<double, 4>& a = filter.denominator();
    const Form output = b[0] * input + delays[0];
    delays[0] = b[1] * input - a[1] * output + delays[1];
    delays[1] = b[2] * input - a[2] * output + delays[2];
    delays[2] = b[3] * input - a[3] * output;
    return output;
  }

  const ContactLoop& loop_;
  ContactRates rates_;
  ButterworthLowPass filter_, model_filter_;
  double drive_share_, model_share_;
  double stiffness_ratio_;
  std::complex<double> turn_;
  bool is_sample_new_;  ///< since the last cycle
  Form commanded_, position_;
  std::array<Form, 3> delays_;  ///< of the filter
  Form sample_, integral_, tool_;
  // Of the model:
  Form lagged_;
  std::array<Form, 3> model_delays_;
  Form sensed_;
  Form velocity_;  ///< no state: a common period starts with a cycle
  LoopMatrix arm_step_;
  LoopMatrix arm_;  ///< of links and motors, a form a row; in place of position_
};

}  // namespace

double modelCutoff_hz(const ContactLoop& loop) {
  const double K = std::numbers::pi * loop.model_filter_cutoff_hz * loop.period_s;
  return std::atan(std::min(1.0, K)) / (std::numbers::pi * loop.period_s);
}

int stepsOfCommonPeriod(const ContactLoop& loop) {
  const ContactRates rates = contactRates(loop);
  if (rates.cycle > kMaxSteps || rates.sample > kMaxSteps) return 0;
  const long steps = std::lcm(rates.cycle, rates.sample);
  return steps <= kMaxSteps ? static_cast<int>(steps) : 0;
}

LoopMatrix commonPeriodMatrix(const ContactLoop& loop, double stiffness_ratio,
                              double phase_lag_rad) {
  LiftedLoop lifted(loop, stiffness_ratio, phase_lag_rad);
  const int steps = stepsOfCommonPeriod(loop);
  for (int n = 0; n < steps; ++n) lifted.step(n);
  return lifted.state();
}

bool isStable(const ContactLoop& loop, double stiffness_ratio, double phase_lag_rad) {
  const LoopMatrix matrix = commonPeriodMatrix(loop, stiffness_ratio, phase_lag_rad);
  if (!matrix.allFinite()) return false;
  if (phase_lag_rad == 0.0) {
    const Eigen::EigenSolver<Eigen::MatrixXd> solver(matrix.real(), false);
    return solver.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
  }
  const Eigen::ComplexEigenSolver<LoopMatrix> solver(matrix, false);
  return solver.eigenvalues().cwiseAbs().maxCoeff() < 1.0;
}

}  // namespace tactus
