#include "tactus/run/scene_check.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tactus/record/log_size.h"
#include "tactus/run/clearance_check.h"
#include "tactus/run/contact_report.h"
#include "tactus/run/hardware_check.h"
#include "tactus/scene/bus_load_text.h"
#include "tactus/scene/key_words.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/path_check.h"

namespace tactus {
namespace {

StartPose computeStart(const ControllerConfig& config) {
  ChainPose pose;
  config.chain.computePose(config.q_start, pose);
  return {framePosition(pose, config.chain.tip()),
          smallestSingularValueAtStart(config, JointVector::Ones(config.chain.size()))};
}

std::vector<std::string> taskComponents(const TaskConfig& task) {
  std::vector<std::string> names;
  for (int i = 0; i < task.size; ++i) names.push_back(wordOf(kComponentWords, task.components[i]));
  return names;
}

Json jointJson(const Scene& scene, int i) {
  const ControllerConfig& config = scene.controller;
  const bool is_prismatic = config.chain.type(i) == JointType::kPrismatic;
  return {{"name", scene.joint_names[i]},
          {"type", is_prismatic ? "prismatic" : "revolute"},
          {"start", config.q_start[i]},
          {"lower", config.limits.lower[i]},
          {"upper", config.limits.upper[i]},
          {"max_velocity", config.limits.max_velocity[i]},
          {"max_acceleration", config.limits.max_acceleration[i]}};
}

Json busLoadJson(const std::string& interface, const BusLoad& load) {
  Json terms = Json::array();
  for (const BusLoadTerm& term : load.terms) {
    terms.push_back(
        {{"name", term.name},
         {"frames", term.frames},
         {"bits_a_frame", term.fd ? Json(term.bitsAFrame()) : Json(worstCaseBits(term.data_bytes))},
         {"period_s", term.period_s}});
  }
  return {{"interface", interface}, {"bit_rate_per_s", load.bit_rate_per_s},
          {"terms", terms},         {"bits_per_s", load.bitsPerSecond()},
          {"share", load.share()},  {"max_share", kMaxBusLoad}};
}

/// Nothing for a robot that only simulates.
void addHardware(const Scene& scene, Json& json) {
  if (!scene.hardware) return;
  json["hardware_stages"] = hardwareStageNames(*scene.hardware);
  const std::vector<BusLoad> loads = busLoads(*scene.hardware, scene.period_s);
  Json& buses = json["buses"] = Json::array();
  for (std::size_t i = 0; i < loads.size(); ++i)
    buses.push_back(busLoadJson(scene.hardware->buses[i].interface, loads[i]));
}

Json stabilityJson(const Scene& scene, const StabilityReport& stability) {
  Json loops = Json::array();
  for (const LoopReport& loop : stability.loops) {
    Json json = {{"name", loop.name},
                 {"largest_stiffness_ratio", loop.margins.largest_stiffness_ratio},
                 {"gain_margin", loop.margins.gain_margin},
                 {"phase_margin_deg", loop.phaseMargin_deg()}};
    // An infinite one is null in JSON, as any other number without an end.
    if (loop.ratio_with_gears) json["largest_stiffness_ratio_with_gears"] = *loop.ratio_with_gears;
    loops.push_back(std::move(json));
  }
  return {{"stiffest_N_per_m", stability.stiffest_N_per_m},
          {"stiffness_N_per_m", stability.stiffness_N_per_m},
          {"stiffness_ratio", stability.ratio()},
          {"tactile_module", scene.module_links[stability.module]},
          {"gear_mode_hz", stability.gear_mode_hz ? Json(*stability.gear_mode_hz) : Json()},
          {"loops", loops}};
}

/// The scene first, then what it extends, the robot, what its drives name, the URDF.
std::vector<std::string> filesOf(const Scene& scene) {
  std::vector<std::string> paths;
  for (const SourceFile& file : scene.sources) paths.push_back(escaped(file.path));
  return paths;
}

std::string gearsText(const Scene& scene, const StabilityReport& stability) {
  if (!stability.gear_mode_hz)
    return textLine("gears", "rigid in these margins: flexible ones take about half of them");
  std::string text = fmt::format("rigid in these margins; the arm's, {:.3g} Hz at the start",
                                 *stability.gear_mode_hz);
  for (const LoopReport& loop : stability.loops)
    if (loop.ratio_with_gears)
      text += fmt::format(", {}{} stable to c_e/c = {:.3g}", loop.name,
                          ofModule(scene, loop.module_with_gears), *loop.ratio_with_gears);
  return textLine("gears", text);
}

std::string stabilityText(const Scene& scene, const StabilityReport& stability) {
  std::string text =
      textLine("contact", fmt::format("up to c_e = {:g} N/m, taken for c = {:g} N/m",
                                      stability.stiffest_N_per_m, stability.stiffness_N_per_m));
  for (const LoopReport& loop : stability.loops) {
    const StabilityMargins& margins = loop.margins;
    text += textLine(
        &loop == &stability.loops.front() ? "margins" : "",
        fmt::format(
            "{}{}: stable to c_e/c = {:.4g}; here gain {:.3g} ({:.3g} dB), phase {:.3g} deg",
            loop.name, ofModule(scene, stability.module), margins.largest_stiffness_ratio,
            margins.gain_margin, 20.0 * std::log10(margins.gain_margin), loop.phaseMargin_deg()));
  }
  if (!stability.loops.empty()) text += gearsText(scene, stability);
  return text;
}

}  // namespace

Findings examine(const Scene& scene) {
  Findings findings{computeStart(scene.controller),
                    coversAtStart(scene),
                    checkStability(scene),
                    {},
                    checkArm(scene)};
  if (findings.stability) addGearMargins(scene, *findings.stability);
  const auto add = [&](const std::vector<std::string>& more) {
    findings.warnings.insert(findings.warnings.end(), more.begin(), more.end());
  };
  add(checkMachine(scene));
  add(checkPath(scene));
  const StabilityReport stability = findings.stability.value_or(StabilityReport{});
  findings.contact = checkContacts(scene, stability.stiffest_N_per_m);
  add(stability.warnings);
  add(findings.contact.warnings);
  if (!scene.troubles.empty())
    findings.warnings.emplace_back(
        "simulation.troubles happen on the buses of tactus plant alone, not in tactus simulate");
  checkLogSize(scene);
  return findings;
}

std::string checkText(const Scene& scene, const Findings& findings) {
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
  text += coversText(findings.covers);
  text += clearanceText(scene);
  if (findings.stability) text += stabilityText(scene, *findings.stability);
  text += contactText(scene, findings.contact);
  for (const std::string& warning : findings.warnings) line("warning", warning);
  if (!scene.hardware) return text;
  line("hardware", fmt::format("{}", fmt::join(hardwareStageNames(*scene.hardware), ", ")));
  const std::vector<BusLoad> loads = busLoads(*scene.hardware, scene.period_s);
  for (std::size_t i = 0; i < loads.size(); ++i) {
    line(scene.hardware->buses[i].interface + " ", describeBusLoad(loads[i], scene.period_s));
  }
  return text;
}

Json checkJson(const Scene& scene, const Findings& findings) {
  const Vector3& tool = findings.start.p_BaseTool;
  Json joints = Json::array();
  for (int i = 0; i < scene.controller.chain.size(); ++i) joints.push_back(jointJson(scene, i));
  Json json = {{"scene", scene.name},
               {"robot", scene.robot_name},
               {"files", filesOf(scene)},
               {"variant", scene.variant},
               {"stages", stageNames(scene.controller)},
               {"period_s", scene.period_s},
               {"duration_s", scene.duration_s},
               {"task", taskComponents(scene.controller.task)},
               {"joints", joints},
               {"tool_start_m", {tool.x(), tool.y(), tool.z()}},
               {"smallest_singular_value_at_start", findings.start.smallest_singular_value},
               {"covers", coversJson(findings.covers)},
               {"warnings", findings.warnings}};
  if (findings.stability) json["stability"] = stabilityJson(scene, *findings.stability);
  addContact(scene, findings.contact, json);
  addClearance(scene, json);
  addHardware(scene, json);
  return json;
}

}  // namespace tactus
