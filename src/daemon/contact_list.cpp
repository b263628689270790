#include "tactus/daemon/contact_list.h"

#include <algorithm>
#include <cmath>

namespace tactus {
namespace {

constexpr double kTouchForce_N = 0.05;
constexpr double kReleasePause_s = 0.1;
constexpr double kSettlingBand_N = 0.05;
constexpr double kSettlingBandFraction = 0.02;
/// Times are multiples of a period with rounding errors; far below any period.
constexpr double kTimeTolerance_s = 1e-9;

}  // namespace

ContactList::ContactList(bool has_force_control, std::size_t expected_cycles)
    : has_force_control_(has_force_control) {
  samples_.reserve(expected_cycles);
}

void ContactList::add(const CycleRecord& record) {
  if (samples_.empty() && !starts(record)) return;
  samples_.push_back({record.t_s, record.force_sensor_N});
  if (record.force_sensor_N > kTouchForce_N) touching_count_ = samples_.size();
  if (touching_count_ == samples_.size()) return;
  if (record.t_s - samples_[touching_count_].t_s < kReleasePause_s - kTimeTolerance_s) return;
  finished_.push_back(summarise(true));
  samples_.clear();
  touching_count_ = 0;
}

std::vector<ContactSummary> ContactList::contacts() const {
  std::vector<ContactSummary> contacts = finished_;
  if (!samples_.empty()) contacts.push_back(summarise(false));
  return contacts;
}

bool ContactList::starts(const CycleRecord& record) const noexcept {
  return has_force_control_ ? record.force_contact_N > 0.0 : record.force_sensor_N > kTouchForce_N;
}

ContactSummary ContactList::summarise(bool is_released) const {
  ContactSummary contact;
  contact.start_s = samples_.front().t_s;
  contact.end_s = is_released ? samples_[touching_count_].t_s : samples_.back().t_s;
  for (const Sample& sample : samples_) {
    contact.peak_force_N = std::max(contact.peak_force_N, sample.force_N);
  }
  std::size_t rest = samples_.size() - 1;
  if (is_released) {
    const double rest_s = contact.end_s - kReleasePause_s + kTimeTolerance_s;
    while (rest > 0 && samples_[rest].t_s > rest_s) --rest;
    contact.settling_s = contact.end_s - contact.start_s;
    if (contact.settling_s < kReleasePause_s - kTimeTolerance_s) return contact;
  }
  const double rest_N = samples_[rest].force_N;
  const double band_N = std::max(kSettlingBand_N, kSettlingBandFraction * std::abs(rest_N));
  std::size_t settled = rest;
  while (settled > 0 && std::abs(samples_[settled - 1].force_N - rest_N) <= band_N) --settled;
  contact.settling_s = samples_[settled].t_s - contact.start_s;
  return contact;
}

}  // namespace tactus
