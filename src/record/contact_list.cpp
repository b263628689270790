#include "tactus/record/contact_list.h"

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
/// Of one contact, 16 bytes each.
constexpr std::size_t kMostSamples = std::size_t{1} << 20;

}  // namespace

ContactList::ContactList(bool has_force_control, std::size_t expected_cycles, int module)
    : has_force_control_(has_force_control), module_(module) {
  present_.samples.reserve(std::min(expected_cycles, kMostSamples));
}

std::optional<ContactSummary> ContactList::add(const CycleRecord& record) {
  threshold_N_ = record.gains.force.contact_threshold_N;
  // A force at which a contact would begin ends none.
  release_N_ = std::min(record.gains.force.transition.release_force_N, threshold_N_);
  if (present_.confirmed_cycles == 0 && !isTouch(record)) {
    if (present_.cycles > 0) clear();
    return std::nullopt;
  }
  const Sample sample{record.t_s, record.force_sensor_N[module_]};
  keep(sample);
  if (present_.confirmed_cycles == 0 && !has_force_control_ && sample.force_N <= threshold_N_)
    return std::nullopt;
  ++present_.confirmed_cycles;
  keepNewest(sample);
  if (!isReleased()) return std::nullopt;
  const ContactSummary over = summarise(true);
  clear();
  return over;
}

std::optional<ContactSummary> ContactList::present() const {
  if (present_.confirmed_cycles == 0) return std::nullopt;
  return summarise(false);
}

bool ContactList::isTouch(const CycleRecord& record) const noexcept {
  return record.force_sensor_N[module_] > (has_force_control_ ? threshold_N_ : kTouchForce_N);
}

/// By the mean: single samples of a free arm are above F_rel and those of one that leans on
/// something below it where the sensor is noisy. Behind records that are missing there are few.
bool ContactList::isReleased() const noexcept {
  const std::deque<Sample>& newest = present_.newest;
  const bool is_full = static_cast<std::size_t>(present_.confirmed_cycles) > newest.size() &&
                       newest.back().t_s - newest.front().t_s > 0.5 * kReleasePause_s;
  return is_full && present_.newest_sum_N <= release_N_ * static_cast<double>(newest.size());
}

double ContactList::releaseTime_s() const noexcept {
  for (const Sample& sample : present_.newest) {
    if (sample.force_N <= release_N_) return sample.t_s;
  }
  return present_.newest.front().t_s;  // their sum is rounded
}

/// Room that was allocated stays.
void ContactList::clear() {
  std::vector<Sample> samples = std::move(present_.samples);
  samples.clear();
  present_ = {};
  present_.samples = std::move(samples);
}

/// Where there is no more room, every other sample goes, and from then on every other one comes.
void ContactList::keep(const Sample& sample) {
  present_.peak_force_N = std::max(present_.peak_force_N, sample.force_N);
  if (present_.cycles++ % present_.stride != 0) return;
  std::vector<Sample>& samples = present_.samples;
  if (samples.size() >= kMostSamples) {
    for (std::size_t i = 0; i < kMostSamples / 2; ++i) samples[i] = samples[2 * i];
    samples.resize(kMostSamples / 2);
    present_.stride *= 2;
  }
  samples.push_back(sample);
}

void ContactList::keepNewest(const Sample& sample) {
  std::deque<Sample>& newest = present_.newest;
  if (!newest.empty() && !(sample.t_s >= newest.back().t_s)) {  // of a damaged log
    newest.clear();
    present_.newest_sum_N = 0.0;
  }
  newest.push_back(sample);
  present_.newest_sum_N += sample.force_N;
  while (newest.size() > 1 &&
         newest.front().t_s <= sample.t_s - kReleasePause_s + kTimeTolerance_s) {
    present_.newest_sum_N -= newest.front().force_N;
    newest.pop_front();
  }
}

ContactSummary ContactList::summarise(bool is_released) const {
  const std::vector<Sample>& samples = present_.samples;
  ContactSummary contact;
  contact.module = module_;
  contact.start_s = samples.front().t_s;
  contact.end_s = is_released ? releaseTime_s() : present_.newest.back().t_s;
  contact.peak_force_N = present_.peak_force_N;
  Sample rest = present_.newest.back();
  std::size_t settled = samples.size() - 1;
  if (is_released) {
    const double rest_s = contact.end_s - kReleasePause_s + kTimeTolerance_s;
    while (settled > 0 && samples[settled].t_s > rest_s) --settled;
    rest = samples[settled];
    contact.settling_s = contact.end_s - contact.start_s;
    if (contact.settling_s < kReleasePause_s - kTimeTolerance_s) return contact;
  }
  const double band_N = std::max(kSettlingBand_N, kSettlingBandFraction * std::abs(rest.force_N));
  while (settled > 0 && std::abs(samples[settled - 1].force_N - rest.force_N) <= band_N) --settled;
  contact.settling_s = samples[settled].t_s - contact.start_s;
  return contact;
}

ContactList contactList(const ControllerConfig& config, std::size_t expected_cycles, int module) {
  const std::size_t modules = config.tactile_modules.size();
  return {config.force_control.has_value(), expected_cycles / modules, module};
}

}  // namespace tactus
