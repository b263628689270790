#pragma once

#include <string>

#include "tactus/analysis/calibration_fit.h"
#include "tactus/cli/push_file.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

namespace tactus {

/// A tactile module of a scene, as its pushes want it.
struct SceneModule {
  std::size_t index = 0;
  std::string link;
  CalibratedModule shape;
  TactileChannels channels;  ///< as robot.yaml has them now
};

SceneModule sceneModule(const Scene& scene, std::size_t index);
/// The module on a link. Throws InputError at the file that names it.
SceneModule sceneModule(const Scene& scene, const PushFile& file);

/// Throws InputError where the pushes do not make a calibration, or contradict each other.
CalibrationFit fitPushes(const PushFile& file, const CalibratedModule& module);

/// What was found, as text with the block for robot.yaml, and as JSON.
std::string fitText(const PushFile& file, const SceneModule& module, const CalibrationFit& fit);
Json fitJson(const PushFile& file, const SceneModule& module, const CalibrationFit& fit);

/// Writes the calibration into the scene's robot.yaml, all else of which stays; returns its path.
/// Throws InputError where nothing checks one of the pushes, or it has no room for it, and
/// RunError.
std::string writeCalibration(const Scene& scene, const SceneModule& module, const PushFile& file,
                             const CalibrationFit& fit);

}  // namespace tactus
