#include "tactus/panel/panel_page.h"

#include <fstream>
#include <iterator>
#include <string_view>

#include "page_files.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

/// A page has no others.
const char* typeOf(std::string_view name) noexcept {
  if (name.ends_with(".html")) return "text/html; charset=utf-8";
  if (name.ends_with(".css")) return "text/css; charset=utf-8";
  if (name.ends_with(".js")) return "text/javascript; charset=utf-8";
  return "image/svg+xml";
}

std::string readDygraphs(const std::string& name) {
  const std::string path = std::string(TACTUS_DYGRAPHS) + "/" + name;
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.empty())
    throw RunError(path + ": cannot be read, expected the package libjs-dygraphs to be installed");
  return text;
}

}  // namespace

std::vector<PageFile> pageFiles() {
  std::vector<PageFile> files;
  for (const auto& [name, text] : embeddedFiles()) {
    const std::string path = std::string_view(name) == "index.html" ? "" : name;
    files.push_back({"/" + path, typeOf(name), text});
  }
  for (const char* name : {"dygraph.min.js", "dygraph.min.css"})
    files.push_back({std::string("/") + name, typeOf(name), readDygraphs(name)});
  return files;
}

}  // namespace tactus
