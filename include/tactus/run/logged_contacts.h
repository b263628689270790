#pragma once

#include <string>
#include <vector>

#include "tactus/record/contact_figures.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// The contacts that a log tells of.
struct LoggedContacts {
  Scene scene;
  std::vector<ContactFigures> contacts;  ///< in the order of their start
  bool is_cut_off = false;
};

/// Throws InputError, also of a log without a cycle.
LoggedContacts readContacts(const std::string& path);

/// What `tactus contacts --json` prints.
Json contactsJson(const LoggedContacts& logged);

}  // namespace tactus
