#pragma once

#include <string>

#include "tactus/daemon/loop_figures.h"
#include "tactus/daemon/loop_link.h"

namespace tactus {

/// How a run has ended.
struct RunEnd {
  FaultReport fault;  ///< kNone: as planned
  LoopFigures loop;   ///< all but the times
};

/// One of those who take what the loop hands over. All are called by one thread, which is not the
/// loop's, and may take their time.
class RecordSink {
 public:
  virtual ~RecordSink() = default;

  /// Each cycle, in its turn.
  virtual void add(const LoopRecord&) {}
  /// After all that was at hand.
  virtual void flush() {}
  /// Each change of mode or fault; `description` as by describeMode().
  virtual void onMode(const ModeReport&, const std::string& /*description*/) {}
  /// After the loop's end, once.
  virtual void finish(const RunEnd&) {}
};

}  // namespace tactus
