#pragma once

#include <optional>
#include <vector>

#include "tactus/analysis/contact_loop.h"
#include "tactus/control/controller_config.h"
#include "tactus/sim/plant_config.h"

namespace tactus {

/// A touch as the loop of a contact alone would answer it.
struct PredictedTouch {
  ContactLoop loop;  ///< delays, T, d and order
  Variant variant = Variant::kNullSpace;
  Gains gains{};
  double stiffness_N_per_m = 0.0;      ///< c_e, > 0
  double law_stiffness_N_per_m = 0.0;  ///< c, > 0
  double speed_m_per_s = 0.0;          ///< of the contact point towards the obstacle, > 0
};

/// That of a module under these gains; its stiffnesses and speed are left to the caller. Absent
/// without force control, at the acceleration level, in joint space, whose way back
/// (joint_space_transition.h) is no part of the loop, and where cycle and samples do not fit.
std::optional<PredictedTouch> predictedTouch(const ControllerConfig& config,
                                             const PlantConfig& plant, double period_s, int module,
                                             const Gains& gains);

struct PredictedForce {
  double t_s;      ///< from the touch on
  double force_N;  ///< F_sen: filtered, sampled and held
};

// clang-format off: equations
/// Runs the loop of contact_loop.h in time, from free motion at a constant speed v on. It has the
/// cycle, the sample's hold, the filter and the drives' lag, the spring c_e that only pushes, F_th
/// and F_act, and the law with what it does at a touch and after it: the feedforward gamma and how
/// V fades (contact_transition.h), the window of I, for null_limit the signed force and the limit
///   x_dot = x_eff - gamma min(x_eff, 0) + P F_p + V + max(0, P (F_p - F_act) + I),
///   x_eff = -v - beta z
/// with z what the law has moved the tool by. The task goes on with v for ever, and the space that
/// answers moves the contact by all that it is asked for. So there is in it no limit of speeds or
/// joints, no null space that ends, no joint-limit cost, no estimator, no friction, mass or gear,
/// and no second contact. Of joint space, gamma and z without the pull that
/// joint_space_transition.h adds. The touch is halfway between two samples. One value a cycle.
// clang-format on
std::vector<PredictedForce> predictForce(const PredictedTouch& touch, double duration_s);

}  // namespace tactus
