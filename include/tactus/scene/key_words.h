#pragma once

#include <array>
#include <string>

#include "tactus/canopen/hardware_config.h"
#include "tactus/control/controller_config.h"
#include "tactus/plant/trouble.h"
#include "tactus/scene/scene_config.h"

/// How files spell the values of enumerations.
namespace tactus {

template <class T>
struct Word {
  const char* text;
  T value;
};

inline constexpr std::array kVariantWords = {
    Word<Variant>{"none", Variant::kNone},
    Word<Variant>{"null_space", Variant::kNullSpace},
    Word<Variant>{"joint_space", Variant::kJointSpace},
    Word<Variant>{"task_space", Variant::kTaskSpace},
    Word<Variant>{"null_task", Variant::kNullTask},
    Word<Variant>{"null_joint", Variant::kNullJoint},
    Word<Variant>{"null_limit", Variant::kNullLimit},
};

inline constexpr std::array kLevelWords = {
    Word<ControlLevel>{"velocity", ControlLevel::kVelocity},
    Word<ControlLevel>{"acceleration", ControlLevel::kAcceleration},
};

inline constexpr std::array kLimitAtWords = {
    Word<LimitAt>{"auto", LimitAt::kAuto},
    Word<LimitAt>{"resultant", LimitAt::kResultant},
    Word<LimitAt>{"stiffness_centre", LimitAt::kStiffnessCentre},
    Word<LimitAt>{"module_ends", LimitAt::kModuleEnds},
};

inline constexpr std::array kTaskSourceWords = {
    Word<TaskSource>{"trajectory", TaskSource::kTrajectory},
    Word<TaskSource>{"commands", TaskSource::kCommands},
};

/// Of TaskConfig::components.
inline constexpr std::array kComponentWords = {
    Word<int>{"x", 0},  Word<int>{"y", 1},  Word<int>{"z", 2},
    Word<int>{"rx", 3}, Word<int>{"ry", 4}, Word<int>{"rz", 5},
};

inline constexpr std::array kTroubleWords = {
    Word<Trouble::Kind>{"drop", Trouble::Kind::kDrop},
    Word<Trouble::Kind>{"delay", Trouble::Kind::kDelay},
    Word<Trouble::Kind>{"reorder", Trouble::Kind::kReorder},
    Word<Trouble::Kind>{"corrupt", Trouble::Kind::kCorrupt},
    Word<Trouble::Kind>{"duplicate", Trouble::Kind::kDuplicate},
    Word<Trouble::Kind>{"bus_off", Trouble::Kind::kBusOff},
    Word<Trouble::Kind>{"power_cut", Trouble::Kind::kPowerCut},
    Word<Trouble::Kind>{"drive_fault", Trouble::Kind::kDriveFault},
    Word<Trouble::Kind>{"ignore_commands", Trouble::Kind::kIgnoreCommands},
    Word<Trouble::Kind>{"freeze_feedback", Trouble::Kind::kFreezeFeedback},
    Word<Trouble::Kind>{"nonsense_status", Trouble::Kind::kNonsenseStatus},
    Word<Trouble::Kind>{"boot_up", Trouble::Kind::kBootUp},
    Word<Trouble::Kind>{"heartbeat_only", Trouble::Kind::kHeartbeatOnly},
    Word<Trouble::Kind>{"emergency_stop", Trouble::Kind::kEmergencyStop},
};

inline constexpr std::array kDriveKindWords = {
    Word<DriveKind>{"cia402", DriveKind::kCia402},
    Word<DriveKind>{"moteus", DriveKind::kMoteus},
};

inline constexpr std::array kHomeWords = {
    Word<MoteusHome>{"output", MoteusHome::kOutput},
    Word<MoteusHome>{"rotor", MoteusHome::kRotor},
};

inline constexpr std::array kFeedbackWords = {
    Word<EncoderSide>{"motor", EncoderSide::kMotor},
    Word<EncoderSide>{"link", EncoderSide::kLink},
};

inline constexpr std::array kArmWords = {
    Word<SimulatedArm>{"quasi_static", SimulatedArm::kQuasiStatic},
    Word<SimulatedArm>{"rigid_gears", SimulatedArm::kRigidGears},
    Word<SimulatedArm>{"flexible_gears", SimulatedArm::kFlexibleGears},
};

inline constexpr std::array kKeptLinksWords = {
    Word<KeptLinks>{"all", KeptLinks::kAll},
    Word<KeptLinks>{"tool", KeptLinks::kTool},
};

/// The word of a value; empty if it has none.
template <class Words, class T>
std::string wordOf(const Words& words, const T& value) {
  for (const auto& word : words) {
    if (word.value == value) return word.text;
  }
  return "";
}

/// The value of a word, which is one of `words`.
template <class Words>
auto valueOf(const Words& words, const std::string& text) {
  for (const auto& word : words) {
    if (text == word.text) return word.value;
  }
  return words.front().value;
}

}  // namespace tactus
