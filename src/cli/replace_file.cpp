#include "tactus/cli/replace_file.h"

#include <filesystem>

#include "tactus/record/output_file.h"

namespace tactus {

void replaceFile(const std::string& path, const std::string& text,
                 const std::function<void(const std::string& next)>& check) {
  namespace fs = std::filesystem;
  const std::string next = path + ".next";
  OutputFile file(next);
  file.append(text);
  file.close();
  try {
    check(next);
  } catch (...) {
    fs::remove(next);
    throw;
  }
  fs::permissions(next, fs::status(path).permissions());
  fs::copy_file(path, path + "~", fs::copy_options::overwrite_existing);
  fs::rename(next, path);
}

}  // namespace tactus
