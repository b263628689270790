#include "tactus/cli/commission_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "tactus/record/output_file.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/yaml_edit.h"
#include "tactus/scene/yaml_tree.h"
#include "tactus/scene/yaml_word.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

constexpr double kOffsetDigit = 1e-7;  ///< m or rad
constexpr double kLagDigit_s = 1e-4;

std::string tidy(double value, double digit) {
  return fmt::format("{}", std::round(value / digit) * digit == 0.0
                               ? 0.0
                               : std::round(value / digit) / std::round(1.0 / digit));
}

const char* unitOfJoint(const Scene& scene, int joint) {
  return unitOf(scene.controller.chain.type(joint));
}

/// "drives.joints[2]" of a joint, by its name. The file was loaded, so it is there.
std::string entryOf(const Scene& scene, const SourceFile& robot, int joint) {
  const YamlNode root = parseYaml(robot);
  const YamlNode* const list = findGiven(root, "drives.joints");
  for (std::size_t i = 0; list && i < list->items.size(); ++i) {
    const YamlNode* const name = list->items[i].find("joint");
    if (name && name->text == scene.joint_names[joint]) return fmt::format("drives.joints[{}]", i);
  }
  failAt(root.at, "drives.joints", "has no entry of " + inQuotes(scene.joint_names[joint]),
         "expected one");
}

const DriveConfig& driveOf(const Scene& scene, int joint) {
  return scene.hardware->drives[static_cast<std::size_t>(joint)];
}

/// The name under which a text was written, to be renamed: on the disk, so that a loss of power
/// leaves what was there, or this.
std::string writtenBeside(const std::string& path, const std::string& text) {
  OutputFile file(path + ".next");
  file.append(text);
  file.sync();
  file.close();
  return path + ".next";
}

/// bus and node of one joint's entry, where they are others.
std::string withPlace(const Scene& scene, SourceFile file, int joint, int bus, int node_id) {
  const DriveConfig& given = driveOf(scene, joint);
  const std::string entry = entryOf(scene, file, joint);
  const auto& buses = scene.hardware->buses;
  if (given.bus != bus)
    file.text = withValue(file, entry + ".interface",
                          yamlWord(buses[static_cast<std::size_t>(bus)].interface));
  if (given.node_id != node_id)
    file.text = withValue(file, entry + ".node_id", std::to_string(node_id));
  return file.text;
}

/// Of all joints: what is known; where that is another joint's place in the file, they change
/// places. So no bus is empty or overloaded that would not be with all that is known.
std::vector<JointPlace> placesOf(const Scene& scene, const JointFindings& found) {
  std::vector<JointPlace> places;
  for (const DriveConfig& drive : scene.hardware->drives)
    places.push_back({drive.joint, drive.bus, drive.node_id});
  const auto put = [&places](const JointPlace& known) {
    JointPlace& own = *std::ranges::find(places, known.joint, &JointPlace::joint);
    const JointPlace before = own;
    const auto other = std::ranges::find_if(places, [&](const JointPlace& place) {
      return place.bus == known.bus && place.node_id == known.node_id;
    });
    if (other != places.end()) *other = {other->joint, before.bus, before.node_id};
    own = known;
  };
  for (const JointPlace& known : found.places) put(known);
  put({found.joint, found.bus, found.node_id});
  return places;
}

}  // namespace

const SourceFile& robotFile(const Scene& scene) { return scene.sources[scene.scene_sources]; }

std::string withFindings(const Scene& scene, const SourceFile& robot, const JointFindings& found) {
  SourceFile file = robot;
  const DriveConfig& given = driveOf(scene, found.joint);
  for (const JointPlace& place : placesOf(scene, found))
    file.text = withPlace(scene, file, place.joint, place.bus, place.node_id);
  const std::string entry = entryOf(scene, file, found.joint);
  const std::string unit = unitOfJoint(scene, found.joint);
  const JointScale& scale = found.scale;
  if (given.counts_per_unit != scale.counts_per_unit)
    file.text =
        withValue(file, entry + ".counts_per_" + unit, fmt::format("{}", scale.counts_per_unit));
  const std::string offset = tidy(scale.offset, kOffsetDigit);
  if (offset != tidy(given.offset, kOffsetDigit))
    file.text = withValue(file, entry + ".offset_" + unit, offset);
  if (given.sign != scale.sign)
    file.text = withValue(file, entry + ".sign", std::to_string(scale.sign));
  return file.text;
}

std::string withLag(const SourceFile& robot, double lag_s) {
  return withValue(robot, "drives.position_lag_s", tidy(std::clamp(lag_s, 0.0, 1.0), kLagDigit_s));
}

Scene withRobot(const Scene& scene, const std::string& text) {
  std::vector<SourceFile> files = scene.sources;
  files[scene.scene_sources].text = text;
  return loadScene(files, scene.overrides);
}

