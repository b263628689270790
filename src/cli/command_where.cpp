#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactus/cli/commands.h"
#include "tactus/daemon/measured_start.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

struct WhereOptions {
  std::string scene;
  std::vector<std::string> settings;
  bool json = false;
};

std::string whereText(const Scene& scene, const JointVector& q) {
  std::string text = fmt::format("start: {}\n", startText(startAt(scene, q)));
  for (int joint = 0; joint < q.size(); ++joint) {
    const double start = scene.controller.q_start[joint];
    text += fmt::format("# {}: {:.4f} {}, {:+.4f} from where the scene begins{}\n",
                        escaped(scene.joint_names[joint]), q[joint],
                        unitOf(scene.controller.chain.type(joint)), q[joint] - start,
                        std::abs(q[joint] - start) > scene.hardware->start_tolerance
                            ? ": too far to start there"
                            : "");
  }
  return text;
}

Json whereJson(const Scene& scene, const JointVector& q) {
  Json joints = Json::array();
  for (int joint = 0; joint < q.size(); ++joint)
    joints.push_back({{"name", scene.joint_names[joint]},
                      {"position", q[joint]},  // as measured, also beyond a limit
                      {"start", scene.controller.q_start[joint]},
                      {"unit", unitOf(scene.controller.chain.type(joint))}});
  return {{"joints", joints}, {"start_tolerance", scene.hardware->start_tolerance}};
}

void tellWhere(const WhereOptions& options) {
  const Scene scene = loadHardwareScene(options.scene, options.settings, "to ask");
  const JointVector q = readJoints(scene);
  const std::string text = options.json ? jsonText(whereJson(scene, q)) : whereText(scene, q);
  std::fputs(text.c_str(), stdout);
}

}  // namespace

void addWhereCommand(CLI::App& app, int& exit_code) {
  CLI::App* const command =
      app.add_subcommand("where", "Where is the arm? Reads its drives, without moving them");
  const auto options = std::make_shared<WhereOptions>();
  command->add_option("SCENE", options->scene, "Scene file whose robot is asked")->required();
  command->add_option("--set", options->settings, kSetHelp)->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    tellWhere(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
