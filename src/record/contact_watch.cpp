#include "tactus/record/contact_watch.h"

#include <algorithm>

namespace tactus {
namespace {

constexpr double kMemory_s = 60.0;

}  // namespace

ContactWatch::ContactWatch(const ControllerConfig& config) : lists_(contactLists(config, 0)) {}

std::vector<ContactFigures> ContactWatch::add(const CycleRecord& record) {
  recent_.push_back(record);
  while (recent_.front().t_s < record.t_s - kMemory_s) recent_.pop_front();
  std::vector<ContactFigures> over;
  for (ContactList& list : lists_) {
    const std::size_t before = list.finished().size();
    list.add(record);
    if (list.finished().size() > before) over.push_back(figuresOf(list.finished().back()));
  }
  if (std::ranges::none_of(lists_, [](const ContactList& list) { return list.isTouching(); }))
    recent_.clear();
  return over;
}

std::vector<ContactFigures> ContactWatch::present() const {
  std::vector<ContactFigures> figures;
  for (const ContactList& list : lists_) {
    const std::vector<ContactSummary> contacts = list.contacts();
    if (contacts.size() > list.finished().size()) figures.push_back(figuresOf(contacts.back()));
  }
  return figures;
}

ContactFigures ContactWatch::figuresOf(const ContactSummary& contact) const {
  ContactFiguresList list({contact});
  for (const CycleRecord& record : recent_) list.add(record);
  return list.figures().front();
}

}  // namespace tactus
