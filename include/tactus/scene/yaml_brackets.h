#pragma once

#include <string_view>

#include "tactus/scene/located_error.h"

namespace tactus {

/// Throws the InputError of the bracket that is not closed, or closed by another one, if that is
/// why a parser stopped at `stopped_at`.
void refuseUnpairedBracket(std::string_view text, const SourcePosition& stopped_at);

}  // namespace tactus
