#include "tactus/cli/commission_run.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "tactus/cli/commission_file.h"
#include "tactus/cli/commission_report.h"
#include "tactus/cli/commission_text.h"
#include "tactus/record/output_file.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/exit_code.h"
#include "tactus/scene/located_error.h"
#include "tactus/scene/source_reader.h"

namespace tactus {
namespace {

using Phase = CommissionCycle::Phase;

/// A key that is hit twice; nobody sees a motion coming and answers it as fast.
constexpr double kSecondEnter_s = 0.3;

/// One engineer, one robot.
class Commissioning {
 public:
  Commissioning(const Scene& scene, const CommissionOptions& options, CommissionDesk& desk)
      : scene_(scene),
        options_(options),
        config_(commissionConfig(scene, options)),
        state_path_(statePath(robotFile(scene))),
        state_(readState(state_path_)),
        desk_(desk) {}

  int run() {
    if (!scan()) return kExitFault;
    if (options_.is_scan_alone) return kExitDone;
    refuseUnwritable(robotFile(scene_));
    const std::string protection = protectionText(*scene_.hardware);
    desk_.say(protection + "A line that is typed while a joint moves stops it.\n");
    if (!confirm("Is nobody within reach, and everything that may fall held?")) return kExitFault;
    for (int joint = 0; joint < config_.joints(); ++joint)
      if (options_.joint != joint && isFinished(scene_, state_, joint)) learn(joint);
    for (int joint = 0; joint < config_.joints(); ++joint) {
      if (options_.joint ? joint != *options_.joint : isFinished(scene_, state_, joint)) continue;
      if (!commission(joint)) return kExitFault;
    }
    return finish();
  }

 private:
  /// False: it was stopped, or did not hear all that a scan alone is for.
  bool scan() {
    while (desk_.cycle().phase() == Phase::kScanning && !desk_.isStopped()) desk_.runCycle();
    if (desk_.isStopped()) return false;
    const auto& nodes = desk_.cycle().nodes();
    if (options_.json) {
      desk_.say(jsonText(nodesJson(scene_, nodes)));
    } else {
      desk_.say(nodesText(scene_, nodes));
    }
    const bool has_fault = reportBusFault();
    return !(has_fault && options_.is_scan_alone);
  }

  bool reportBusFault() {
    const auto fault = desk_.takeBusFault();
    if (fault)
      fmt::print(stderr, "{}: {}: {}\n",
                 escaped(scene_.hardware->buses[static_cast<std::size_t>(fault->first)].interface),
                 faultName(fault->second), faultRow(fault->second).detection);
    return fault.has_value();
  }

  /// Cycles go on meanwhile; nothing if it was stopped.
  std::optional<std::string> ask(const std::string& text) {
    desk_.forgetTyped();
    desk_.say(text);
    while (!desk_.isStopped()) {
      if (auto line = desk_.takeLine()) return line;
      desk_.runCycle();
    }
    return std::nullopt;
  }

  /// One of the words, or the last one if it was stopped.
  std::string choose(const std::string& question, const std::vector<std::string>& words) {
    while (const auto line = ask(fmt::format("{} {} > ", question, fmt::join(words, ", "))))
      if (const auto word = std::ranges::find(words, trimmedLine(*line)); word != words.end())
        return *word;
    return words.back();
  }

  bool confirm(const std::string& question) { return choose(question, {"yes", "no"}) == "yes"; }

  void learn(int joint) {
    const DriveConfig& drive = scene_.hardware->drives[static_cast<std::size_t>(joint)];
    desk_.cycle().learn(joint, drive.bus, drive.node_id);
  }

  /// False: the engineer ends here.
  bool commission(int joint) {
    while (true) {
      desk_.cycle().begin(joint);
      serve();
      const JointCommission& done = *desk_.cycle().joint();
      const bool is_good = done.trouble().kind == JointTroubleKind::kNone;
      reportBusFault();
      desk_.say("\n" + (is_good ? findingsText(scene_, done.findings())
                                : troubleText(scene_, joint, done.trouble())));
      if (is_good && write(done.findings())) return true;
      if (desk_.isStopped()) return false;
      const std::string word =
          choose("This joint again, the next one, or end here?", {"again", "next", "end"});
      if (word != "again") return word == "next";
    }
  }

