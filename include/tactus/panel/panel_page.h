#pragma once

#include <string>
#include <vector>

namespace tactus {

/// A file of the page.
struct PageFile {
  std::string path;  ///< of its address: "/panel.js"
  std::string type;  ///< of its content
  std::string text;
};

/// Those that are part of the program, and those of dygraphs, which are read. Throws RunError where
/// dygraphs is not installed.
std::vector<PageFile> pageFiles();

}  // namespace tactus
