#pragma once

#include <deque>
#include <limits>
#include <optional>
#include <vector>

#include "tactus/record/contact_figures.h"

namespace tactus {

/// All, or what a sweep shows: contacts without the stiffness that they were found to have,
/// fitTouch(), which takes as long as a thousand cycles of a run, and no times of control steps, as
/// to read the clock takes a tenth of each cycle.
enum class FigureSet { kAll, kOfSweep };

/// Figures of the contacts of one tactile module, each once it is over, in one pass. Memory is that
/// of 1.3 s, and of the samples of ContactList.
class ContactFollower {
 public:
  /// `expected_cycles` as of contactList().
  ContactFollower(const ControllerConfig& config, std::size_t expected_cycles, int module,
                  FigureSet set = FigureSet::kAll);

  /// The contact that is over with this cycle.
  std::optional<ContactFigures> add(const CycleRecord& record);
  /// The one that lasts.
  std::optional<ContactFigures> present() const;

 private:
  /// Of a cycle.
  struct Cycle {
    double t_s, period_s, force_N, position_m, tool_error_m;
    double stiffness_N_per_m;  ///< NaN where another module feels more
    double above_s;
    bool answers, answers_by_null_space_alone;
    double way_m, task_way_m;  ///< that the law gives the contact point
  };

  /// What all cycles of a contact come to.
  struct Sums {
    double peak_N = -1.0, position_m = 0.0;
    double above_s = 0.0, tool_error_m = 0.0;
    double stiffness_N_per_m = std::numeric_limits<double>::quiet_NaN();
    double way_m = 0.0, task_way_m = 0.0;
    long long answers = 0, null_answers = 0;

    void add(const Cycle& cycle) noexcept;
    void addPeak(const Cycle& cycle) noexcept;
  };

  void passTime(const CycleRecord& record) noexcept;
  Cycle cycleOf(const CycleRecord& record) const noexcept;
  void begin(const CycleRecord& record);
  void keepTouch(const CycleRecord& record);
  ContactFigures figuresOf(const ContactSummary& contact) const;
  void addRest(ContactFigures& figures) const;

  ControllerConfig config_;
  int module_;
  FigureSet set_;
  ContactList list_;
  bool is_touching_ = false;
  double before_s_ = 0.0;
  double period_s_ = 0.0, shortest_s_ = kNoLimit;  ///< that a record stands for, and of all so far
  bool has_before_ = false;
  Gains gains_;               ///< at the start of the contact
  Sums sums_;                 ///< of its cycles that recent_ no longer has
  std::deque<Cycle> recent_;  ///< of the contact
  std::deque<TouchSample> touch_samples_;
  std::optional<double> felt_s_;  ///< since when F_sen exceeds F_th
  std::optional<TouchFit> touch_;
};

}  // namespace tactus
