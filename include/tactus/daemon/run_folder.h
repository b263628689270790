#pragma once

#include <filesystem>
#include <string>

namespace tactus {

/// Makes the folder of a scene's run and removes the summary of an earlier run: one that fails
/// leaves none. Throws InputError, as an error of the option -o.
std::filesystem::path prepareRunFolder(const std::string& directory, const std::string& scene);

}  // namespace tactus
