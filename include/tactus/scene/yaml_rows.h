#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "tactus/scene/scene.h"

namespace tactus {

/// The text of a file with the rows of a table replaced, each a list in brackets as "[1, 2]"; all
/// else stays, comments behind and between the rows, too. One row more than there are goes behind
/// the last, with its comment. key: the path of the table, as tactile_modules[1].calibration.
/// Throws InputError where the table is none, has rows without brackets, or too many.
std::string withRows(const SourceFile& file, std::string_view key,
                     const std::vector<std::string>& rows, const std::string& comment_of_new);

}  // namespace tactus
