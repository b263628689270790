#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tactus/commission/joint_findings.h"
#include "tactus/commission/node_scan.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

/// What commissioning reports, in words.
namespace tactus {

/// Who answers on the buses, who does not, and what the file does not know.
std::string nodesText(const Scene& scene, const std::vector<FoundNode>& nodes);
Json nodesJson(const Scene& scene, const std::vector<FoundNode>& nodes);

/// What neither lines nor brakes do on this robot, a line each.
std::string protectionText(const HardwareConfig& hardware);

std::string findingsText(const Scene& scene, const JointFindings& found);
/// Why a joint is not finished.
std::string troubleText(const Scene& scene, int joint, const JointTrouble& trouble);

}  // namespace tactus
