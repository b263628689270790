#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "campaign/frame_trouble.h"
#include "campaign/injection.h"
#include "support/random.h"
#include "tactus/scene/scene.h"

namespace tactus::campaign {

inline constexpr std::array<const char*, 6> kVariants = {"null_space", "joint_space", "task_space",
                                                         "null_task",  "null_joint",  "null_limit"};

/// When a run begins; drawn runs never before enabling.
enum class Moment : std::uint8_t { kEnabling, kFree, kTouch, kFirm, kBoot, kReady };
inline constexpr std::array<const char*, 6> kMoments = {"enabling", "free", "touch",
                                                        "firm",     "boot", "ready"};

enum class Ending : std::uint8_t {
  kGoOn,      ///< the enable line off and on, as documented, and some seconds of motion
  kGoOnStop,  ///< the same, then a stop request
  kStop,      ///< a stop request
  kLeave,     ///< nobody does anything
  kMendStop,  ///< nothing more if the arm runs, else as kGoOnStop
};
inline constexpr std::array<const char*, 5> kEndings = {"go on", "go on and stop", "stop", "leave",
                                                        "mend and stop"};

/// One run, drawn from its seed.
struct Plan {
  int variant = 0;
  Moment moment = Moment::kFree;
  std::vector<Injection> injections;
  Ending ending = Ending::kGoOn;
  int clear_ms = 0;         ///< when the user begins: when all is over and quiet, or before that
  bool comes_late = false;  ///< the user, when what went wrong has had its time to come to rest
  int off_ms = 50;          ///< for which the user switches the enable line off
  int bounce_ms = 0;        ///< for which the line bounces when it is switched on
  int attempts = 3;         ///< of the user to go on
  int go_on_ms = 5500;      ///< for which the arm then runs
  std::optional<FrameTrouble> frame{};
  int reversed_from_ms = 0, reversed_until_ms = 0;  ///< a bus's frames arrive in reverse order
  std::string text() const;
};

/// Of this kind, at whom and how by chance.
Injection drawInjection(test::Random& random, const Scene& scene, const InjectionKind& kind,
                        int from_ms);
Plan drawPlan(std::uint64_t seed, std::uint64_t index, const Scene& scene);

}  // namespace tactus::campaign
