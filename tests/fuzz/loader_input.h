#pragma once

#include <algorithm>
#include <cmath>
#include <regex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/canopen/bus_load.h"
#include "tactus/control/controller.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/sim/simulated_robot.h"

/// One input of the loader's fuzzer: the files of a scene in one text, each behind a line
/// `=== path`, the scene first; `=== --set key` gives an override.
namespace tactus::fuzz {

struct LoaderInput {
  std::vector<SourceFile> files;
  std::vector<Override> overrides;
};

inline LoaderInput splitInput(std::string_view text) {
  constexpr std::string_view kMark = "=== ";
  constexpr std::string_view kSet = "--set ";
  LoaderInput input;
  while (text.starts_with(kMark)) {
    text.remove_prefix(kMark.size());
    const std::size_t end_of_line = std::min(text.find('\n'), text.size());
    const std::string name(text.substr(0, end_of_line));
    text.remove_prefix(std::min(end_of_line + 1, text.size()));
    const std::size_t next = text.starts_with(kMark) ? 0 : text.find("\n=== ");
    const std::string content(text.substr(0, next == std::string_view::npos ? next : next + 1));
    text.remove_prefix(next == std::string_view::npos ? text.size() : next + (next > 0));
    if (name.starts_with(kSet)) {
      input.overrides.push_back({name.substr(kSet.size()), content});
    } else {
      input.files.push_back({name, content});
    }
  }
  return input;
}

inline void require(bool is_true, const char* what) {
  if (!is_true) throw std::logic_error(what);
}

/// What the daemon takes for granted of a scene's hardware: it never looks again.
inline void checkHardware(const Scene& scene) {
  const HardwareConfig& hardware = *scene.hardware;
  const auto isBus = [&](int bus) {
    return bus >= 0 && bus < static_cast<int>(hardware.buses.size());
  };
  require(hardware.drives.size() == scene.joint_names.size(), "not one drive a joint");
  for (std::size_t i = 0; i < hardware.drives.size(); ++i) {
    const DriveConfig& drive = hardware.drives[i];
    require(drive.joint == static_cast<int>(i), "drives out of order");
    require(isBus(drive.bus), "a drive on no bus");
    require(drive.node_id >= 1 && drive.node_id <= 127, "a node id that is none");
    require(drive.sign == 1 || drive.sign == -1, "a sign that is none");
    const JointLimits& limits = scene.controller.limits;
    const double largest = std::max({std::abs(limits.lower[drive.joint] - drive.offset),
                                     std::abs(limits.upper[drive.joint] - drive.offset),
                                     limits.max_velocity[drive.joint]});
    require(drive.counts_per_unit * largest <= 2147483647.0, "counts that overflow");
    for (std::size_t k = 0; k < i; ++k) {
      require(hardware.drives[k].bus != drive.bus || hardware.drives[k].node_id != drive.node_id,
              "a node id twice");
    }
  }
  for (const CanTactileConfig& module : hardware.tactile_modules)
    require(isBus(module.bus) && module.first_id <= 0x7FC, "a lost module");
  for (const BusLoad& load : busLoads(hardware, scene.period_s)) {
    require(!load.terms.empty() && load.share() <= kMaxBusLoad + 1e-6, "an overloaded bus");
  }
  for (const Trouble& trouble : scene.troubles) {
    require(isBus(trouble.bus) && trouble.until_s > trouble.from_s, "a trouble that is none");
  }
}

/// A scene that loads has to run: no exception, and nothing but finite commands.
inline void run(const Scene& scene) {
  const Controller controller(scene.controller);
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  for (int cycle = 0; cycle < 20; ++cycle) {
    robot.read(input);
    controller.update(input, controller.initialGains(), cycle * scene.period_s, scene.period_s,
                      state, output);
    if (!output.velocity.allFinite()) throw std::logic_error("a command that is not finite");
    robot.write(output.velocity);
  }
}

/// Loads the input. Throws anything but an InputError of one well-formed line on a defect.
inline void loadAndRun(std::string_view text) {
  const LoaderInput input = splitInput(text);
  try {
    const Scene scene = loadScene(input.files, input.overrides);
    if (scene.hardware) checkHardware(scene);
    run(scene);
  } catch (const InputError& error) {
    const std::string message = error.what();
    static const std::regex form(":[1-9][0-9]*:[1-9][0-9]*: [^:].*, expected ");
    for (const char c : message) {
      if (static_cast<unsigned char>(c) < 0x20) throw std::logic_error("more than one line");
    }
    if (message.size() < 2000 && !std::regex_search(message, form)) {
      throw std::logic_error("malformed: " + message);
    }
  }
}

}  // namespace tactus::fuzz
