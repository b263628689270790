#include "tactus/record/contact_follower.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tactus {
namespace {

constexpr double kRest_s = 1.0;
constexpr double kEnding_s = 0.1;
/// A contact is known to be over 0.1 s late.
constexpr double kRecent_s = kRest_s + 2.0 * kEnding_s + 0.1;
constexpr double kLeastSwing_N = 0.1;
constexpr int kLeastPassages = 3;  ///< a force that only moves has one

/// How it rests.
void describeRest(const std::vector<double>& rest_N, double rest_s, ContactFigures& figures) {
  if (rest_N.empty()) {
    figures.rest_force_N = figures.swing_N = std::nan("");
    return;
  }
  const double mean =
      std::accumulate(rest_N.begin(), rest_N.end(), 0.0) / static_cast<double>(rest_N.size());
  const auto [least, most] = std::minmax_element(rest_N.begin(), rest_N.end());
  figures.rest_force_N = mean;
  figures.swing_N = *most - *least;
  if (figures.swing_N < kLeastSwing_N) return;
  int passages = 0;
  for (std::size_t i = 1; i < rest_N.size(); ++i)
    passages += (rest_N[i - 1] < mean) != (rest_N[i] < mean) ? 1 : 0;
  if (passages >= kLeastPassages) figures.swing_hz = 0.5 * passages / rest_s;
}

/// Whether c of the record, which is that of the contact that is felt most, is this module's.
bool feelsMost(const CycleRecord& record, int module, std::size_t modules) {
  const double* const force_N = record.force_sensor_N;
  return std::max_element(force_N, force_N + modules) == force_N + module;
}

}  // namespace

ContactFollower::ContactFollower(const ControllerConfig& config, std::size_t expected_cycles,
                                 int module, FigureSet set)
    : config_(config),
      module_(module),
      set_(set),
      list_(contactList(config, expected_cycles, module)) {}

void ContactFollower::Sums::add(const Cycle& cycle) noexcept {
  addPeak(cycle);
  above_s += cycle.above_s;
  tool_error_m = std::max(tool_error_m, cycle.tool_error_m);
  if (!std::isnan(cycle.stiffness_N_per_m)) stiffness_N_per_m = cycle.stiffness_N_per_m;
  way_m += cycle.way_m;
  task_way_m += cycle.task_way_m;
  answers += cycle.answers ? 1 : 0;
  null_answers += cycle.answers_by_null_space_alone ? 1 : 0;
}

void ContactFollower::Sums::addPeak(const Cycle& cycle) noexcept {
  if (cycle.force_N > peak_N) position_m = cycle.position_m;
  peak_N = std::max(peak_N, cycle.force_N);
}

std::optional<ContactFigures> ContactFollower::add(const CycleRecord& record) {
  if (has_before_) passTime(record);
  has_before_ = true;
  before_s_ = record.t_s;
  const std::optional<ContactSummary> over = list_.add(record);
  const bool is_touching = list_.isTouching() || over;
  if (is_touching && !is_touching_) begin(record);
  is_touching_ = is_touching;
  if (set_ == FigureSet::kAll) keepTouch(record);
  if (!is_touching) return std::nullopt;
  recent_.push_back(cycleOf(record));
  while (recent_.front().t_s < record.t_s - kRecent_s) {
    sums_.add(recent_.front());
    recent_.pop_front();
  }
  if (!over) return std::nullopt;
  is_touching_ = false;
  return figuresOf(*over);
}

/// Of records that are missing nobody knows what was then: they count for nothing.
void ContactFollower::passTime(const CycleRecord& record) noexcept {
  period_s_ = record.t_s - before_s_;
  if (period_s_ > 0.0) shortest_s_ = std::min(shortest_s_, period_s_);
  period_s_ = std::min(period_s_, shortest_s_ * (1.0 + static_cast<double>(record.missed_cycles)));
}

std::optional<ContactFigures> ContactFollower::present() const {
  const std::optional<ContactSummary> contact = list_.present();
  if (!contact) return std::nullopt;
  return figuresOf(*contact);
}

void ContactFollower::begin(const CycleRecord& record) {
  gains_ = record.gains;
  sums_ = {};
  recent_.clear();
  felt_s_.reset();
  touch_.reset();
}

