#pragma once

#include <string>

#include "tactus/scene/scene.h"

namespace tactus {

/// `collision_capsules` for the scene's robot.yaml, as YAML to paste, with comments that say where
/// they come from and what is left out. From the boxes, cylinders and spheres of the URDF's
/// collision geometry; where no link has any, from the ways between joints, less what covers of
/// modules take up, with a radius that is an assumption. Throws InputError for geometry that
/// is none.
std::string proposeCapsules(const Scene& scene);

}  // namespace tactus
