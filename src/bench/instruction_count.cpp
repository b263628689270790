#include "tactus/bench/instruction_count.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <valgrind/callgrind.h>

#include <filesystem>
#include <fstream>

#include "tactus/bench/child_program.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

namespace fs = std::filesystem;

/// A folder that is gone at the end.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "tactus-bench-XXXXXX").string();
    if (!::mkdtemp(pattern.data())) throw RunError("no temporary folder can be made");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// A dump says `desc: Trigger: Client Request: LABEL` and `totals: COUNT`.
void readDump(const fs::path& path, std::map<std::string, double>& counts) {
  const std::string label_start = "desc: Trigger: Client Request: ";
  const std::string count_start = "totals: ";
  std::ifstream file(path);
  std::string label;
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(label_start)) label = line.substr(label_start.size());
    if (line.starts_with(count_start) && !label.empty())
      counts[label] = std::stod(line.substr(count_start.size())) / kCountedSteps;
  }
}

}  // namespace

std::string countLabel(const StepCase& step_case) {
  return fmt::format("{} n={} m={} contacts={}", step_case.code, step_case.joints,
                     step_case.task_components, step_case.contacts);
}

void runUnderCallgrind(const std::vector<StepCase>& cases) {
  for (const StepCase& step_case : cases) {
    step_case.prepare();
    step_case.step(0);  // what happens once only
    CALLGRIND_ZERO_STATS;
    for (int i = 0; i < kCountedSteps; ++i) {
      CALLGRIND_TOGGLE_COLLECT;
      step_case.step(i * (kStepStates / kCountedSteps) + 1);
      CALLGRIND_TOGGLE_COLLECT;
    }
    const std::string label = countLabel(step_case);
    CALLGRIND_DUMP_STATS_AT(label.c_str());
  }
}

std::map<std::string, double> countInstructions(const std::vector<std::string>& command) {
  const ScratchFolder folder;
  std::vector<std::string> words = {"valgrind", "--tool=callgrind", "--collect-atstart=no",
                                    "--callgrind-out-file=" + (folder.path() / "dump").string()};
  words.insert(words.end(), command.begin(), command.end());
  std::map<std::string, double> counts;
  if (runProgram(words).exit_code != 0) return counts;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder.path()))
    readDump(entry.path(), counts);
  return counts;
}

}  // namespace tactus
