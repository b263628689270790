#pragma once

#include <cstddef>
#include <deque>
#include <optional>
#include <vector>

#include "tactus/supervisor/cycle_record.h"

namespace tactus {

/// One stretch of touch, judged by the sensor's force F_sen.
struct ContactSummary {
  double start_s = 0.0;
  double end_s = 0.0;
  double peak_force_N = 0.0;
  /// From start_s until F_sen stays within max(0.05 N, 2 %) of the force at which the contact
  /// rests: that of the last cycle, or, where the touch ended before the run, that of 0.1 s before
  /// end_s, when the filter did not yet show the release. A contact shorter than that never
  /// settles: its whole length.
  double settling_s = 0.0;
  int module = 0;  ///< that felt it
};

/// Finds the contacts that one tactile module felt in a run. A contact starts when F_sen exceeds
/// the contact threshold F_th; without force control, where nothing else says what a touch is, it
/// started when F_sen last rose above 0.05 N. It ends when the mean of F_sen over 0.1 s is at most
/// F_rel (at most F_th), which is above offset and noise of the sensor, and then end_s is the first
/// cycle of these 0.1 s with at most F_rel; or with the last cycle. The threshold works one way
/// only: an arm that comes to rest just below it is still touching. Memory is bounded: in a contact
/// of more than 17 minutes at 1 kHz settling_s is known to 2e-6 of its length.
class ContactList {
 public:
  /// `expected_cycles` is only used to allocate in advance.
  ContactList(bool has_force_control, std::size_t expected_cycles, int module = 0);

  /// The contact that is over with this cycle.
  std::optional<ContactSummary> add(const CycleRecord& record);

  /// The one that still lasts, as if it ended with the last cycle.
  std::optional<ContactSummary> present() const;
  /// One may have begun.
  bool isTouching() const noexcept { return present_.cycles > 0; }

 private:
  struct Sample {
    double t_s, force_N;
  };

  /// The contact that lasts; no cycles: none does.
  struct Present {
    std::vector<Sample> samples;  ///< every stride-th
    long long cycles = 0;
    long long stride = 1;
    long long confirmed_cycles = 0;  ///< since F_sen exceeded F_th
    std::deque<Sample> newest;       ///< of these the last 0.1 s
    double newest_sum_N = 0.0;
    double peak_force_N = 0.0;
  };

  bool isTouch(const CycleRecord& record) const noexcept;
  void keep(const Sample& sample);
  void keepNewest(const Sample& sample);
  bool isReleased() const noexcept;
  double releaseTime_s() const noexcept;
  ContactSummary summarise(bool is_released) const;
  void clear();

  bool has_force_control_;
  int module_;
  double threshold_N_ = 0.0, release_N_ = 0.0;  ///< of the newest record
  Present present_;
};

/// That of a tactile module. `expected_cycles`: of all of them.
ContactList contactList(const ControllerConfig& config, std::size_t expected_cycles, int module);

}  // namespace tactus