/// Until the touch has been judged.
void ContactFollower::keepTouch(const CycleRecord& record) {
  const bool is_felt =
      is_touching_ && record.force_sensor_N[module_] > record.gains.force.contact_threshold_N;
  if (is_felt && !felt_s_) felt_s_ = record.t_s;
  if (touch_ && is_touching_) return;
  touch_samples_.push_back(touchSample(record, module_));
  const double kept_s = kBeforeTouch_s + (is_touching_ && felt_s_ ? kBehindTouch_s : 0.0);
  while (touch_samples_.front().t_s < record.t_s - kept_s) touch_samples_.pop_front();
  if (!is_touching_ || !felt_s_ || record.t_s < *felt_s_ + kBehindTouch_s) return;
  touch_ = fitTouch(config_, module_, touch_samples_, *felt_s_);
  touch_samples_.clear();
}

ContactFollower::Cycle ContactFollower::cycleOf(const CycleRecord& record) const noexcept {
  const ForceGains& gains = record.gains.force;
  const double force_N = record.force_sensor_N[module_];
  const bool is_above = force_N > gains.activation_force_N + gains.contact_threshold_N;
  const bool is_led = feelsMost(record, module_, config_.tactile_modules.size());
  const bool uses_task = record.u_t != 0.0 || record.u_j != 0.0;
  const double task_speed = std::abs(record.k_t * record.u_t);
  const double speed =
      std::abs(record.k_n * record.u_n) + std::abs(record.k_j * record.u_j) + task_speed;
  return {.t_s = record.t_s,
          .period_s = period_s_,
          .force_N = force_N,
          .position_m = record.contact_position_m[module_],
          .tool_error_m = Eigen::Map<const Vector3>(record.tool_error_m).norm(),
          .stiffness_N_per_m = is_led ? record.stiffness_N_per_m : std::nan(""),
          .above_s = is_above ? period_s_ : 0.0,
          .answers = record.u_n != 0.0 || uses_task,
          .answers_by_null_space_alone = record.u_n != 0.0 && !uses_task,
          .way_m = period_s_ * speed,
          .task_way_m = period_s_ * task_speed};
}

ContactFigures ContactFollower::figuresOf(const ContactSummary& contact) const {
  Sums sums = sums_;
  for (const Cycle& cycle : recent_) {
    if (cycle.t_s <= contact.end_s)
      sums.add(cycle);
    else  // a last bounce counts in peak_force_N, too
      sums.addPeak(cycle);
  }
  ContactFigures figures;
  static_cast<ContactSummary&>(figures) = contact;
  figures.position_m = sums.position_m;
  figures.time_above_s = sums.above_s;
  figures.stiffness_N_per_m = sums.stiffness_N_per_m;
  figures.tcp_error_max_m = sums.tool_error_m;
  if (sums.answers > 0)
    figures.null_share = static_cast<double>(sums.null_answers) / static_cast<double>(sums.answers);
  if (sums.way_m > 0.0)
    figures.task_share = sums.task_way_m / sums.way_m;
  else if (sums.answers > 0)  // by rows of several contacts, which have no k
    figures.task_share = std::nan("");
  figures.gains = gains_;
  if (touch_) {
    figures.touch = *touch_;
  } else if (felt_s_) {
    figures.touch = fitTouch(config_, module_, touch_samples_, *felt_s_);
  }
  addRest(figures);
  return figures;
}

void ContactFollower::addRest(ContactFigures& figures) const {
  const double length_s = figures.end_s - figures.start_s;
  const double to_s =
      std::max(figures.start_s, figures.end_s - std::min(kEnding_s, 0.1 * length_s));
  const double from_s = to_s - std::min(kRest_s, 0.5 * length_s);
  std::vector<double> rest_N;
  double rest_s = 0.0;
  for (const Cycle& cycle : recent_) {
    if (cycle.t_s < from_s || cycle.t_s > to_s) continue;
    rest_N.push_back(cycle.force_N);
    rest_s += cycle.period_s;
  }
  describeRest(rest_N, rest_s, figures);
}

}  // namespace tactus
