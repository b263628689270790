#include "tactus/commission/joint_commission.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

using Kind = Answer::Kind;

/// Of the travel that is allowed: so near to it a motion does not get by measuring.
constexpr double kWideShare = 0.8;
constexpr int kMostScaleStrokes = 10;
/// Of the way that was commanded.
constexpr double kLeastShare = 0.8;
/// Of the travel: a shorter way to an end is none.
constexpr double kLeastJog = 0.05;
/// Of the travel: a shorter wave tells no lag, and further on there may be something in the way.
constexpr double kLeastWave = 0.25;
/// So many at different places show a wrong one among them; fewer are believed in nothing.
constexpr std::size_t kTrustedMarks = 3;

}  // namespace

JointCommission::JointCommission(const CommissionConfig& config, int joint, NodeUses& uses)
    : config_(&config), joint_(joint), uses_(&uses) {
  uses.forgetTrials();
  findings_.joint = joint;
  tryNext();
}

void JointCommission::tryNext() {
  node_ = uses_->candidate(joint_);
  if (!node_) return fail({.kind = JointTroubleKind::kNoNode});
  is_identified_ = uses_->isKnown(joint_);
  unseen_counts_ = 0.0;
  step_ = Step::kReady;
  ask(Asked::kReady, 0.0);
}

void JointCommission::fail(const JointTrouble& trouble) {
  trouble_ = trouble;
  if (node_ && trouble_.node_id == 0) {
    trouble_.bus = node_->bus;
    trouble_.node_id = node_->node_id;
  }
  question_.reset();
  step_ = Step::kFinished;
}

void JointCommission::ask(Asked asked, double counts) {
  Question question{asked, joint_, node_->bus, node_->node_id};
  if (const auto known = scale()) question.position = known->position(counts);
  question.is_upper = is_asked_upper_;
  question_ = question;
}

void JointCommission::askAgain(Asked asked, double counts) {
  ask(asked, counts);
  question_->is_refused = true;
}

bool JointCommission::isAnswer(const Answer& answer) const noexcept {
  if (!question_) return false;
  const auto is = [&answer](std::initializer_list<Kind> kinds) {
    return std::ranges::find(kinds, answer.kind) != kinds.end();
  };
  switch (question_->asked) {
    case Asked::kReady:
      return is({Kind::kYes, Kind::kNo});
    case Asked::kDirection:
      if (answer.kind == Kind::kOtherJoint)
        return !is_identified_ && answer.joint >= 0 && answer.joint < config_->joints() &&
               answer.joint != joint_ && !uses_->isKnown(answer.joint);
      return is({Kind::kPlus, Kind::kMinus, Kind::kNothing});
    case Asked::kPlace:
      return answer.kind == Kind::kNumber && std::isfinite(answer.value);
    case Asked::kJog:
      return is({Kind::kPlus, Kind::kMinus, Kind::kUpper, Kind::kLower, Kind::kDone});
    case Asked::kEndPlace:
      return answer.kind == Kind::kUnknown ||
             (answer.kind == Kind::kNumber && std::isfinite(answer.value));
  }
  return false;
}

void JointCommission::take(const Answer& answer, double counts) {
  const Asked asked = question_->asked;
  question_.reset();
  switch (asked) {
    case Asked::kReady:
      if (answer.kind == Kind::kNo) return fail({.kind = JointTroubleKind::kStopped});
      return begin(Step::kProbe, 1.0);
    case Asked::kDirection:
      return takeDirection(answer, counts);
    case Asked::kPlace:
      return takeMark(answer.value, counts);
    case Asked::kJog:
      return takeJog(answer, counts);
    case Asked::kEndPlace:
      return takeEndPlace(answer, counts);
  }
}

/// distance: as a share of the travel that is allowed, by the sign of counts.
void JointCommission::begin(Step step, double distance) noexcept {
  beginShape(step, {StrokeShape::Kind::kStep, distance * allowed().max_travel});
}

