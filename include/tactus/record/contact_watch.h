#pragma once

#include <vector>

#include "tactus/record/contact_follower.h"

namespace tactus {

/// Tells of each contact of an arm once it is over.
class ContactWatch {
 public:
  /// `expected_cycles` is only used to allocate in advance.
  explicit ContactWatch(const ControllerConfig& config, std::size_t expected_cycles = 0,
                        FigureSet set = FigureSet::kAll);

  /// Contacts that are over with this cycle.
  std::vector<ContactFigures> add(const CycleRecord& record);
  /// At the end of the run: those that last.
  std::vector<ContactFigures> present() const;

 private:
  std::vector<ContactFollower> modules_;
};

}  // namespace tactus
