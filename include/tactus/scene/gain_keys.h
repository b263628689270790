#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "tactus/control/controller_config.h"
#include "tactus/scene/key_table.h"

/// The keys of a scene that are gains: where each lies in Gains, and what it may be.
namespace tactus {

struct GainKey {
  std::string path;  ///< "controller.time_constant_s"
  KeySpec spec;
  std::size_t offset;  ///< in Gains, bytes
};

/// Every word of Gains once, in its order.
const std::vector<GainKey>& gainKeys();

/// The word of Gains at an offset.
double gainAt(const Gains& gains, std::size_t offset) noexcept;

struct GainProblem {
  std::string path, problem, expectation;
};

/// The law and the arm that gains are for.
struct GainUse {
  bool is_joint_space = false;
  bool has_contact_rows = false;
  /// The largest 1 / (half range, weight) of the joints that have limits, 1/m or 1/rad; 0: nothing
  /// keeps joints off their limits.
  double narrowest_range = 0.0;
};
GainUse gainUse(const ControllerConfig& config);

/// The first gain that is out of its range, or does not go with another one or with the period.
std::optional<GainProblem> findGainProblem(const Gains& gains, const GainUse& use, double period_s);

/// The latter alone, for gains whose ranges are checked.
std::optional<GainProblem> findGainConflict(const Gains& gains, const GainUse& use,
                                            double period_s);

}  // namespace tactus
