#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tactus/bench/instruction_count.h"
#include "tactus/bench/report_page.h"
#include "tactus/bench/step_study.h"
#include "tactus/bench/study.h"
#include "tactus/cli/commands.h"
#include "tactus/record/output_file.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/json.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

struct Options {
  std::vector<std::string> scenes, names;
  std::string folder;
  bool is_quick = false, json = false, counts_steps = false;
};

std::vector<std::string> studyNames() {
  std::vector<std::string> names;
  for (const Study& study : studies()) names.push_back(study.name);
  return names;
}

std::string studyHelp() {
  std::string text = "Only these studies:";
  for (const Study& study : studies()) text += fmt::format("\n{}: {}", study.name, study.help);
  return text;
}

[[noreturn]] void fail(const std::string& place, const std::string& problem,
                       const std::string& expectation) {
  failAt(beginOf(place), "-", problem, "expected " + expectation);
}

fs::path ownPath() { return fs::read_symlink("/proc/self/exe"); }

/// What came along: config/scenes, from where this is called, or as installed.
fs::path scenesFolder() {
  const fs::path here = "config/scenes";
  const fs::path installed = ownPath().parent_path().parent_path() / "share/tactus/scenes";
  return !fs::is_directory(here) && fs::is_directory(installed) ? installed : here;
}

std::vector<std::string> findScenes(const std::string& folder) {
  std::vector<std::string> scenes;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == ".yaml") scenes.push_back(entry.path().string());
  }
  if (scenes.empty())
    fail(folder, "no scenes here", "SCENE arguments, or to be called where they are");
  std::ranges::sort(scenes);
  return scenes;
}

std::vector<const Study*> chooseStudies(const Options& options) {
  std::vector<const Study*> chosen;
  for (const Study& study : studies()) {
    if (options.names.empty() ? study.is_default
                              : std::ranges::count(options.names, study.name) > 0)
      chosen.push_back(&study);
  }
  return chosen;
}

void prepareFolder(const std::string& folder) {
  if (folder.empty()) return;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) fail("-o", folder + " cannot be made: " + error.message(), "a folder");
}

void writeText(const fs::path& path, const std::string& text) {
  OutputFile file(path.string());
  file.append(text);
  file.close();
}

void writeFiles(const fs::path& folder, const std::vector<StudyResult>& results) {
  writeText(folder / "goals.csv", csvText(goalTable(results)));
  for (const StudyResult& result : results) {
    for (const Table& table : result.tables)
      writeText(folder / (table.name + ".csv"), csvText(table));
  }
  writeText(folder / "report.json", reportJson(results));
}

/// The tables are what was measured; without a page they are there all the same.
void makePage(const fs::path& folder, bool is_quiet) {
  const std::string problem = makeReportPage(ownPath().parent_path() / "tactus-report", folder);
  const std::string name = fs::absolute(folder).string();
  if (!problem.empty()) {
    fmt::print(stderr, "no report.html: {}; the tables are in {}, `tactus-report {}` draws them\n",
               problem, name, name);
  } else if (!is_quiet) {
    fmt::print("\nreport: {}\n", name + "/report.html");
  }
}

Json toJson(const std::vector<StudyResult>& results) {
  Json json = {{"goals", tableJson(goalTable(results))}};
  for (const StudyResult& result : results) {
    for (const Table& table : result.tables) json[table.name] = tableJson(table);
  }
  return json;
}

void printGoals(const std::vector<StudyResult>& results) {
  const Table goals = goalTable(results);
  for (std::size_t row = 0; row < goals.rows.size(); ++row) {
    const double measured = goals.number(row, "measured");
    fmt::print("{:<92}{:>9} of at most {:<7.3g} {}\n", goals.word(row, "goal"),
               std::isfinite(measured) ? fmt::format("{:.3g}", measured) : "",
               goals.number(row, "limit"), goals.word(row, "met"));
  }
}

void bench(const Options& options) {
  const std::vector<const Study*> chosen = chooseStudies(options);
  BenchOptions bench_options;
  bench_options.is_quick = options.is_quick;
  bench_options.counting_program = ownPath().string();
  bench_options.scenes = options.scenes;
  bench_options.scenes_folder = scenesFolder().string();
  if (options.scenes.empty() && std::ranges::any_of(chosen, &Study::needs_scenes))
    bench_options.scenes = findScenes(bench_options.scenes_folder);
  prepareFolder(options.folder);
  std::vector<StudyResult> results;
  for (const Study* study : chosen) {
    fmt::print(stderr, "{}: {} ...\n", study->name, study->help);
    results.push_back(study->run(bench_options));
  }
  if (options.json) {
    std::fputs(jsonText(toJson(results)).c_str(), stdout);
  } else {
    printGoals(results);
  }
  if (options.folder.empty()) return;
  writeFiles(options.folder, results);
  makePage(options.folder, options.json);
}

void parse(CLI::App& app, Options& options, int argc, char** argv) {
  app.add_option("SCENE", options.scenes,
                 "Scenes to run; absent: those in config/scenes, or installed");
  app.add_option("-o,--output", options.folder,
                 "Folder for CSV files, report.json and report.html");
  app.add_option("--study", options.names, studyHelp())
      ->allow_extra_args(false)
      ->check(CLI::IsMember(studyNames()));
  app.add_flag_callback(
      "--stability", [&options] { options.names.push_back("stability"); },
      "The table of extremes: --study stability; SCENE: its base");
  app.add_flag_callback(
      "--law", [&options] { options.names.push_back("law"); },
      "null_limit beside the paper's law: --study law; SCENE: its base, with band and profile");
  app.add_flag_callback(
      "--contact", [&options] { options.names.push_back("contact"); },
      "null_limit on contacts that rub: --study contact; SCENE: as for --law");
  app.add_flag_callback(
      "--several", [&options] { options.names.push_back("several"); },
      "null_limit on contacts of several modules: --study several; SCENE: their base");
  app.add_flag_callback(
      "--clutter", [&options] { options.names.push_back("clutter"); },
      "Reaching among many posts: --study clutter; SCENE: the arm and its gains");
  app.add_flag_callback(
      "--body", [&options] { options.names.push_back("body"); },
      "null_limit on regions of the body: --study body; SCENE: as for --law");
  app.add_flag_callback(
      "--physics", [&options] { options.names.push_back("physics"); },
      "The simulated arm beside MuJoCo: --study physics; some ten minutes");
  app.add_flag("--quick", options.is_quick, "A look: few repetitions, short sweeps");
  app.add_flag("--json", options.json, "Print all tables as JSON");
  app.add_flag("--count-steps", options.counts_steps)->group("");  // how valgrind runs this
  app.parse(argc, argv);
}

}  // namespace
}  // namespace tactus

int main(int argc, char** argv) {
  CLI::App app{"Error against run time", "tactus bench"};
  tactus::Options options;
  try {
    tactus::parse(app, options, argc, argv);
    if (options.counts_steps) {
      tactus::runUnderCallgrind(tactus::allStepCases(tactus::StepSizes().joints));
      return tactus::kExitDone;
    }
    tactus::bench(options);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? tactus::kExitDone : tactus::kExitUsage;
  } catch (const tactus::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return tactus::kExitBadInput;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "tactus bench: %s\n", error.what());
    return tactus::kExitFault;
  }
  return tactus::kExitDone;
}
