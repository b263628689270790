#pragma once

#include <string>
#include <vector>

#include "tactus/analysis/path_contacts.h"
#include "tactus/scene/scene.h"

namespace tactus {

// clang-format off: equations
/// Warnings of touches that the law has no room to give way to: of laws that answer in one space,
/// whose joints would have to go
///   |W^1/2 dq| = d / sqrt(k) > 1
/// rad or m for a contact that gets d deep into the path, k being k_n, k_t or k_j of (18), (19) at
/// the touch, where that is more than 2 N above F_th. By then a null space has ended, or its joints
/// are too slow; then the arm presses on with its path. Of 135 touches of real arms beyond it that
/// were simulated 130 came to more than 1.3 times touchPeak_N(), most to over ten times; 45 of the
/// 155 within it did so, too, at limits of joints and in null spaces that end sooner.
// clang-format on
std::vector<std::string> heldTouches(const Scene& scene, const PathContacts& contacts);

}  // namespace tactus
