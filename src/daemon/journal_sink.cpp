#include "tactus/daemon/journal_sink.h"

#include <fmt/format.h>

#include <cstdio>

#include "tactus/scene/located_error.h"

namespace tactus {

void JournalSink::onMode(const ModeReport& report, const std::string& description) {
  service_.onMode(report.mode, description);
  std::fputs(fmt::format("tactusd: {}\n", escaped(description)).c_str(), stderr);
}

}  // namespace tactus
