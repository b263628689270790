#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tactus/commission/joint_findings.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene.h"

/// What commissioning writes: the robot's file, and the state beside it.
namespace tactus {

/// Of the scene's robot, as it was read.
const SourceFile& robotFile(const Scene& scene);

/// The file with what was found of a joint; all else of it stays, comments, too. Where another
/// joint has the drive's place in the file, it gets the one that this joint had; one that was seen
/// to be moved by another drive gets that one's. Throws InputError where there is no room for it.
std::string withFindings(const Scene& scene, const SourceFile& robot, const JointFindings& found);

/// The file with the lag of the slowest drive.
std::string withLag(const SourceFile& robot, double lag_s);

/// The scene as if its robot's file had this text. Throws InputError if that is refused.
Scene withRobot(const Scene& scene, const std::string& text);

/// Lines that differ, with - and + before them.
std::string differenceText(const std::string& before, const std::string& after);

/// Throws InputError where the robot's file or what lies beside it could not be written.
void refuseUnwritable(const SourceFile& robot);
/// Writes robot.text to its path; keeps_copy: of the file as it was, with a tilde behind its name.
void writeRobot(const SourceFile& robot, bool keeps_copy);

/// Beside the robot's file: what was found of each joint that was finished.
std::string statePath(const SourceFile& robot);
/// An empty object if there is none. Throws InputError if it is none of ours.
Json readState(const std::string& path);
void writeState(const std::string& path, const Json& state);
/// An entry of the state's `joints`.
Json stateOf(const Scene& scene, const JointFindings& found);
/// That a joint is finished: the state has it, and the file says what was found.
bool isFinished(const Scene& scene, const Json& state, int joint);

}  // namespace tactus
