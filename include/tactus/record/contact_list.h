#pragma once

#include <cstddef>
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
};

/// Finds the contacts of a run. A contact starts when F_sen exceeds the contact threshold (F_p > 0;
/// without force control when F_sen > 0.05 N). It ends when F_sen has been at most 0.05 N for 0.1
/// s, and then end_s is the beginning of that pause; or with the last cycle. The threshold works
/// one way only: an arm that comes to rest just below it is still touching. Memory is bounded: in
/// a contact of more than 17 minutes at 1 kHz settling_s is known to 2e-6 of its length.
class ContactList {
 public:
  /// `expected_cycles` is only used to allocate in advance.
  ContactList(bool has_force_control, std::size_t expected_cycles);

  void add(const CycleRecord& record);

  /// The contacts so far; one that still lasts ends with the last cycle.
  std::vector<ContactSummary> contacts() const;

 private:
  struct Sample {
    double t_s, force_N;
  };

  /// The contact that lasts; no cycles: none does.
  struct Present {
    std::vector<Sample> samples;  ///< every stride-th
    long long cycles = 0;
    long long stride = 1;
    Sample newest{};
    bool is_touching = true;
    double released_s = 0.0;  ///< when the touch ended, if it has
    double peak_force_N = 0.0;
  };

  bool starts(const CycleRecord& record) const noexcept;
  void keep(const Sample& sample);
  ContactSummary summarise(bool is_released) const;

  bool has_force_control_;
  std::vector<ContactSummary> finished_;
  Present present_;
};

}  // namespace tactus
