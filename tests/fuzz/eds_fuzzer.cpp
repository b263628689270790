#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>

#include "tactus/scene/drive_sheets.h"
#include "tactus/scene/eds_check.h"
#include "tactus/scene/input_error.h"

/// A data sheet of whatever bytes is taken, or refused in one line that says where.
namespace {

[[noreturn]] void report(const char* problem, const std::string& text) {
  std::fprintf(stderr, "%s: %s\n", problem, text.c_str());
  std::abort();
}

void requireOneLine(const std::string& error) {
  for (const char c : error)
    if (static_cast<unsigned char>(c) < 0x20) report("more than one line", error);
  if (!error.starts_with("drive.eds:") || error.find(", expected ") == std::string::npos)
    report("malformed", error);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace tactus;
  const std::string text(reinterpret_cast<const char*>(data), size);
  try {
    const auto eds = std::make_shared<const EdsFile>(parseEds({"drive.eds", text}));
    DriveConfig drive;
    applySheet({eds, {}}, drive);
    if (drive.transmit_pdos < 4 || drive.transmit_pdos > 512) report("PDOs", text);
    checkEds(*eds, drive, {"can0", 1e6}, {}, 0.001);
  } catch (const InputError& error) {
    requireOneLine(error.what());
  }
  return 0;
}
