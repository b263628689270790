#pragma once

#include <optional>

#include "tactus/cli/commission_desk.h"
#include "tactus/commission/commission_config.h"
#include "tactus/scene/scene.h"

namespace tactus {

struct CommissionOptions {
  MotionBounds revolute = kRevoluteBounds, prismatic = kPrismaticBounds;
  double file_factor = 10.0;
  std::optional<int> joint;    ///< this one alone
  bool is_scan_alone = false;  ///< names nodes, moves nothing
  bool json = false;           ///< of the scan
};

/// Throws InputError if the motions would be too short to be seen and measured, or, unless the scan
/// is all, a joint may have so few counts that nobody could tell whether it follows.
CommissionConfig commissionConfig(const Scene& scene, const CommissionOptions& options);

/// Commissions the joints of the scene's robot, which has hardware, until all are finished, the
/// engineer ends, or the desk is stopped; an exit code. Throws InputError for a state that is none.
int runCommission(const Scene& scene, const CommissionOptions& options, CommissionDesk& desk);

}  // namespace tactus
