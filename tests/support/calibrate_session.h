#pragma once

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <deque>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "support/virtual_module.h"
#include "tactus/cli/calibrate_record.h"
#include "tactus/cli/commands.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/json.h"
#include "tactus/scene/scene_loader.h"

namespace tactus::test {

/// What the engineer types, and what his hand does while a push is measured.
struct ScriptedAnswer {
  std::string line;
  Wrench5 load = Wrench5::Zero();
  Wrench5 growth_per_s = Wrench5::Zero();
  bool is_too_early = false;  ///< typed while the one before it is at work
};

class CalibrateSession : public ::testing::Test {
 protected:
  CalibrateSession() {
    const std::string robots = TACTUS_SOURCE_DIR "/config/robots/crops9/";
    std::filesystem::copy_file(robots + "crops9.urdf", path("crops9.urdf"));
    std::filesystem::copy_file(robots + "robot.yaml", path("robot.yaml"));
    std::ofstream(path("scene.yaml")) << "robot: robot.yaml\ntask: {trajectory: {hold: {}}}\n"
                                         "simulation: {duration_s: 1}\n";
  }

  std::string path(const std::string& name) const { return folder_.path() + "/" + name; }

  /// What it printed.
  std::string record(VirtualModule& module, std::deque<ScriptedAnswer> script) {
    CanTactileConfig config;
    config.first_id = 0x100;
    const auto answer = [&](std::string& line) {
      if (script.empty()) return false;
      line = script.front().line;
      module.load = script.front().load;
      module.growth_per_s = script.front().growth_per_s;
      script.pop_front();
      return true;
    };
    std::FILE* const out = std::fopen(path("said").c_str(), "w");
    recordPushes({{"can3", config},
                  "link4",
                  {100000.0, 0.38, 0.06},
                  module.source(),
                  answer,
                  out,
                  path("pushes.yaml"),
                  [&] {
                    if (!script.empty() && script.front().is_too_early) script.pop_front();
                  }});
    std::fclose(out);
    return folder_.content("said");
  }

  Json fit(std::vector<std::string> more = {}) {
    std::vector<std::string> words = {"calibrate", "fit", path("pushes.yaml"), path("scene.yaml"),
                                      "--json"};
    words.insert(words.end(), more.begin(), more.end());
    std::string output;
    EXPECT_EQ(runCommand(addCalibrateCommand, words, output), kExitDone);
    return Json::parse(output);
  }

  std::string refusal() {
    try {
      fit();
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  TactileChannels written() const {
    const Scene scene = loadScene(path("scene.yaml"), {{"controller.variant", "none"}});
    return scene.plant.modules.front().channels;
  }

  RunFolder folder_;
};

inline ScriptedAnswer held(const KnownPush& push) { return {"", wrenchOf(push), Wrench5::Zero()}; }

/// +-y and +-z at three places, as words or as vectors.
inline std::deque<ScriptedAnswer> scriptOf(Random& random, bool turns) {
  std::deque<ScriptedAnswer> script = {{""}};
  for (const double x_m : {0.04, 0.19, 0.34}) {
    for (const char* word : {"+y", "-y", "+z", "-z"}) {
      const double size_N = std::round(10.0 * random.uniform(2.0, 6.0)) / 10.0;
      KnownPush push{.position_m = x_m};
      (word[1] == 'y' ? push.force_y_N : push.force_z_N) = word[0] == '+' ? size_N : -size_N;
      std::string line = random.chance(0.5)
                             ? fmt::format("{} {} {}", size_N, word, x_m)
                             : fmt::format("0, {}, {}, {}", push.force_y_N, push.force_z_N, x_m);
      if (turns) {
        push.moment_x_Nm = std::round(100.0 * random.uniform(-0.3, 0.3)) / 100.0;
        line += fmt::format(" {}", push.moment_x_Nm);
      }
      script.push_back({line});
      script.push_back(held(push));
    }
  }
  script.push_back({""});
  return script;
}

}  // namespace tactus::test
