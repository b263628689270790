#pragma once

#include <optional>
#include <string>
#include <vector>

#include "tactus/analysis/contact_loop.h"
#include "tactus/control/controller_config.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// One of the loops that a contact closes through a controller.
struct VariantLoop {
  std::string name;  ///< for people: "both spaces"
  ContactLoop loop;
  std::optional<AnswerSpace> space;  ///< whose answer it is, where the tool does not come back
};

/// The loops of a variant as far as they differ, the least stable first; none without force
/// control. They are those of the linear regime with a constant stiffness: nothing at its limits,
/// no estimator, and without the joint-limit cost, which can only hold back. For the contact of the
/// joint space all motion is fed forward, its pull too, while it is towards the obstacle.
/// Of a contact of that tactile module alone.
std::vector<VariantLoop> variantLoops(const ControllerConfig& config, const PlantConfig& plant,
                                      double period_s, int module = 0);

/// Puts masses, servos and gears into those of one space that moves the contact: for a push across
/// the cover's link and the vertical, on the middle of the module's cover at q_start. law_N_per_m:
/// c.
void addGears(const ControllerConfig& config, const ArmDynamicsConfig& arm, double law_N_per_m,
              std::vector<VariantLoop>& loops, int module = 0);

}  // namespace tactus
