#include "tactus/cli/push_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "tactus/scene/number_text.h"
#include "tactus/scene/source_reader.h"
#include "tactus/scene/yaml_tree.h"
#include "tactus/scene/yaml_word.h"

namespace tactus {
namespace {

constexpr double kLargestForce_N = 1e4;
constexpr double kLongestModule_m = 10.0;
constexpr double kMostCounts = 1e8;

/// A section of the file, with the keys that it may have.
class PushSection {
 public:
  PushSection(const YamlNode& node, std::string path, std::vector<std::string> keys)
      : node_(node), path_(std::move(path)) {
    if (node.kind != YamlNode::Kind::kMap)
      failAt(node.at, path_.empty() ? "-" : path_, describe(node), "expected a section");
    for (const YamlEntry& entry : node.entries) {
      if (std::ranges::count(keys, entry.key) > 0) continue;
      const std::string nearest = nearestWord(entry.key, keys);
      failAt(entry.key_at, pathOf(entry.key), "unknown key",
             nearest.empty() ? fmt::format("expected one of {}", fmt::join(keys, ", "))
                             : "expected perhaps " + nearest);
    }
  }

  std::string pathOf(std::string_view key) const {
    return path_.empty() ? std::string(key) : fmt::format("{}.{}", path_, key);
  }
  const YamlNode& node() const { return node_; }

  const YamlNode* find(std::string_view key) const { return node_.find(key); }

  const YamlNode& require(std::string_view key, const char* expectation) const {
    const YamlNode* const found = node_.find(key);
    if (!found) failAt(node_.at, pathOf(key), "is missing", std::string("expected ") + expectation);
    return *found;
  }

  double number(const YamlNode& node, const std::string& path, double lower, double upper) const {
    const bool is_plain = node.kind == YamlNode::Kind::kScalar && !node.quoted;
    const std::optional<double> value = is_plain ? finiteNumber(node.text) : std::nullopt;
    if (!value || *value < lower || *value > upper)
      failAt(node.at, path, describe(node) + (value ? " is out of range" : " is no number"),
             fmt::format("expected a number from {:g} to {:g}", lower, upper));
    return *value;
  }

  double number(std::string_view key, double lower, double upper) const {
    return number(require(key, "a number"), pathOf(key), lower, upper);
  }

  std::vector<double> numbers(std::string_view key, std::size_t count, double bound) const {
    const YamlNode& list = require(key, fmt::format("a list of {} numbers", count).c_str());
    if (list.kind != YamlNode::Kind::kList || list.items.size() != count)
      failAt(list.at, pathOf(key), describe(list),
             fmt::format("expected a list of {} numbers", count));
    std::vector<double> values;
    for (std::size_t i = 0; i < count; ++i)
      values.push_back(number(list.items[i], fmt::format("{}[{}]", pathOf(key), i), -bound, bound));
    return values;
  }

  ChannelVector channels(std::string_view key) const {
    return Eigen::Map<const ChannelVector>(numbers(key, 8, kMostCounts).data());
  }