void JointCommission::beginShape(Step step, const StrokeShape& shape) noexcept {
  step_ = step;
  shape_ = shape;
  stroke_bounds_ = bounds();
  const double unit = stroke_bounds_.counts_per_unit;
  const MotionLimits& limits = stroke_bounds_.limits;
  uses_->noteBounds(*node_,
                    {unit * stroke_bounds_.max_travel, unit * limits.max_speed,
                     unit * limits.max_acceleration, unit * stroke_bounds_.max_following_error});
}

void JointCommission::takeDirection(const Answer& answer, double counts) {
  if (answer.kind == Kind::kOtherJoint) {
    uses_->learn(answer.joint, node_->bus, node_->node_id);
    return tryNext();
  }
  if (answer.kind == Kind::kNothing) {
    const double gone = std::abs(last_stroke_.end_counts - last_stroke_.start_counts);
    unseen_counts_ = std::max(unseen_counts_, gone);
    if (fewestCounts(joint_) < config_->file_factor * toldCounts(joint_).most)
      return begin(Step::kProbe, 1.0);
    uses_->dismiss(*node_);
    return tryNext();
  }
  seen_sign_ = answer.kind == Kind::kPlus ? 1 : -1;
  is_identified_ = true;
  uses_->learn(joint_, node_->bus, node_->node_id);
  step_ = Step::kScale;
  ask(Asked::kPlace, counts);
}

void JointCommission::takeMark(double q, double counts) {
  const double before = fewestCounts(joint_);
  marks_.push_back({counts, q});
  const double misfit = largestMisfit(marks_);
  const double most = kMostMisfit_errors * allowed().measuring_error;
  if (misfit > most)
    return fail({.kind = JointTroubleKind::kCannotTell, .value = misfit, .limit = most});
  const double told = mostCountsPerUnit(marks_, allowed().measuring_error);
  const double assumed = assumedCounts(joint_);
  if (told < assumed)
    return fail({.kind = JointTroubleKind::kFewerCounts, .value = told, .limit = assumed});
  if (scale_strokes_ >= kMostScaleStrokes)
    return fail({.kind = JointTroubleKind::kStillOpen, .value = 1.0 * scale_strokes_});
  if (marks_.size() >= kTrustedMarks)
    fewest_ = std::clamp(fewestCountsPerUnit(marks_, allowed().measuring_error), before,
                         kMostGrowth * before);
  if (isWide() && scale()->sign != seen_sign_)
    return fail({.kind = JointTroubleKind::kSignsDisagree});
  if (isWide()) return ask(Asked::kJog, counts);
  begin(Step::kScale, scale_strokes_++ % 4 < 2 ? -1.0 : 1.0);  // two there, two back
}

/// Motions are about as long as they may be, and the sign is told by marks, too.
bool JointCommission::isWide() const noexcept {
  const auto known = scale();
  return known && marks_.size() >= kTrustedMarks &&
         fewestCounts(joint_) >= kWideShare * known->counts_per_unit;
}

/// Far from all others, a wrong place would turn the line, so it is believed only if it fits them.
void JointCommission::takeEndPlace(const Answer& answer, double counts) {
  if (answer.kind != Kind::kNumber) return ask(Asked::kJog, counts);
  marks_.push_back({counts, answer.value});
  const auto known = scale();
  const bool fits = known && known->sign == seen_sign_ &&
                    largestMisfit(marks_) <= kMostMisfit_errors * allowed().measuring_error;
  if (fits) return ask(Asked::kJog, counts);
  marks_.pop_back();
  askAgain(Asked::kEndPlace, counts);
}

/// + and - are ways of the joint as it was seen to go.
void JointCommission::takeJog(const Answer& answer, double counts) {
  switch (answer.kind) {
    case Kind::kPlus:
      return jog(1.0, counts);
    case Kind::kMinus:
      return jog(-1.0, counts);
    case Kind::kUpper:
    case Kind::kLower:
      return takeEnd(answer.kind == Kind::kUpper, counts);
    default:
      return beginWave(counts);
  }
}

