#pragma once

#include <filesystem>
#include <string>

namespace tactus {

/// Makes the folder of a scene's run and removes what an earlier run left that this one may not
/// replace: its summary, for one that fails leaves none, and its older logs. Throws InputError, as
/// an error of the option -o.
std::filesystem::path prepareRunFolder(const std::string& directory, const std::string& scene);

}  // namespace tactus
