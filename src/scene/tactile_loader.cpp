#include "tactus/scene/tactile_loader.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tactus/math/filter.h"

namespace tactus {
namespace {

constexpr std::string_view kModule = "tactile_module";
constexpr std::string_view kModules = "tactile_modules";
constexpr std::string_view kFirstModule = "tactile_modules[0]";

void checkModule(const YamlNode& root, const TactileModuleSection& section,
                 const std::string& module_key) {
  const TactileModuleConfig& config = section.config;
  const double filter_rate_hz = section.simulated.filter_rate_hz;
  const TactileChannels& channels = section.channels;
  const auto fail = [&](const std::string& key, const std::string& problem,
                        const std::string& expectation) {
    const std::string path = module_key + "." + key;
    failAt(locate(root, path), path, problem, "expected " + expectation);
  };
  if (config.filter_cutoff_hz >= 0.5 * filter_rate_hz) {
    fail("filter_cutoff_hz", fmt::format("{} Hz is too high", config.filter_cutoff_hz),
         fmt::format("less than half the filter's rate of {} Hz", filter_rate_hz));
  }
  if (config.filter_cutoff_hz < kLeastCutoff * filter_rate_hz) {
    fail("filter_cutoff_hz", fmt::format("{} Hz is too low", config.filter_cutoff_hz),
         fmt::format("at least {} Hz, 1e-4 of the filter's rate", kLeastCutoff * filter_rate_hz));
  }
  const double filter_steps = channels.sample_period_s * filter_rate_hz;
  constexpr double kTolerance = 1e-6;
  if (filter_steps < 0.5 || std::abs(filter_steps - std::round(filter_steps)) > kTolerance) {
    fail("sample_period_s",
         fmt::format("{} s is {} filter periods", channels.sample_period_s, filter_steps),
         "a multiple of 1 / filter_rate_hz");
  }
  if (config.max_sample_age_s < channels.sample_period_s) {
    fail("max_sample_age_s",
         fmt::format("{} s is shorter than the sample period", config.max_sample_age_s),
         fmt::format("at least {} s", channels.sample_period_s));
  }
  Eigen::MatrixXd rows = channels.calibration;
  if (channels.moment_x) {
    rows.conservativeResize(5, Eigen::NoChange);
    rows.row(4) = *channels.moment_x;
  }
  Eigen::FullPivLU<Eigen::MatrixXd> decomposition(rows);
  decomposition.setThreshold(1e-6);
  if (decomposition.rank() < rows.rows()) {
    fail("calibration", fmt::format("has rank {}", decomposition.rank()),
         "rows that are linearly independent");
  }
}

}  // namespace

std::string moduleKey(const YamlNode& root, std::size_t module) {
  return findGiven(root, kModule) ? std::string(kModule) : fmt::format("{}[{}]", kModules, module);
}

std::string modulePathIn(const YamlNode& root, std::string_view path) {
  const std::size_t dot = path.find('.');
  if (dot == std::string_view::npos) return std::string(path);
  const std::string_view key = path.substr(0, dot);
  const bool is_only = findGiven(root, kModule) != nullptr;
  if (is_only && key.starts_with(kModules) && key != kFirstModule) {
    const std::string name(key);
    failAt(locate(root, kModule), name, "the robot has one module", "expected tactile_modules[0]");
  }
  const bool is_first =
      (key == kModule && findGiven(root, kModules)) || (key == kFirstModule && is_only);
  return is_first ? moduleKey(root, 0) + std::string(path.substr(dot)) : std::string(path);
}

void dropOtherSpelling(YamlNode& root, std::string_view path) {
  const std::string_view other = path == kModule ? kModules : path == kModules ? kModule : "";
  std::erase_if(root.entries, [&](const YamlEntry& entry) { return entry.key == other; });
}

void checkModules(const YamlNode& root, const std::vector<TactileModuleSection>& modules) {
  if (findGiven(root, kModule) && findGiven(root, kModules)) {
    const std::string key(kModule);
    failAt(locate(root, key), key, "there are tactile_modules, too", "expected one of the two");
  }
  for (std::size_t i = 0; i < modules.size(); ++i) {
    checkModule(root, modules[i], moduleKey(root, i));
    const auto same = std::ranges::find(modules, modules[i].link, &TactileModuleSection::link);
    if (same == modules.begin() + static_cast<std::ptrdiff_t>(i)) continue;
    const std::string key = moduleKey(root, i) + ".link";
    failAt(locate(root, key), key, inQuotes(modules[i].link) + " has a module already",
           "expected a link of its own");
  }
}

std::vector<NamedFrame> moduleLinks(const YamlNode& root,
                                    const std::vector<TactileModuleSection>& modules) {
  std::vector<NamedFrame> links;
  for (std::size_t i = 0; i < modules.size(); ++i) {
    const std::string key = moduleKey(root, i) + ".link";
    links.push_back({modules[i].link, key, locate(root, key)});
  }
  return links;
}

}  // namespace tactus