/// No further than to an end that was told.
void JointCommission::jog(double way, double counts) {
  const double sense = way * seen_sign_;  // of counts
  const auto& end = way > 0.0 ? upper_counts_ : lower_counts_;
  const double travel = bounds().counts_per_unit * allowed().max_travel;
  const double share = end ? std::min(1.0, sense * (*end - counts) / travel) : 1.0;
  if (share < kLeastJog) return askAgain(Asked::kJog, counts);
  begin(Step::kJog, sense * share);
}

/// Between the ends there is room for their margins, and for the wave.
void JointCommission::takeEnd(bool is_upper, double counts) {
  const auto& other = is_upper ? lower_counts_ : upper_counts_;
  const double room = std::max(2.0 * allowed().margin, 0.5 * allowed().max_travel);
  const double way = other ? (is_upper ? seen_sign_ : -seen_sign_) * (counts - *other) : 0.0;
  if (other && !(way > room * fewestCounts(joint_))) return askAgain(Asked::kJog, counts);
  is_asked_upper_ = is_upper;
  (is_upper ? upper_counts_ : lower_counts_) = counts;
  ask(Asked::kEndPlace, counts);
}

/// Where there is room: away from the nearer end of both, else back from where it came, but not
/// beyond an end that was told. Too near to that it has to be jogged away first.
void JointCommission::beginWave(double counts) {
  double away = shape_.distance > 0.0 ? -1.0 : 1.0;
  double amplitude = 0.5 * allowed().max_travel;
  if (upper_counts_ && lower_counts_) {
    away = 0.5 * (*upper_counts_ + *lower_counts_) > counts ? 1.0 : -1.0;
    const double room =
        std::max(std::abs(*upper_counts_ - counts), std::abs(*lower_counts_ - counts));
    amplitude = std::min(amplitude, room / bounds().counts_per_unit);
  } else if (upper_counts_ || lower_counts_) {
    const double to_end = (upper_counts_ ? *upper_counts_ : *lower_counts_) - counts;
    const double room = std::abs(to_end) / bounds().counts_per_unit;
    if (away * to_end > 0.0) amplitude = std::min(amplitude, room);
    if (amplitude < kLeastWave * allowed().max_travel) return askAgain(Asked::kJog, counts);
  }
  beginShape(Step::kWave, {StrokeShape::Kind::kWave, away * amplitude});
}

StrokePlan JointCommission::stroke() const noexcept {
  return {node_->bus, node_->node_id, stroke_bounds_, shape_, uses_->entryFor(joint_, *node_)};
}

void JointCommission::onStroke(const StrokeReport& report) {
  last_stroke_ = report;
  JointTrouble trouble{.kind = JointTroubleKind::kStroke, .stroke = report};
  const bool is_stopped = report.end == StrokeEnd::kStopped;
  if (is_stopped) trouble.kind = JointTroubleKind::kStopped;
  const bool goes_on = is_stopped && report.is_seen_off;  // from where it stopped
  if (report.end != StrokeEnd::kDone && !goes_on) return fail(trouble);
  const double unit = stroke_bounds_.counts_per_unit;
  const double gone = std::abs(report.end_counts - report.start_counts);
  const bool is_step = shape_.kind == StrokeShape::Kind::kStep;
  const double asked = is_step && !is_stopped ? std::abs(shape_.distance) * unit : 0.0;
  if (gone < kLeastShare * asked) {
    trouble.kind = JointTroubleKind::kMovedShort;
    trouble.value = gone;
    trouble.limit = asked;
    return fail(trouble);
  }
  error_counts_ = std::max(error_counts_, report.values.largest_error * unit);
  acceleration_counts_ = std::max(acceleration_counts_, report.values.largest_acceleration * unit);
  if (step_ == Step::kWave && !is_stopped) {
    findings_.lag_s = report.values.lag_s;
    return finish();
  }
  ask(step_ == Step::kProbe   ? Asked::kDirection
      : step_ == Step::kScale ? Asked::kPlace
                              : Asked::kJog,
      report.end_counts);
}

std::optional<JointScale> JointCommission::scale() const {
  return fitScale(marks_, allowed().measuring_error);
}

}  // namespace tactus
