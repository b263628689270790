#pragma once

#include <string>
#include <vector>

#include "tactus/record/contact_figures.h"
#include "tactus/scene/json.h"

namespace tactus {

/// A contact in summary.json and of `tactus contacts`; docs/log.md has its members. links: of the
/// modules.
Json contactJson(const ContactFigures& contact, const std::vector<std::string>& links);

/// The link of a module, "-" of one that has none.
std::string linkOfModule(const std::vector<std::string>& links, int module);

}  // namespace tactus
