#pragma once

#include <functional>
#include <vector>

#include "campaign/observation.h"
#include "campaign/plan.h"
#include "campaign/stage.h"

namespace tactus::campaign {

/// The cell with the hooks of its injections.
class Play {
 public:
  Play(const Stage& stage, const Plan& plan);
  /// On from where another play has left off. finish: after each cycle, in place of prepare().
  Play(const Stage& stage, VirtualRobotCell cell, const Plan& plan,
       std::function<void(VirtualRobotCell&)> finish);

  int now_ms() const { return static_cast<int>((cell_.t_ns - start_ns_) / 1'000'000); }
  const VirtualRobotCell& cell() const { return cell_; }
  const Observation& now() const { return now_; }

  CycleInput input();           ///< what injections tell the daemon by its inputs
  void step(CycleInput input);  ///< a cycle, and those that are missed before it
  void stepAlone();             ///< a ms of the plant; the daemon has gone
  const std::vector<SeenFrame>& seenFrames() const { return gate_.seen(); }
  void setForces(bool are_there) { are_forces_there_ = are_there; }

 private:
  template <typename Do>
  void forActive(const Do& act);
  void act();
  void changeReceived(int bus, CanFrame& frame);
  bool changeSent(int bus, CanFrame& frame);
  void changeOrder(FrameBatch& frames) const;
  void deliverHeld();
  void changeBus(int bus, BusMonitor& monitor);
  std::vector<Trouble> script() const;
  void observe();
  void observeSetpoints();
  void observePlant();
  int shownSince_ms(const Injection& x, int t_ms) const;
  void observeInjections();

  const Stage& stage_;
  VirtualRobotCell cell_;
  std::function<void(VirtualRobotCell&)> finish_;
  std::int64_t start_ns_;
  std::vector<Injection> injections_;
  FrameGate gate_;
  int reversed_from_ms_, reversed_until_ms_;
  Observation now_;
  bool are_forces_there_ = true;
  bool has_stopped_ = false, has_forbidden_ = false;
};

}  // namespace tactus::campaign
