#pragma once

#include <string>

#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"
#include "tactus/sim/link_contacts.h"

namespace tactus {

/// For summary.json; link, obstacle and time are null where there was no contact.
Json unsensedJson(const UnsensedContact& contact, const Scene& scene);

/// "link5 met obstacle 1 with up to 219 N at 6.51 s: no module feels it"
std::string unsensedText(const UnsensedContact& contact, const Scene& scene);

}  // namespace tactus
