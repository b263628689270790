#pragma once

#include <regex>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "tactus/control/controller.h"
#include "tactus/daemon/input_error.h"
#include "tactus/daemon/scene_loader.h"
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

/// A scene that loads has to run: no exception, and nothing but finite commands.
inline void run(const Scene& scene) {
  const Controller controller(scene.controller);
  SimulatedRobot robot(scene.controller, scene.plant, scene.period_s);
  ControllerState state = controller.initialState();
  RobotInput input;
  ControllerOutput output;
  for (int cycle = 0; cycle < 20; ++cycle) {
    robot.read(input);
    controller.update(input, cycle * scene.period_s, scene.period_s, state, output);
    if (!output.velocity.allFinite()) throw std::logic_error("a command that is not finite");
    robot.write(output.velocity);
  }
}

/// Loads the input. Throws anything but an InputError of one well-formed line on a defect.
inline void loadAndRun(std::string_view text) {
  const LoaderInput input = splitInput(text);
  try {
    run(loadScene(input.files, input.overrides));
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
