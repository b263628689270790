#include "tactus/daemon/log_sink.h"

namespace tactus {

void LogSink::add(const LoopRecord& record) {
  if (record.is_in_motion) log_.write(record.cycle);
}

}  // namespace tactus
