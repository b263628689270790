#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <memory>

#include "tactus/cli/commands.h"
#include "tactus/record/log_size.h"
#include "tactus/scene/bus_load_text.h"
#include "tactus/scene/command_scene.h"
#include "tactus/scene/json.h"
#include "tactus/scene/key_words.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/path_check.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

struct CheckOptions {
  std::string scene;
  std::vector<std::string> settings;
  bool json = false;
};

/// Where a run starts.
struct StartPose {
  Vector3 p_BaseTool;              ///< m
  double smallest_singular_value;  ///< of the task's Jacobian; 0: the task cannot be controlled
};

/// What was found about a scene that is accepted.
struct Findings {
  StartPose start;
  std::optional<StabilityReport> stability;
  std::vector<std::string> warnings;  ///< of the path, then of the stability
};

StartPose computeStart(const ControllerConfig& config) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  return {framePosition(pose, config.chain.tip()),
          smallestSingularValueAtStart(config, JointVector::Ones(config.chain.size()))};
}

Findings examine(const Scene& scene) {
  Findings findings{computeStart(scene.controller), checkStability(scene), checkPath(scene)};
  if (!findings.stability) return findings;
  const std::vector<std::string>& more = findings.stability->warnings;
  findings.warnings.insert(findings.warnings.end(), more.begin(), more.end());
  return findings;
}

std::vector<std::string> taskComponents(const TaskConfig& task) {
  std::vector<std::string> names;
  for (int i = 0; i < task.size; ++i) names.push_back(wordOf(kComponentWords, task.components[i]));
  return names;
}

void writeNames(JsonWriter& json, const char* key, const std::vector<std::string>& names) {
  json.key(key).beginArray();
  for (const std::string& name : names) json.value(name);
  json.endArray();
}

void writeJoint(JsonWriter& json, const Scene& scene, int i) {
  const ControllerConfig& config = scene.controller;
  const bool is_prismatic = config.chain.type(i) == JointType::kPrismatic;
  json.beginObject();
  json.key("name").value(scene.joint_names[i]);
  json.key("type").value(is_prismatic ? "prismatic" : "revolute");
  json.key("start").value(config.q_start[i]);
  json.key("lower").value(config.limits.lower[i]);
  json.key("upper").value(config.limits.upper[i]);
  json.key("max_velocity").value(config.limits.max_velocity[i]);
  json.key("max_acceleration").value(config.limits.max_acceleration[i]);
  json.endObject();
}

void writeBusLoad(JsonWriter& json, const std::string& interface, const BusLoad& load) {
  json.beginObject();
  json.key("interface").value(interface);
  json.key("bit_rate_per_s").value(load.bit_rate_per_s);
  json.key("terms").beginArray();
  for (const BusLoadTerm& term : load.terms) {
    json.beginObject();
    json.key("name").value(term.name);
    json.key("frames").value(term.frames);
    json.key("bits_a_frame").value(worstCaseBits(term.data_bytes));
    json.key("period_s").value(term.period_s);
    json.endObject();
  }
  json.endArray();
  json.key("bits_per_s").value(load.bitsPerSecond());
  json.key("share").value(load.share());
  json.key("max_share").value(kMaxBusLoad);
  json.endObject();
}

/// Nothing for a robot that only simulates.
void writeHardware(JsonWriter& json, const Scene& scene) {
  if (!scene.hardware) return;
  writeNames(json, "hardware_stages", hardwareStageNames(*scene.hardware));
  const std::vector<BusLoad> loads = busLoads(*scene.hardware, scene.period_s);
  json.key("buses").beginArray();
  for (std::size_t i = 0; i < loads.size(); ++i) {
    writeBusLoad(json, scene.hardware->buses[i].interface, loads[i]);
  }
  json.endArray();
}

/// Nothing for a scene without force control.
void writeStability(JsonWriter& json, const std::optional<StabilityReport>& stability) {
  if (!stability) return;
  json.key("stability").beginObject();
  json.key("stiffest_N_per_m").value(stability->stiffest_N_per_m);
  json.key("stiffness_N_per_m").value(stability->stiffness_N_per_m);
  json.key("stiffness_ratio").value(stability->ratio());
  json.key("loops").beginArray();
  for (const LoopReport& loop : stability->loops) {
    json.beginObject();
    json.key("name").value(loop.name);
    json.key("largest_stiffness_ratio").value(loop.margins.largest_stiffness_ratio);
    json.key("gain_margin").value(loop.margins.gain_margin);
    json.key("phase_margin_deg").value(loop.phaseMargin_deg());
    json.endObject();
  }
  json.endArray();
  json.endObject();
}

