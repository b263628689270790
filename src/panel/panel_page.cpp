#include "tactus/panel/panel_page.h"

#include <fmt/format.h>

#include <fstream>
#include <iterator>

#include "page_files.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

constexpr const char* kHtml = "text/html; charset=utf-8";
constexpr const char* kCss = "text/css; charset=utf-8";
constexpr const char* kJavaScript = "text/javascript; charset=utf-8";

PageFile ofDygraphs(const std::string& name, const char* type) {
  const std::string path = std::string(TACTUS_DYGRAPHS) + "/" + name;
  std::ifstream file(path, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.empty())
    throw RunError(path + ": cannot be read, expected the package libjs-dygraphs to be installed");
  return {"/" + name, type, text};
}

}  // namespace

std::vector<PageFile> pageFiles() {
  return {{"/", kHtml, page::kIndex},
          {"/panel.css", kCss, page::kStyle},
          {"/panel.js", kJavaScript, page::kScript},
          {"/icon.svg", "image/svg+xml", page::kIcon},
          ofDygraphs("dygraph.min.js", kJavaScript),
          ofDygraphs("dygraph.min.css", kCss)};
}

}  // namespace tactus
