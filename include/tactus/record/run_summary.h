#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tactus/math/histogram.h"
#include "tactus/record/contact_watch.h"
#include "tactus/record/run_log.h"
#include "tactus/record/time_figures.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"
#include "tactus/sim/link_contacts.h"
#include "tactus/supervisor/cycle_record.h"
#include "tactus/supervisor/mode_report.h"

namespace tactus {

/// Of tasks with a rotation.
struct RotationError {
  double max_rad = 0.0, rms_rad = 0.0, final_rad = 0.0;
};

/// The time that an arm went on without a tactile module.
struct ModuleLoss {
  int module = 0;
  double start_s = 0.0, end_s = 0.0;
};

/// The figures of a run that its summary.json holds. Forces are the sensor's, F_sen, of several the
/// largest; the tool's error is that of the measured arm.
struct RunFigures {
  long long cycles = 0;
  double peak_force_N = 0.0;
  double final_force_N = 0.0;
  double tcp_error_max_m = 0.0;
  double tcp_error_rms_m = 0.0;
  double tcp_error_final_m = 0.0;
  std::optional<RotationError> tcp_rotation_error;
  double peak_joint_speed_squared = 0.0;  ///< largest sum of squares of the command; m/s, rad/s
  /// Cycles with a desired joint within 0.1 mm or 0.1 mrad of a position limit, or beyond it.
  long long joints_at_limit_cycles = 0;
  double stiffness_final_N_per_m = 0.0;
  double stiffness_at_peak_N_per_m = 0.0;   ///< in the (first) cycle of the peak force
  std::vector<ContactFigures> contacts;     ///< in the order of their start
  long long further_contacts = 0;           ///< behind the first 10000, of which no more is known
  std::uint64_t modules_lost = 0;           ///< in the last cycle; bit i: module i
  std::vector<ModuleLoss> module_losses;    ///< in the order of their start
  long long further_losses = 0;             ///< behind the first 10000, likewise
  std::optional<TimeFigures> step_time_ns;  ///< absent with FigureSet::kOfSweep
  /// The strongest of the simulated world that no module feels; absent without capsules.
  std::optional<UnsensedContact> unsensed;
  FaultReport end;  ///< the fault that ended the run, for who runs it to fill in; none: as planned
};

/// Collects the figures of a run, cycle by cycle.
class RunSummary {
 public:
  /// `expected_cycles` is only used to allocate in advance.
  RunSummary(const ControllerConfig& config, std::size_t expected_cycles,
             FigureSet set = FigureSet::kAll);

  void add(const CycleRecord& record);
  /// All but contacts and losses, so that memory does not grow.
  void addFigures(const CycleRecord& record) noexcept;

  RunFigures figures() const;
  /// At any time, at no cost: without contacts, losses, times and what is a root mean square.
  const RunFigures& soFar() const noexcept { return figures_; }

 private:
  void addToolError(const CycleRecord& record) noexcept;
  void addJoints(const CycleRecord& record) noexcept;
  void addLosses(const CycleRecord& record);

  JointLimits limits_;
  RunFigures figures_;
  int modules_;
  std::uint64_t listed_losses_ =
      0;  ///< modules whose present loss is the last one of theirs listed
  ContactWatch contacts_;
  double squared_error_sum_m2_ = 0.0, squared_rotation_sum_rad2_ = 0.0;
  bool is_timed_;
  Histogram step_times_;
};

/// The links of the modules in CycleRecord::modules_lost.
std::vector<std::string> lostModules(const Scene& scene, std::uint64_t modules_lost);

/// What only a run on hardware has.
struct HardwareFigures {
  const LogState& log;
  const Json& loop;  ///< the member "loop"
};

/// What summary.json holds. real_time_factor: duration of the run over the time it took.
Json summaryJson(const Scene& scene, const RunFigures& figures, double real_time_factor,
                 const HardwareFigures* hardware = nullptr);

/// Writes it to a file; throws InputError if that cannot be opened, RunError if not written.
void writeSummary(const std::string& path, const Scene& scene, const RunFigures& figures,
                  double real_time_factor, const HardwareFigures* hardware = nullptr);

}  // namespace tactus
