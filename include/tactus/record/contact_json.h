#pragma once

#include <string>

#include "tactus/record/contact_figures.h"
#include "tactus/scene/json.h"

namespace tactus {

/// A contact as `tactus contacts --json` prints it; link: of the tactile module that felt it.
Json contactJson(const ContactFigures& contact, const std::string& link);

}  // namespace tactus