 private:
  const YamlNode& node_;
  std::string path_;
};

ChannelFigures readFigures(const PushSection& section) {
  ChannelFigures figures;
  figures.mean = section.channels("mean_counts");
  figures.sigma = section.channels("sigma_counts");
  if (section.find("step_counts")) figures.step = section.number("step_counts", 1.0, kChannelEnd);
  if (figures.sigma.minCoeff() < 0.0)
    failAt(section.require("sigma_counts", "").at, section.pathOf("sigma_counts"), "is negative",
           "expected standard deviations");
  return figures;
}

/// One that stops says less than the force, and would be taken for a weaker cell.
void refuseDefect(const PushSection& section, const ChannelFigures& figures,
                  const ChannelFigures* zero) {
  const auto defect = figuresDefect(figures, zero);
  if (!defect) return;
  const auto channel = static_cast<std::size_t>(defect->channel);
  failAt(section.require("mean_counts", "").items[channel].at,
         fmt::format("{}[{}]", section.pathOf("mean_counts"), channel), defectText(*defect),
         zero ? "expected a smaller push, or no entry" : "expected another zero, and its pushes");
}

ChannelFigures readZero(const YamlNode& node, const std::string& path) {
  const PushSection section(
      node, path,
      {"duration_s", "mean_counts", "sigma_counts", "drift_counts_per_s", "step_counts"});
  ChannelFigures figures = readFigures(section);
  figures.duration_s = section.number("duration_s", 0.0, 1e6);
  if (section.find("drift_counts_per_s"))
    figures.drift_per_s = section.channels("drift_counts_per_s");
  refuseDefect(section, figures, nullptr);
  return figures;
}

RecordedPush readPush(const YamlNode& node, const std::string& path, const ChannelFigures& zero) {
  const PushSection section(
      node, path,
      {"force_N", "position_m", "moment_x_Nm", "mean_counts", "sigma_counts", "step_counts"});
  RecordedPush recorded{{}, node.at};
  const std::vector<double> force_N = section.numbers("force_N", 3, kLargestForce_N);
  if (force_N[0] != 0.0)
    failAt(section.require("force_N", "").at, section.pathOf("force_N"),
           fmt::format("{:g} N along the link, which no module tells", force_N[0]),
           "expected [0, F_y, F_z] in the link's frame");
  KnownPush& push = recorded.push;
  push.force_y_N = force_N[1];
  push.force_z_N = force_N[2];
  push.position_m = section.number("position_m", 0.0, kLongestModule_m);
  if (section.find("moment_x_Nm"))
    push.moment_x_Nm = section.number("moment_x_Nm", -kLargestForce_N, kLargestForce_N);
  if (push.force_y_N == 0.0 && push.force_z_N == 0.0 && push.moment_x_Nm == 0.0)
    failAt(node.at, section.pathOf("force_N"), "there is no force", "expected one");
  const ChannelFigures figures = readFigures(section);
  refuseDefect(section, figures, &zero);
  push.counts = figures.mean - zero.mean;
  return recorded;
}

std::string countsText(const ChannelVector& counts) {
  std::vector<std::string> words;
  for (const double count : counts)
    words.push_back(fmt::format("{:.1f}", count == 0.0 ? 0.0 : count));
  return fmt::format("[{}]", fmt::join(words, ", "));
}

std::string stepText(const ChannelFigures& figures, const char* indentation) {
  if (figures.step <= 1.0) return "";
  return fmt::format("{}step_counts: {:.0f}\n", indentation, figures.step);
}

void readRecord(const YamlNode& record, const std::string& path, PushFile& file,
                ChannelVector& squares, int& zeros) {
  if (const YamlNode* const zero = record.find("zero")) {
    const PushSection alone(record, path, {"zero"});
    file.zero = readZero(*zero, path + ".zero");
    squares += file.zero->sigma.cwiseAbs2();
    ++zeros;
    return;
  }
  if (!file.zero && record.kind == YamlNode::Kind::kMap)
    failAt(record.at, path, "a push before any zero", "expected zero first");
  file.pushes.push_back(readPush(record, path, file.zero.value_or(ChannelFigures{})));
}

}  // namespace

std::string defectText(const ChannelDefect& defect) {
  return fmt::format(
      "channel {} {} at {:.0f} counts", defect.channel,
      defect.trouble == ChannelTrouble::kAtItsEnd ? "is at its end," : "is flat-topped: it stops",
      defect.counts);
}

PushFile readPushFile(const std::string& path) {
  SourceReader reader(readFromDisk);
  return readPushFile(reader.readFirst(path));
}

PushFile readPushFile(const SourceFile& source) {
  const YamlNode root = parseYaml(source);
  const PushSection section(root, "", {"module", "records"});
  PushFile file;
  file.path = source.path;
  const YamlNode& link = section.require("module", "the link of the tactile module");
  if (link.kind != YamlNode::Kind::kScalar || link.text.empty())
    failAt(link.at, "module", describe(link), "expected the link of the tactile module");
  file.link = link.text;
  const YamlNode& records = section.require("records", "a list of zeros and pushes");
  const bool is_empty =
      records.kind == YamlNode::Kind::kEmpty || records.kind == YamlNode::Kind::kNull;
  if (records.kind != YamlNode::Kind::kList && !is_empty)
    failAt(records.at, "records", describe(records), "expected a list of zeros and pushes");
  ChannelVector squares = ChannelVector::Zero();
  int zeros = 0;
  for (std::size_t i = 0; i < records.items.size(); ++i)
    readRecord(records.items[i], fmt::format("records[{}]", i), file, squares, zeros);
  if (zeros > 0) file.sigma = (squares / zeros).cwiseSqrt();
  return file;
}

std::string pushFileBeginning(const std::string& link) {
  return fmt::format(
      "# Known pushes on a tactile module, written by `tactus calibrate record`: delete an entry\n"
      "# that is wrong, or go on with record. Forces act on the robot, in the link's frame; each\n"
      "# push is measured against the last zero before it.\nmodule: {}\nrecords:\n",
      yamlWord(link));
}

std::string zeroRecord(const ChannelFigures& figures) {
  return fmt::format(
             "  - zero:\n      duration_s: {:.2f}\n      mean_counts: {}\n      sigma_counts: {}\n"
             "      drift_counts_per_s: {}\n",
             figures.duration_s, countsText(figures.mean), countsText(figures.sigma),
             countsText(figures.drift_per_s)) +
         stepText(figures, "      ");
}

std::string pushRecord(const KnownPush& push, const ChannelFigures& figures) {
  std::string text = fmt::format("  - force_N: [0, {:.6g}, {:.6g}]\n    position_m: {:.6g}\n",
                                 push.force_y_N, push.force_z_N, push.position_m);
  if (push.moment_x_Nm != 0.0) text += fmt::format("    moment_x_Nm: {:.6g}\n", push.moment_x_Nm);
  text += fmt::format("    mean_counts: {}\n    sigma_counts: {}\n", countsText(figures.mean),
                      countsText(figures.sigma));
  return text + stepText(figures, "    ");
}

std::vector<KnownPush> pushesOf(const PushFile& file) {
  std::vector<KnownPush> pushes;
  for (const RecordedPush& recorded : file.pushes) pushes.push_back(recorded.push);
  return pushes;
}

}  // namespace tactus
