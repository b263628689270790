#include "tactus/daemon/loss_sink.h"

#include "tactus/record/message.h"
#include "tactus/record/run_summary.h"
#include "tactus/scene/located_error.h"

namespace tactus {

void LossSink::add(const LoopRecord& record) {
  const std::uint64_t now = record.is_in_motion ? record.cycle.modules_lost : 0;
  if (now == modules_lost_) return;
  const auto tell = [&](std::uint64_t modules, const std::string& what) {
    for (const std::string& link : lostModules(scene_, modules))
      say("tactile module {} {} at {:.9g} s{}", escaped(link), what, record.cycle.t_s,
          what == "lost" ? ", the arm goes on slowly" : "");
  };
  tell(now & ~modules_lost_, "lost");
  tell(modules_lost_ & ~now, "is back");
  modules_lost_ = now;
}

}  // namespace tactus