/// The scene first, then what it extends, the robot, the URDF.
std::vector<std::string> filesOf(const Scene& scene) {
  std::vector<std::string> paths;
  for (const SourceFile& file : scene.sources) paths.push_back(escaped(file.path));
  return paths;
}

std::string checkJson(const Scene& scene, const Findings& findings) {
  JsonWriter json;
  json.beginObject();
  json.key("scene").value(scene.name);
  json.key("robot").value(scene.robot_name);
  writeNames(json, "files", filesOf(scene));
  json.key("variant").value(scene.variant);
  writeNames(json, "stages", stageNames(scene.controller));
  json.key("period_s").value(scene.period_s);
  json.key("duration_s").value(scene.duration_s);
  writeNames(json, "task", taskComponents(scene.controller.task));
  json.key("joints").beginArray();
  for (int i = 0; i < scene.controller.chain.size(); ++i) writeJoint(json, scene, i);
  json.endArray();
  json.key("tool_start_m").beginArray();
  for (const double x : findings.start.p_BaseTool) json.value(x);
  json.endArray();
  json.key("smallest_singular_value_at_start").value(findings.start.smallest_singular_value);
  writeNames(json, "warnings", findings.warnings);
  writeStability(json, findings.stability);
  writeHardware(json, scene);
  json.endObject();
  return json.text();
}

std::string textLine(const std::string& name, const std::string& value) {
  return fmt::format("{:<9}{}\n", name, value);
}

std::string stabilityText(const StabilityReport& stability) {
  std::string text =
      textLine("contact", fmt::format("up to c_e = {:g} N/m, taken for c = {:g} N/m",
                                      stability.stiffest_N_per_m, stability.stiffness_N_per_m));
  for (const LoopReport& loop : stability.loops) {
    const StabilityMargins& margins = loop.margins;
    text += textLine(
        &loop == &stability.loops.front() ? "margins" : "",
        fmt::format("{}: stable to c_e/c = {:.4g}; here gain {:.3g} ({:.3g} dB), phase {:.3g} deg",
                    loop.name, margins.largest_stiffness_ratio, margins.gain_margin,
                    20.0 * std::log10(margins.gain_margin), loop.phaseMargin_deg()));
  }
  return text;
}

std::string toText(const Scene& scene, const Findings& findings) {
  const TaskConfig& task = scene.controller.task;
  const StartPose& start = findings.start;
  std::string text;
  const auto line = [&](const std::string& name, const std::string& value) {
    text += textLine(name, value);
  };
  line("scene", scene.name);
  line("robot", fmt::format("{}, {} joints: {}", scene.robot_name, scene.joint_names.size(),
                            fmt::join(scene.joint_names, " ")));
  line("files", fmt::format("{}", fmt::join(filesOf(scene), ", ")));
  line("variant", scene.variant);
  line("stages", fmt::format("{}", fmt::join(stageNames(scene.controller), ", ")));
  line("run", fmt::format("{} s, a cycle every {} s", scene.duration_s, scene.period_s));
  line("task", fmt::format("{}", fmt::join(taskComponents(task), " ")));
  line("start", fmt::format("tool at ({:.4f}, {:.4f}, {:.4f}) m, smallest singular value {:.3g}",
                            start.p_BaseTool.x(), start.p_BaseTool.y(), start.p_BaseTool.z(),
                            start.smallest_singular_value));
  if (findings.stability) text += stabilityText(*findings.stability);
  for (const std::string& warning : findings.warnings) line("warning", warning);
  if (!scene.hardware) return text;
  line("hardware", fmt::format("{}", fmt::join(hardwareStageNames(*scene.hardware), ", ")));
  const std::vector<BusLoad> loads = busLoads(*scene.hardware, scene.period_s);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    line(scene.hardware->buses[i].interface + " ", describeBusLoad(loads[i], scene.period_s));
  }
  return text;
}

void runCheck(const CheckOptions& options) {
  const Scene scene = loadScene(options.scene, parseOverrides(options.settings));
  const Findings findings = examine(scene);
  checkLogSize(scene);
  const std::string report = options.json ? checkJson(scene, findings) : toText(scene, findings);
  std::fputs(report.c_str(), stdout);
}

}  // namespace

void addCheckCommand(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("check", "Validate a scene and show what it consists of");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("scene", options->scene, "Scene file")->required();
  command->add_option("--set", options->settings, kSetHelp)->allow_extra_args(false);
  command->add_flag("--json", options->json, "Print JSON");
  command->callback([options, &exit_code] {
    runCheck(*options);
    exit_code = kExitDone;
  });
}

}  // namespace tactus
