#pragma once

#include <vector>

#include "tactus/control/gains.h"
#include "tactus/math/types.h"
#include "tactus/record/contact_list.h"
#include "tactus/supervisor/cycle_record.h"

namespace tactus {

/// What there is to say of one contact besides ContactSummary. Forces are the sensor's, F_sen. How
/// it rests is of its last second, or of its second half, without the 0.1 s in which it ended.
struct ContactFigures {
  ContactSummary summary;
  double position_m = 0.0;         ///< along the link, at the peak
  double time_above_s = 0.0;       ///< with F_sen > F_act + F_th
  double rest_force_N = 0.0;       ///< mean
  double swing_N = 0.0;            ///< from the smallest to the largest force at rest
  double swing_hz = 0.0;           ///< of passages of the mean, three at least; 0 below 0.1 N
  double stiffness_N_per_m = 0.0;  ///< as the law takes it, at the end
  double tcp_error_max_m = 0.0;
  double null_share =
      0.0;      ///< of the time that the law answers, that in which the null space does alone
  Gains gains;  ///< at its start
};

/// Collects them, cycle by cycle, of contacts that are known from a first look at the same cycles.
class ContactFiguresList {
 public:
  explicit ContactFiguresList(const std::vector<ContactSummary>& contacts);

  void add(const CycleRecord& record);
  std::vector<ContactFigures> figures() const;

 private:
  struct Entry {
    ContactFigures figures;
    double rest_from_s = 0.0, rest_to_s = 0.0;
    double peak_N = -1.0;
    long long cycles = 0, answers = 0, null_answers = 0;
    std::vector<double> rest_N;  ///< of a second, or less
  };

  void add(const CycleRecord& record, Entry& entry) const;
  static void finish(Entry& entry);

  std::vector<Entry> entries_;
  double period_s_ = 0.0, before_s_ = 0.0;
  bool has_before_ = false;
};

}  // namespace tactus
