#pragma once

#include <filesystem>
#include <string>

namespace tactus {

inline constexpr const char* kNameHelp =
    "Name of the run's folder in place of the scene's, so that runs of one scene stay side by side";

/// Throws InputError, as an error of the option --name, unless it names one folder.
void checkRunName(const std::string& name);

/// Makes the folder of a run, which has the scene's name or its own, and removes what an earlier
/// run left that this one may not replace: its summary, for one that fails leaves none, and its
/// older logs. Throws InputError, as an error of the option -o.
std::filesystem::path prepareRunFolder(const std::string& directory, const std::string& name);

}  // namespace tactus
