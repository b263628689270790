#pragma once

#include <cstdint>

#include "tactus/control/gains.h"
#include "tactus/supervisor/swing_watch.h"

namespace tactus {

/// What is asked for: gains that were checked, see findGainProblem() of scene.
struct GainOrder {
  std::uint32_t number = 0;  ///< of whoever orders, to know the report by; not 0
  Gains gains;
  bool waits_for_free = false;  ///< begins once nothing was touched for half a second
  double for_s = kNoLimit;      ///< once it is there, it goes back by itself after this time
  std::uint32_t over = 0;       ///< the order whose gains it keeps otherwise; 0: those kept
};

/// What the loop sees of the arm in one cycle.
struct GainWatchInput {
  double force_N = 0.0;      ///< of the module that feels most
  bool is_at_limit = false;  ///< a joint moves as fast as it may
  bool has_fault = false;
  bool is_running = true;  ///< the law moves the arm: an arm that holds tries no gains
  bool is_held = false;    ///< the law does not move it, but will go on with what it remembers
  bool can_feel = true;    ///< else its motion alone is what tries them
};

enum class GainState : std::uint8_t {
  kKept,       ///< nothing changes
  kWaiting,    ///< for a moment without contact
  kRamping,    ///< on the way to what was ordered
  kOnTrial,    ///< there, and watched
  kGoingBack,  ///< to what was kept before
};

/// Why gains went back by themselves.
enum class GainTrouble : std::uint8_t { kNone, kSwings, kLosses, kAtLimits, kFault, kTimeIsOver };

struct GainReport {
  std::uint32_t number = 0;       ///< of the last order
  std::uint32_t kept_number = 0;  ///< of the order that was kept last
  GainState state = GainState::kKept;
  GainTrouble trouble = GainTrouble::kNone;
  double figure = 0.0;  ///< what tripped: N, losses a second, share of the time
  double limit = 0.0;   ///< and above what

  bool operator==(const GainReport&) const = default;
};

/// Leads the gains of a running arm from one set to the next: on a ramp (gain_ramp.h), then watched
/// for max(4 s, 10 T) of contact while the arm runs, then kept. Back to what was kept, on a ramp,
/// too, if while they ramp or are watched
///   - the force swings by more than 0.1 F_act, and does not settle,
///   - contact is lost four times a second,
///   - a joint is at its limit of speed half of the time in contact,
/// and each of these more than before the change; or if the arm has a fault. A new order counts
/// from where the gains are, and goes back to what was kept. One that keeps gains which have gone
/// back meanwhile goes back with them. While an arm is held in contact a ramp stands still, as its
/// law would meet the whole change at once when it goes on; but for one that leads back from
/// trouble. Pure, and bounded: for the loop.
class GainChange {
 public:
  GainChange(const Gains& gains, double period_s) noexcept;

  void order(const GainOrder& order) noexcept;
  /// Once a cycle, before it.
  void update(const GainWatchInput& seen) noexcept;

  const Gains& gains() const noexcept { return gains_; }     ///< of this cycle
  bool isChanging() const noexcept { return is_changing_; }  ///< gains() differ from before
  const Gains& kept() const noexcept { return kept_; }
  const GainReport& report() const noexcept { return report_; }

 private:
  /// How the arm does in contact.
  struct Figures {
    double swing_N = 0.0;
    double losses_per_s = 0.0;
    double at_limit = 0.0;  ///< share of the time
  };

  void observe(const GainWatchInput& seen) noexcept;
  bool mustWait() const noexcept;
  void begin() noexcept;
  void advance(const GainWatchInput& seen, GainState next) noexcept;
  void watch(const GainWatchInput& seen) noexcept;
  bool isOver() noexcept;
  void ramp(const Gains& to, double duration_s) noexcept;
  void goBack(GainTrouble trouble, double figure, double limit) noexcept;
  bool trips(const GainWatchInput& seen) noexcept;
  bool exceeds(GainTrouble trouble, double figure, double limit) noexcept;
  double leastSwing_N() const noexcept;
  double wayBack_s(GainTrouble trouble) const noexcept;

  double period_s_;
  Gains kept_, from_, to_, gains_;
  GainOrder order_;
  GainReport report_;
  double duration_s_ = 0.0, passed_s_ = 0.0;  ///< of the ramp
  double contact_s_ = 0.0;                    ///< on trial
  double for_s_ = kNoLimit;                   ///< of the gains that are there
  bool is_changing_ = false;
  SwingWatch swings_;
  bool is_in_contact_ = false;
  double free_s_;             ///< without contact, counted as far as an order waits for
  Figures figures_, before_;  ///< now, and the largest of late when the change began
  Figures largest_;           ///< of late
};

}  // namespace tactus
