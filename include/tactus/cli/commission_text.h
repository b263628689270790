#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "tactus/commission/joint_commission.h"
#include "tactus/scene/scene.h"

/// What commissioning asks and is told, in words. Engineers measure in degrees and mm; files have
/// rad and m.
namespace tactus {

std::string jointText(const Scene& scene, int joint);
/// Without blanks, tabs and line ends around it.
std::string trimmedLine(std::string_view line);
/// "node 3 on can0"
std::string placeText(const Scene& scene, int bus, int node_id);
/// "5.7 deg" or "20 mm", of m or rad.
std::string lengthText(const Scene& scene, int joint, double value);

/// Which way is +, by the URDF.
std::string axisText(const Scene& scene, int joint);

std::string questionText(const Scene& scene, const CommissionConfig& config,
                         const Question& question);
/// Nothing: no answer to this question.
std::optional<Answer> parseAnswer(const Scene& scene, const Question& question,
                                  std::string_view line);
/// What may be answered.
std::string expectedText(const Scene& scene, const Question& question);

}  // namespace tactus
