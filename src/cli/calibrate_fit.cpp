#include "tactus/cli/calibrate_fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "tactus/cli/wrench_rows.h"
#include "tactus/record/output_file.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/scene_loader.h"
#include "tactus/scene/tactile_loader.h"
#include "tactus/scene/yaml_rows.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {
namespace {

constexpr double kLargestEntry = 1e3;  ///< of a calibration, as robot.yaml takes it

[[noreturn]] void refusePushes(const PushFile& file, const std::string& problem,
                               const std::string& expectation) {
  failAt(beginOf(file.path), "records", problem, "expected " + expectation);
}

/// Why the pushes do not tell a row.
std::string untoldText(int row) {
  const char* const name = kWrenchRows[static_cast<std::size_t>(row)].name;
  if (row != 2 && row != 3) return fmt::format("the pushes hardly tell {}", name);
  return fmt::format("the pushes along {} are all at one place along the cover and hardly tell {}",
                     row == 2 ? "z" : "y", name);
}

void judgeProblem(const PushFile& file, const CalibrationFit& fit) {
  switch (fit.problem) {
    case CalibrationProblem::kNone:
      return;
    case CalibrationProblem::kTooFew:
      refusePushes(file, fmt::format("{} pushes do not tell {} rows", file.pushes.size(), fit.rows),
                   fmt::format("{} or more: along y and along z, each near both ends of the cover",
                               fit.rows));
    case CalibrationProblem::kPushesAlike:
      refusePushes(
          file,
          fmt::format("{}: condition {:.3g}", untoldText(fit.weakest_row), fit.pushes_condition),
          fmt::format("at most {:g}: pushes along y and along z, each near both ends{}",
                      kMaxPushesCondition,
                      fit.rows == 5 ? ", with moments about x that differ" : ""));
    case CalibrationProblem::kChannelsAlike:
      refusePushes(file,
                   fmt::format("the channels say the same of different pushes: condition {:.3g}",
                               fit.channels_condition),
                   fmt::format("at most {:g}: cells that are all connected and loaded",
                               kMaxChannelsCondition));
  }
}

std::string placeText(double position_m) {
  return std::isfinite(position_m) ? fmt::format("{:.1f} mm", 1e3 * std::abs(position_m))
                                   : "no place";
}

void judgeWorst(const PushFile& file, const CalibrationFit& fit) {
  const int wrong = wrongPush(fit);
  if (wrong < 0) return;
  const auto pushAt = [&](int push) { return file.pushes[static_cast<std::size_t>(push)].at; };
  const PushResidual& off = *fit.left_out[static_cast<std::size_t>(wrong)];
  const bool is_clear = wrong != fit.worst || fit.or_worst < 0;
  failAt(
      pushAt(wrong), "records",
      fmt::format("this push{} is off what the others say by {:.3g} N and {}, {:.0f} % of it",
                  is_clear ? "" : fmt::format(", or that of line {},", pushAt(fit.or_worst).line),
                  off.force_N, placeText(off.position_m), 100.0 * off.share),
      fmt::format("expected at most {:g} %: push again, or delete the entry",
                  100.0 * kMaxLeftOutShare));
}

void judgeSize(const PushFile& file, const CalibratedModule& module, const CalibrationFit& fit) {
  const double largest = fit.calibration.cwiseAbs().maxCoeff();
  if (largest <= kLargestEntry) return;
  refusePushes(file,
               fmt::format("with counts_per_N = {:g} the calibration has an entry of {:.3g}",
                           module.counts_per_N, largest),
               fmt::format("at most {:g}: counts_per_N near {:.2g} in robot.yaml", kLargestEntry,
                           module.counts_per_N / largest));
}

std::vector<std::string> rowTexts(const CalibrationFit& fit) {
  std::vector<std::string> rows;
  for (int row = 0; row < fit.rows; ++row) {
    std::vector<std::string> words;
    for (const double entry : fit.calibration.row(row))
      words.push_back(fmt::format("{:.7g}", entry));
    rows.push_back(fmt::format("[{}]", fmt::join(words, ", ")));
  }
  return rows;
}

std::string pushText(const KnownPush& push) {
  std::string text =
      fmt::format("({:g}, {:g}) N at {:g} m", push.force_y_N, push.force_z_N, push.position_m);
  if (push.moment_x_Nm != 0.0) text += fmt::format(", {:g} Nm", push.moment_x_Nm);
  return text;
}

std::string residualText(const PushResidual& residual) {
  return fmt::format("{:.3g} N, {}", residual.force_N, placeText(residual.position_m));
}

/// Of the pushes that no other ones tell: a slip of the pen would not show.
std::vector<int> uncheckedLines(const PushFile& file, const CalibrationFit& fit) {
  std::vector<int> lines;
  for (std::size_t i = 0; i < file.pushes.size(); ++i)
    if (!fit.left_out[i]) lines.push_back(file.pushes[i].at.line);
  return lines;
}

std::string uncheckedText(const std::vector<int>& lines) {
  return lines.size() == 1 ? fmt::format("line {} is checked by nothing", lines.front())
                           : fmt::format("lines {} are checked by nothing", fmt::join(lines, ", "));
}

void judgeUnchecked(const PushFile& file, const CalibrationFit& fit) {
  const std::vector<int> lines = uncheckedLines(file, fit);
  if (!lines.empty())
    refusePushes(file, uncheckedText(lines) + ", so nothing is written",
                 "one more push of each of these kinds");
}

std::string worstText(const PushFile& file, const CalibrationFit& fit) {
  std::string text;
  if (const int push = farthestPush(fit); push >= 0) {
    const auto worst = static_cast<std::size_t>(push);
    text = fmt::format(
        "worst      line {}: {:.1f} % off what the others say, refused above {:g} %\n",
        file.pushes[worst].at.line, 100.0 * fit.left_out[worst]->share, 100.0 * kMaxLeftOutShare);
  }
  const std::vector<int> lines = uncheckedLines(file, fit);
  if (!lines.empty()) text += "unchecked  " + uncheckedText(lines) + ": one more of each\n";
  return text;
}

Json residualJson(const PushResidual& residual) {
  return {{"force_N", residual.force_N},
          {"position_m", residual.position_m},
          {"share", residual.share}};
}

/// What is written has to be read as what was found.
void checkWritten(const Scene& scene, const SceneModule& module, const std::string& path,
                  const std::string& text, const CalibrationFit& fit) {
  std::vector<SourceFile> sources = scene.sources;
  sources[scene.scene_sources].text = text;
  const Scene read = loadScene(sources, scene.overrides, SceneUse::kSimulation);
  const TactileChannels channels = sceneModule(read, module.index).channels;
  Eigen::Matrix<double, 5, 8> rows;
  rows << channels.calibration, channels.moment_x.value_or(TactileChannelRow::Zero());
  const double off = (rows - fit.calibration).cwiseAbs().maxCoeff();
  if (!(off <= 1e-6 * fit.calibration.cwiseAbs().maxCoeff()))
    throw RunError(escaped(path) + ": calibration could not be written");
}

}  // namespace

