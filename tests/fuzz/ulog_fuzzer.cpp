#include <cstddef>
#include <cstdint>
#include <sstream>
#include <string>

#include "tactus/record/ulog_reader.h"
#include "tactus/scene/input_error.h"

/// A log of whatever bytes is read or refused.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::istringstream in(std::string(reinterpret_cast<const char*>(data), size));
  try {
    tactus::UlogReader reader(in, "fuzz.ulg");
    tactus::CycleRecord record;
    while (reader.next(record)) {
    }
  } catch (const tactus::InputError&) {
  }
  return 0;
}
