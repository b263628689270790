#pragma once

#include <deque>
#include <vector>

#include "tactus/record/contact_figures.h"
#include "tactus/record/contact_list.h"

namespace tactus {

/// Tells of each contact once it is over, while the run goes on. Of one of more than a minute,
/// what ContactFigures has besides its summary is of the last minute.
class ContactWatch {
 public:
  explicit ContactWatch(const ControllerConfig& config);

  /// Contacts that are over with this cycle.
  std::vector<ContactFigures> add(const CycleRecord& record);
  /// At the end of the run: those that last.
  std::vector<ContactFigures> present() const;

 private:
  ContactFigures figuresOf(const ContactSummary& contact) const;

  std::vector<ContactList> lists_;  ///< one a module
  std::deque<CycleRecord> recent_;  ///< as long as anything is touched
};

}  // namespace tactus