SceneModule sceneModule(const Scene& scene, std::size_t index) {
  const TactileModuleConfig& config = scene.controller.tactile_modules[index];
  const TactileChannels& channels = scene.plant.modules[index].channels;
  return {index,
          scene.module_links[index],
          {channels.counts_per_N, config.length_m, config.cover_radius_m},
          channels};
}

SceneModule sceneModule(const Scene& scene, const PushFile& file) {
  const auto found = std::ranges::find(scene.module_links, file.link);
  if (found == scene.module_links.end())
    failAt(beginOf(file.path), "module",
           inQuotes(file.link) + " has no tactile module in " + escaped(scene.sources.front().path),
           fmt::format("expected one of {}",
                       escaped(fmt::format("{}", fmt::join(scene.module_links, ", ")))));
  return sceneModule(scene, static_cast<std::size_t>(found - scene.module_links.begin()));
}

CalibrationFit fitPushes(const PushFile& file, const CalibratedModule& module) {
  for (const RecordedPush& recorded : file.pushes) {
    if (recorded.push.position_m <= module.length_m) continue;
    failAt(recorded.at, "position_m",
           fmt::format("{:g} m is not on the cover", recorded.push.position_m),
           fmt::format("expected 0 to {:g} m", module.length_m));
  }
  CalibrationFit fit = fitCalibration(pushesOf(file), module, file.sigma);
  judgeProblem(file, fit);
  judgeWorst(file, fit);
  judgeSize(file, module, fit);
  return fit;
}

