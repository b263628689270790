#include "soak/resources.h"

#include <malloc.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string_view>

namespace tactus::soak {
namespace {

namespace fs = std::filesystem;

int entries(const char* folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

}  // namespace

Resources resourcesNow(const std::string& folder) {
  Resources now;
  double pages = 0.0;
  std::ifstream("/proc/self/statm") >> pages >> pages;
  now.resident_bytes = pages * static_cast<double>(sysconf(_SC_PAGESIZE));
  const auto heap = mallinfo2();
  now.heap_bytes = static_cast<double>(heap.uordblks + heap.hblkhd);
  now.descriptors = entries("/proc/self/fd") - 1;  // less the one that looks
  now.threads = entries("/proc/self/task");
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() != ".ulg") continue;
    ++now.log_files;
    now.log_bytes += static_cast<double>(entry.file_size());
  }
  return now;
}

}  // namespace tactus::soak
