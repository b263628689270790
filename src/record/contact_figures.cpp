#include "tactus/record/contact_figures.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace tactus {
namespace {

constexpr double kRest_s = 1.0;
constexpr double kEnding_s = 0.1;
constexpr double kLeastSwing_N = 0.1;
constexpr int kLeastPassages = 3;  ///< a force that only moves has one

}  // namespace

ContactFiguresList::ContactFiguresList(const std::vector<ContactSummary>& contacts) {
  for (const ContactSummary& contact : contacts) {
    const double length_s = contact.end_s - contact.start_s;
    Entry entry{};
    entry.figures.summary = contact;
    entry.rest_to_s =
        std::max(contact.start_s, contact.end_s - std::min(kEnding_s, 0.1 * length_s));
    entry.rest_from_s = entry.rest_to_s - std::min(kRest_s, 0.5 * length_s);
    entries_.push_back(std::move(entry));
  }
}

void ContactFiguresList::add(const CycleRecord& record) {
  if (has_before_) period_s_ = record.t_s - before_s_;
  has_before_ = true;
  before_s_ = record.t_s;
  for (Entry& entry : entries_) {
    const ContactSummary& contact = entry.figures.summary;
    if (record.t_s >= contact.start_s && record.t_s <= contact.end_s) add(record, entry);
  }
}

void ContactFiguresList::add(const CycleRecord& record, Entry& entry) const {
  ContactFigures& figures = entry.figures;
  const int module = figures.summary.module;
  const double force_N = record.force_sensor_N[module];
  const ForceGains& gains = record.gains.force;
  if (entry.cycles++ == 0) figures.gains = record.gains;
  if (force_N > entry.peak_N) figures.position_m = record.contact_position_m[module];
  entry.peak_N = std::max(entry.peak_N, force_N);
  const bool is_above = force_N > gains.activation_force_N + gains.contact_threshold_N;
  figures.time_above_s += is_above ? period_s_ : 0.0;
  const bool uses_task = record.u_t != 0.0 || record.u_j != 0.0;
  entry.answers += record.u_n != 0.0 || uses_task ? 1 : 0;
  entry.null_answers += record.u_n != 0.0 && !uses_task ? 1 : 0;
  const Eigen::Map<const Vector3> error(record.tool_error_m);
  figures.tcp_error_max_m = std::max(figures.tcp_error_max_m, error.norm());
  figures.stiffness_N_per_m = record.stiffness_N_per_m;
  if (record.t_s >= entry.rest_from_s && record.t_s <= entry.rest_to_s)
    entry.rest_N.push_back(force_N);
}

std::vector<ContactFigures> ContactFiguresList::figures() const {
  std::vector<ContactFigures> all;
  for (Entry entry : entries_) {
    finish(entry);
    all.push_back(entry.figures);
  }
  return all;
}

void ContactFiguresList::finish(Entry& entry) {
  ContactFigures& figures = entry.figures;
  if (entry.answers > 0)
    figures.null_share =
        static_cast<double>(entry.null_answers) / static_cast<double>(entry.answers);
  const std::vector<double>& rest = entry.rest_N;
  if (rest.size() < 2) return;
  const double mean =
      std::accumulate(rest.begin(), rest.end(), 0.0) / static_cast<double>(rest.size());
  const auto [least, most] = std::minmax_element(rest.begin(), rest.end());
  figures.rest_force_N = mean;
  figures.swing_N = *most - *least;
  if (figures.swing_N < kLeastSwing_N) return;
  int passages = 0;
  for (std::size_t i = 1; i < rest.size(); ++i)
    passages += (rest[i - 1] < mean) != (rest[i] < mean) ? 1 : 0;
  if (passages >= kLeastPassages)
    figures.swing_hz = 0.5 * passages / (entry.rest_to_s - entry.rest_from_s);
}

}  // namespace tactus
