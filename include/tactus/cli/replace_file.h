#pragma once

#include <functional>
#include <string>

namespace tactus {

/// Writes a file as a whole, or not at all; what it was stays beside it as path~. check: of the new
/// one, by its path while it still has another name; what it throws leaves all as it was.
void replaceFile(const std::string& path, const std::string& text,
                 const std::function<void(const std::string& next)>& check);

}  // namespace tactus
