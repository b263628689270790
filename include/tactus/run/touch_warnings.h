#pragma once

#include <string>
#include <vector>

#include "tactus/analysis/path_contacts.h"
#include "tactus/run/touch_check.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// What is doubtful about the contacts on a path, and about the forces to expect of them.
std::vector<std::string> touchWarnings(const Scene& scene, const PathContacts& contacts,
                                       const ExpectedContact& report);

}  // namespace tactus
