#include "tactus/record/contact_watch.h"

#include <optional>
#include <utility>

namespace tactus {

ContactWatch::ContactWatch(const ControllerConfig& config, std::size_t expected_cycles,
                           FigureSet set) {
  for (int i = 0; i < static_cast<int>(config.tactile_modules.size()); ++i)
    modules_.emplace_back(config, expected_cycles, i, set);
}

std::vector<ContactFigures> ContactWatch::add(const CycleRecord& record) {
  std::vector<ContactFigures> over;
  for (ContactFollower& module : modules_)
    if (std::optional<ContactFigures> figures = module.add(record)) over.push_back(*figures);
  return over;
}

std::vector<ContactFigures> ContactWatch::present() const {
  std::vector<ContactFigures> lasting;
  for (const ContactFollower& module : modules_)
    if (std::optional<ContactFigures> figures = module.present()) lasting.push_back(*figures);
  return lasting;
}

}  // namespace tactus
