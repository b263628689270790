#pragma once

#include <string>

#include "tactus/daemon/record_sink.h"
#include "tactus/daemon/service_notify.h"

namespace tactus {

/// A line on standard error, which is the journal's, and a word to the service manager for each
/// change of mode or fault; of a new fault the remedy, too.
class JournalSink final : public RecordSink {
 public:
  void flush() override { service_.tellAgain(); }
  void onMode(const ModeReport& report, const std::string& description) override;

 private:
  ServiceNotify service_;
  Fault fault_ = Fault::kNone;  ///< of the last report
};

}  // namespace tactus
