#include "campaign/frame_cases.h"

#include <fmt/format.h>

#include "campaign/play.h"

namespace tactus::campaign {
namespace {

constexpr int kModuleBus = 3;
constexpr int kAfterFrame_ms = 400;

/// A short run every frame of which is troubled once.
struct ShortRun {
  const char* name;
  Moment moment;
  const char* kind;  ///< of a trouble that is there anyway; nullptr: none
  Mode until;        ///< the run ends when this mode begins, or after so many ms
  int max_ms;
};

/// Set-up by SDO, a run in contact, and drives that say what is wrong.
constexpr std::array<ShortRun, 3> kShortRuns = {{
    {"boot", Moment::kBoot, nullptr, Mode::kRunning, 1500},
    {"contact", Moment::kFirm, nullptr, Mode::kOff, 60},
    {"drive_fault", Moment::kFirm, "drive_fault", Mode::kOff, 30},
}};

Plan shortPlan(const Stage& stage, const ShortRun& run) {
  return latePlan(stage, run.moment, Ending::kMendStop, run.kind, 5, 100);
}

std::vector<SeenFrame> framesOf(const Stage& stage, const ShortRun& run, int& end_ms) {
  const Plan plan = shortPlan(stage, run);
  Play play(stage, plan);
  while (play.now_ms() < run.max_ms && (play.now_ms() == 0 || play.now().mode != run.until))
    play.step(play.input());
  end_ms = play.now_ms();
  return play.seenFrames();
}

/// What passes under this id: CiA 301's predefined connections, and the module's own.
const char* streamOf(const SeenFrame& seen) {
  if (seen.bus == kModuleBus && seen.id >= 0x100 && seen.id < 0x104) return "tactile";
  if (seen.id == 0x000) return "nmt";
  if (seen.id == 0x080) return "sync";
  if (seen.id == 0x77F) return "master_heartbeat";
  switch (seen.id & 0x780) {
    case 0x080:
      return "emergency";
    case 0x180:
      return "feedback_pdo";
    case 0x200:
      return "setpoint_pdo";
    case 0x580:
      return "sdo_answer";
    case 0x600:
      return "sdo_request";
    case 0x700:
      return "heartbeat";
    default:
      return "other";
  }
}

}  // namespace

void addFrameCases(const Stage& stage, std::vector<Case>& cases) {
  for (const ShortRun& run : kShortRuns) {
    int end_ms = 0;
    const std::vector<SeenFrame> frames = framesOf(stage, run, end_ms);
    for (std::size_t i = 0; i < frames.size(); ++i)
      for (std::size_t how = 0; how < kFrameTroubles.size(); ++how) {
        Case one{
            fmt::format("frame {} {} {} {}", run.name, streamOf(frames[i]), kFrameTroubles[how], i),
            shortPlan(stage, run)};
        // 29 is prime to 64 and to 48: a frame's bits take turns.
        one.plan.frame = FrameTrouble{static_cast<FrameTrouble::How>(how), static_cast<int>(i),
                                      static_cast<unsigned>(i) * 29U};
        const int after_ms = run.moment == Moment::kBoot ? end_ms : frames[i].t_ms;
        one.plan.clear_ms = after_ms + kAfterFrame_ms + (run.kind == nullptr ? 0 : 500);
        cases.push_back(one);
      }
  }
}

}  // namespace tactus::campaign
