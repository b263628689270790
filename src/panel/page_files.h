#pragma once

/// The files of src/panel/page, put into the program by the build.
namespace tactus::page {

extern const char* const kIndex;
extern const char* const kStyle;
extern const char* const kScript;
extern const char* const kIcon;

}  // namespace tactus::page
