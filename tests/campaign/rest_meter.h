#pragma once

#include "campaign/judges.h"
#include "campaign/plan.h"

namespace tactus::campaign {

/// How the arm is when the user comes, and how long it took to rest.
class RestMeter {
 public:
  explicit RestMeter(const Plan& plan) : plan_(plan) {}

  void look(const Look& look);

  Mode mode() const { return mode_; }
  Fault fault() const { return fault_; }
  /// The longest time from where the arm left running, or from the first trouble if it did not run,
  /// to where no drive moves any more.
  int rest_ms() const { return rest_ms_; }

 private:
  void judgeRest(const Look& look) const;

  const Plan& plan_;
  Mode mode_ = Mode::kOff;
  Fault fault_ = Fault::kNone;
  int stop_ms_ = -1;
  int fault_ms_ = 0;
  int rest_ms_ = 0;
  bool has_let_go_ = false;  ///< a drive, while it moved
};

}  // namespace tactus::campaign