/// By the longest common subsequence; robots' files are short.
std::string differenceText(const std::string& before, const std::string& after) {
  const auto linesOf = [](const std::string& text) {
    std::vector<std::string> lines;
    for (std::size_t at = 0; at < text.size();) {
      const std::size_t end = std::min(text.find('\n', at), text.size());
      lines.push_back(text.substr(at, end - at));
      at = end + 1;
    }
    return lines;
  };
  const auto old_lines = linesOf(before), new_lines = linesOf(after);
  const std::size_t n = old_lines.size(), m = new_lines.size();
  std::vector<std::vector<int>> common(n + 1, std::vector<int>(m + 1, 0));
  for (std::size_t i = n; i-- > 0;)
    for (std::size_t k = m; k-- > 0;)
      common[i][k] = old_lines[i] == new_lines[k] ? common[i + 1][k + 1] + 1
                                                  : std::max(common[i + 1][k], common[i][k + 1]);
  std::string text;
  for (std::size_t i = 0, k = 0; i < n || k < m;) {
    if (i < n && k < m && old_lines[i] == new_lines[k]) {
      ++i;
      ++k;
    } else if (k == m || (i < n && common[i + 1][k] >= common[i][k + 1])) {
      text += "- " + escaped(old_lines[i++]) + "\n";
    } else {
      text += "+ " + escaped(new_lines[k++]) + "\n";
    }
  }
  return text;
}

/// Tried, as permissions do not tell of a file system that is read-only.
void refuseUnwritable(const SourceFile& robot) {
  const std::string target = fs::canonical(robot.path).string();  // of a link, as it is written
  for (const std::string& path : {target, statePath(robot)}) fs::remove(writtenBeside(path, ""));
  const std::string copy = target + "~";
  if (fs::exists(copy) && !std::ofstream(copy, std::ios::app))
    throw InputError(fmt::format("{}: cannot be written, expected a file that can", escaped(copy)));
}

void writeRobot(const SourceFile& robot, bool keeps_copy) {
  if (keeps_copy) return replaceFile(robot.path, robot.text);
  replaceWithoutCopy(robot.path, robot.text);
}

std::string statePath(const SourceFile& robot) { return robot.path + ".commission.json"; }

Json readState(const std::string& path) {
  if (!fs::exists(path)) return Json::object();
  const std::string text = SourceReader(readFromDisk).readFirst(path).text;
  const Json state = Json::parse(text, nullptr, false);
  const bool is_ours =
      state.is_object() && state.contains("joints") && state.at("joints").is_object();
  if (!is_ours)
    throw InputError(
        fmt::format("{}:1:1: joints: is no state of a commissioning, expected one, or no such file",
                    escaped(path)));
  return state;
}

void writeState(const std::string& path, const Json& state) {
  fs::rename(writtenBeside(path, jsonText(state)), path);
}

Json stateOf(const Scene& scene, const JointFindings& found) {
  const std::string unit = unitOfJoint(scene, found.joint);
  Json json = {
      {"interface", scene.hardware->buses[static_cast<std::size_t>(found.bus)].interface},
      {"node_id", found.node_id},
      {"sign", found.scale.sign},
      {"counts_per_" + unit, found.scale.counts_per_unit},
      {"counts_uncertainty", found.scale.uncertainty},
      {"offset_" + unit, found.scale.offset},
      {"misfit_" + unit, found.misfit},
      {"lag_s", found.lag_s},
      {"following_error_" + unit, found.following_error},
      {"acceleration_" + unit + "_per_s2", found.acceleration},
  };
  if (found.lower) json["lower_" + unit] = *found.lower;
  if (found.upper) json["upper_" + unit] = *found.upper;
  return json;
}

bool isFinished(const Scene& scene, const Json& state, int joint) {
  if (!state.contains("joints")) return false;
  const auto entry = state.at("joints").find(scene.joint_names[joint]);
  if (entry == state.at("joints").end() || !entry->is_object()) return false;
  const DriveConfig& drive = driveOf(scene, joint);
  const std::string unit = unitOfJoint(scene, joint);
  const auto is = [&](const std::string& name, double value, double tolerance) {
    const auto found = entry->find(name);
    return found != entry->end() && found->is_number() &&
           std::abs(found->get<double>() - value) <= tolerance;
  };
  const std::string& interface =
      scene.hardware->buses[static_cast<std::size_t>(drive.bus)].interface;
  return entry->value("interface", Json()) == interface && is("node_id", drive.node_id, 0.0) &&
         is("sign", drive.sign, 0.0) &&
         is("counts_per_" + unit, drive.counts_per_unit, 1e-8 * drive.counts_per_unit) &&
         is("offset_" + unit, drive.offset, kOffsetDigit);
}

}  // namespace tactus
