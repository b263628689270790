#include "tactus/daemon/journal_sink.h"

#include "tactus/record/message.h"
#include "tactus/scene/located_error.h"

namespace tactus {

void JournalSink::onMode(const ModeReport& report, const std::string& description) {
  service_.onMode(report.mode, description);
  say("{}", escaped(description));
}

}  // namespace tactus
