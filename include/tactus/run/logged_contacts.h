#pragma once

#include <string>
#include <vector>

#include "tactus/record/contact_figures.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// The contacts that logs tell of.
struct LoggedContacts {
  Scene scene;
  std::vector<ContactFigures> contacts;  ///< in the order of their start
  bool is_cut_off = false;               ///< the newest log
  int first_part = 0;                    ///< of the run; above 0: what was before is not there
  double begin_s = 0.0;                  ///< of the first cycle
};

/// Of the logs of one run, the oldest first. Throws InputError, also of logs without a cycle.
LoggedContacts readContacts(const std::vector<std::string>& paths);

/// What `tactus contacts --json` prints.
Json contactsJson(const LoggedContacts& logged);

}  // namespace tactus
