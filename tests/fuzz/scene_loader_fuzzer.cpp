#include <cstddef>
#include <cstdint>

#include "fuzz/loader_input.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  tactus::fuzz::loadAndRun({reinterpret_cast<const char*>(data), size});
  return 0;
}
