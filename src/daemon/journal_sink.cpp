#include "tactus/daemon/journal_sink.h"

#include <utility>

#include "tactus/record/message.h"
#include "tactus/scene/located_error.h"

namespace tactus {

void JournalSink::onMode(const ModeReport& report, const std::string& description) {
  service_.onMode(report.mode, description);
  say("{}", escaped(description));
  const Fault fault = std::exchange(fault_, report.fault);
  const char* const remedy = faultRow(report.fault).remedy;
  if (report.fault != fault && *remedy != '\0') say("what to do: {}", remedy);
}

}  // namespace tactus
