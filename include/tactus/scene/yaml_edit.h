#pragma once

#include <string>
#include <string_view>

#include "tactus/scene/scene.h"

namespace tactus {

/// The text of a file with one scalar replaced, or put where its section is; all else stays,
/// comments and order, too. key: dotted, of sections and entries of lists that are there, as in
/// drives.joints[2].sign. Throws InputError where there is no room for it, as where a section on
/// the way is no map.
std::string withValue(const SourceFile& file, std::string_view key, const std::string& value);

}  // namespace tactus
