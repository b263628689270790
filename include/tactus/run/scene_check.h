#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/run/arm_check.h"
#include "tactus/run/touch_check.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"
#include "tactus/scene/stability_check.h"

namespace tactus {

/// Where a run starts.
struct StartPose {
  Vector3 p_BaseTool;              ///< m
  double smallest_singular_value;  ///< of the task's Jacobian; 0: the task cannot be controlled
};

/// What was found about a scene that is accepted.
struct Findings {
  StartPose start;
  std::vector<CoverReport> covers;
  std::optional<StabilityReport> stability;
  ExpectedContact contact;
  std::vector<std::string> warnings;  ///< of arm, machine, path, stability, contact
};

/// Throws InputError of a scene whose force control is unstable, or whose log has no room.
Findings examine(const Scene& scene);

/// What `tactus check` says of it, for people and for programs.
std::string checkText(const Scene& scene, const Findings& findings);
Json checkJson(const Scene& scene, const Findings& findings);

}  // namespace tactus
