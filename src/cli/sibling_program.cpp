#include "tactus/cli/sibling_program.h"

#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "tactus/record/run_error.h"

namespace tactus {

void becomeSibling(const std::string& name, const std::vector<std::string>& arguments) {
  const std::filesystem::path program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / name;
  std::vector<char*> words = {const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  ::execv(program.c_str(), words.data());
  throw RunError(program.string() + ": cannot be run (" + std::generic_category().message(errno) +
                 "), expected this program beside tactus; the build makes both");
}

}  // namespace tactus
