#pragma once

#include <span>

namespace tactus {

struct EmbeddedFile {
  const char* name;
  const char* text;
};

/// The files of src/panel/page, put into the program by the build.
std::span<const EmbeddedFile> embeddedFiles() noexcept;

}  // namespace tactus
