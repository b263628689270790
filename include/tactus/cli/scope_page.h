#pragma once

#include <string>

#include "tactus/cli/scope_text.h"

namespace tactus {

/// One page of HTML with drawings in SVG that needs no other file and no script. Colours are those
/// of the reader's scheme, light or dark; curves and lines tell what they are by their <title>.
std::string scopePage(const ScopeView& view);

}  // namespace tactus