  void serve() {
    const Question* asked = nullptr;
    bool has_waited = false;
    int cycles_since_answer = 0;
    CommissionCycle& cycle = desk_.cycle();
    while (cycle.phase() != Phase::kIdle) {
      desk_.runCycle();
      ++cycles_since_answer;
      const Question* const question = cycle.question();
      if (question && !asked) {
        desk_.forgetTyped();
        desk_.say(questionText(scene_, config_, *question) + "\n> ");
      }
      asked = question;
      if (cycle.isWaitingForEnable() && !has_waited) desk_.say("switch the enable line on\n");
      has_waited = cycle.isWaitingForEnable();
      if (cycle.phase() == Phase::kIdle) return;
      const auto line = desk_.takeLine();
      if (!line) continue;
      if (!question) {
        const bool is_second_enter = cycle.phase() == Phase::kReading &&
                                     trimmedLine(*line).empty() &&
                                     cycles_since_answer * config_.period_s < kSecondEnter_s;
        if (!is_second_enter) desk_.stopMotion();
        continue;
      }
      const auto answer = parseAnswer(scene_, *question, *line);
      if (answer && cycle.answer(*answer))
        cycles_since_answer = 0;
      else
        desk_.say(fmt::format("expected {}\n> ", expectedText(scene_, *question)));
    }
  }

  /// False: refused, by the engineer or the file's loader.
  bool write(const JointFindings& found) {
    try {
      SourceFile robot = robotFile(scene_);
      const std::string before = robot.text;
      robot.text = withFindings(scene_, robot, found);
      Json state = state_;
      state["joints"][scene_.joint_names[static_cast<std::size_t>(found.joint)]] =
          stateOf(scene_, found);
      Scene next = withRobot(scene_, robot.text);
      if (const auto lag_s = slowestLag(next, state)) {
        robot.text = withLag(robot, *lag_s);
        next = withRobot(scene_, robot.text);
      }
      if (!isFinished(next, state, found.joint))
        throw InputError("--set: holds what was found, expected none of this drive's keys");
      const std::string difference = differenceText(before, robot.text);
      desk_.say(escaped(robot.path) + ":\n" +
                (difference.empty() ? "nothing differs\n" : difference));
      do {
        if (!confirm("Write this?")) return false;
        refuseChanges(robot.path, before, robot.text);
      } while (!save(robot, state, next));
      state_ = std::move(state);
      return true;
    } catch (const InputError& error) {
      desk_.say(std::string(error.what()) + "\n");
      return false;
    }
  }

  /// next: the scene with this robot. False: it cannot be written now. What was found is still
  /// there, to be written later.
  bool save(const SourceFile& robot, const Json& state, const Scene& next) {
    try {
      if (readFromDisk(robot.path) != robot.text) {
        writeRobot(robot, !is_copy_kept_);
        is_copy_kept_ = true;
      }
      scene_ = next;  // as the file is now, whatever becomes of the state
      writeState(state_path_, state);
      return true;
    } catch (const std::runtime_error& error) {
      desk_.say(std::string(error.what()) + "\n");
      return false;
    }
  }

  static void refuseChanges(const std::string& path, const std::string& before,
                            const std::string& after) {
    const std::string now = SourceReader(readFromDisk).readFirst(path).text;
    if (now == before || now == after) return;
    throw InputError(fmt::format("{}: was changed meanwhile, expected no change", escaped(path)));
  }

  /// Once all joints are finished.
  static std::optional<double> slowestLag(const Scene& scene, const Json& state) {
    double slowest_s = 0.0;
    for (int joint = 0; joint < scene.controller.chain.size(); ++joint) {
      if (!isFinished(scene, state, joint)) return std::nullopt;
      const auto& name = scene.joint_names[static_cast<std::size_t>(joint)];
      const Json lag_s = state.at("joints").at(name).value("lag_s", Json());
      if (lag_s.is_number()) slowest_s = std::max(slowest_s, lag_s.get<double>());
    }
    return slowest_s;
  }

  int finish() {
    std::string open;
    for (int joint = 0; joint < config_.joints(); ++joint)
      if (!isFinished(scene_, state_, joint))
        open += " " + escaped(scene_.joint_names[static_cast<std::size_t>(joint)]);
    desk_.say(open.empty() ? "all joints are finished\n" : "not finished:" + open + "\n");
    const bool is_done =
        options_.joint ? isFinished(scene_, state_, *options_.joint) : open.empty();
    return is_done ? kExitDone : kExitFault;
  }

  Scene scene_;
  CommissionOptions options_;
  CommissionConfig config_;
  std::string state_path_;
  Json state_;
  CommissionDesk& desk_;
  bool is_copy_kept_ = false;  ///< of the robot's file as it was at the start
};

}  // namespace

int runCommission(const Scene& scene, const CommissionOptions& options, CommissionDesk& desk) {
  return Commissioning(scene, options, desk).run();
}

}  // namespace tactus