std::string fitText(const PushFile& file, const SceneModule& module, const CalibrationFit& fit) {
  std::string text = fmt::format(
      "module     {}, {} pushes\nconditions pushes {:.3g} (at most {:g}), channels {:.3g} (at most "
      "{:g})\n{:<36}{:<26}{}\n",
      escaped(module.link), file.pushes.size(), fit.pushes_condition, kMaxPushesCondition,
      fit.channels_condition, kMaxChannelsCondition, "push", "off by", "off the others by");
  for (std::size_t i = 0; i < file.pushes.size(); ++i) {
    const std::string name =
        fmt::format("line {}: {}", file.pushes[i].at.line, pushText(file.pushes[i].push));
    const std::string alone = fit.left_out[i] ? residualText(*fit.left_out[i]) : "they do not tell";
    text += fmt::format("{:<36}{:<26}{}\n", name, residualText(fit.residuals[i]), alone);
  }
  text += worstText(file, fit) + "noise      ";
  for (int row = 0; row < fit.rows; ++row)
    text += fmt::format("{}{} {:.2g} {}", row > 0 ? ", " : "", kWrenchRows[row].name,
                        fit.noise[row], kWrenchRows[row].unit);
  text += fmt::format("\ncounts_per_N: {:g}\ncalibration:\n", module.shape.counts_per_N);
  const std::vector<std::string> rows = rowTexts(fit);
  for (std::size_t row = 0; row < rows.size(); ++row)
    text += fmt::format("  - {}  # {}\n", rows[row], kWrenchRows[row].comment);
  return text;
}

Json fitJson(const PushFile& file, const SceneModule& module, const CalibrationFit& fit) {
  Json pushes = Json::array(), calibration = Json::array(), noise = Json::object();
  for (std::size_t i = 0; i < file.pushes.size(); ++i) {
    const KnownPush& push = file.pushes[i].push;
    pushes.push_back({{"line", file.pushes[i].at.line},
                      {"force_N", {0.0, push.force_y_N, push.force_z_N}},
                      {"position_m", push.position_m},
                      {"moment_x_Nm", push.moment_x_Nm},
                      {"residual", residualJson(fit.residuals[i])},
                      {"left_out", fit.left_out[i] ? residualJson(*fit.left_out[i]) : Json()}});
  }
  for (int row = 0; row < fit.rows; ++row) {
    const Eigen::Matrix<double, 1, 8> entries = fit.calibration.row(row);
    calibration.push_back(std::vector<double>(entries.data(), entries.data() + 8));
    noise[fmt::format("{}_{}", kWrenchRows[row].name, kWrenchRows[row].unit)] = fit.noise[row];
  }
  const int farthest = farthestPush(fit);
  const Json worst =
      farthest < 0 ? Json() : Json(file.pushes[static_cast<std::size_t>(farthest)].at.line);
  return {{"tactile_module", module.link},
          {"counts_per_N", module.shape.counts_per_N},
          {"calibration", calibration},
          {"pushes_condition", fit.pushes_condition},
          {"channels_condition", fit.channels_condition},
          {"noise", noise},
          {"worst_line", worst},
          {"unchecked_lines", uncheckedLines(file, fit)},
          {"pushes", pushes}};
}

std::string writeCalibration(const Scene& scene, const SceneModule& module, const PushFile& file,
                             const CalibrationFit& fit) {
  judgeUnchecked(file, fit);
  const SourceFile& robot = scene.sources[scene.scene_sources];
  const YamlNode root = parseYaml(robot);
  const std::string key = moduleKey(root, module.index) + ".calibration";
  if (module.channels.moment_x && fit.rows < 5)
    failAt(locate(root, key), key, "has a row of M_x, and no push has a moment about x",
           "expected pushes with moment_x_Nm, or no such row");
  const std::string text = withRows(robot, key, rowTexts(fit), kWrenchRows[4].comment);
  replaceFile(robot.path, text,
              [&](const std::string&) { checkWritten(scene, module, robot.path, text, fit); });
  return robot.path;
}

}  // namespace tactus
