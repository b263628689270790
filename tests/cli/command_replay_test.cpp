#include <gtest/gtest.h>

#include <cmath>

#include "support/command_run.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/cli/commands.h"
#include "tactus/control/controller.h"
#include "tactus/record/replay.h"
#include "tactus/run/log_replay.h"
#include "tactus/scene/input_error.h"

namespace tactus {
namespace {

/// A log of a scene of this repository, with a touch that comes and goes.
class CommandReplay : public ::testing::Test {
 protected:
  std::vector<CycleRecord> record(const Scene& scene, int cycles) const {
    const Controller controller(scene.controller);
    ControllerState state = controller.initialState();
    controller.begin(state);
    ControllerOutput output;
    RobotInput input;
    input.q_measured = scene.controller.q_start;
    std::vector<CycleRecord> records(static_cast<std::size_t>(cycles));
    for (int i = 0; i < cycles; ++i) {
      const double t_s = i * scene.period_s;
      input.tactile[0].force_y_N = std::max(0.0, 6.0 * std::sin(4.0 * t_s));
      input.tactile[0].moment_z_Nm = 0.2 * input.tactile[0].force_y_N;
      input.tactile[0].sequence = static_cast<std::uint32_t>(i / 4);
      controller.update(input, controller.initialGains(), t_s, scene.period_s, state, output);
      fillRecord(t_s, input, controller.initialGains(), output, Vector3::Zero(), records[i]);
    }
    return records;
  }

  void writeLogOf(const std::vector<Override>& overrides, int cycles = 400) {
    const Scene scene = test::shippedScene("scenario1_null_space", overrides);
    description_ = describeLog(scene);
    records_ = record(scene, cycles);
    rewriteLog();
  }

  void rewriteLog() const { log_.setContent(test::writeLog(description_, records_)); }

  /// Runs `tactus replay LOG arguments...` and returns its exit code.
  int run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"replay", log_.path()});
    return test::runCommand(addReplayCommand, std::move(arguments), output_);
  }

  test::TemporaryFile log_{".ulg"}, csv_{".csv"};
  LogDescription description_;
  std::vector<CycleRecord> records_;
  std::string output_;
};

TEST_F(CommandReplay, AnUnchangedLogIsEqualToTheBit) {
  writeLogOf({});
  EXPECT_EQ(run({}), kExitDone);
  EXPECT_EQ(output_, "400 cycles, every output equal to the bit\n");
}

TEST_F(CommandReplay, ALogOfARunWithSettingsReplaysWithThem) {
  writeLogOf({{"controller.order", "1"}, {"controller.damping", "0.8"}});
  EXPECT_EQ(run({}), kExitDone) << output_;
  description_.overrides.clear();
  rewriteLog();
  EXPECT_EQ(run({}), kExitFault) << "the settings make no difference: this test is blind";
}

TEST_F(CommandReplay, ALogOfARunWithAnotherRobotReplaysWithIt) {
  writeLogOf({{"robot.limits.acceleration[0]", "0.01"}, {"robot.home[4]", "0.4"}});
  EXPECT_EQ(run({}), kExitDone) << output_;
  EXPECT_EQ(run({"--set", "robot.tip=link9"}), kExitDone);
  EXPECT_NE(output_.find("cycles differ"), std::string::npos) << output_;
  description_.overrides.clear();
  rewriteLog();
  EXPECT_EQ(run({}), kExitFault) << "the settings make no difference: this test is blind";
}

TEST_F(CommandReplay, OneFlippedBitIsAFault) {
  writeLogOf({});
  reinterpret_cast<char*>(&records_[77].dq[4])[0] ^= 1;
  rewriteLog();
  EXPECT_EQ(run({}), kExitFault);
  EXPECT_EQ(output_.find("1 of 400 cycles differ, first cycle 77 at 0.077 s: dq_5 recorded "), 0u)
      << output_;
}

TEST_F(CommandReplay, ASettingShowsWhatItChanges) {
  writeLogOf({});
  EXPECT_EQ(run({"--set", "controller.time_constant_s=0.2", "-o", csv_.path()}), kExitDone);
  EXPECT_NE(output_.find("\nlargest difference of dq_"), std::string::npos) << output_;
  EXPECT_NE(output_.find("\nlargest difference of u_n: "), std::string::npos) << output_;
  EXPECT_NE(output_.find("\nforces are as recorded: "), std::string::npos) << output_;
  const std::string csv = csv_.content();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 401);
}

/// Cycles of another length would be those of no run.
TEST_F(CommandReplay, RefusesAnotherPeriod) {
  writeLogOf({});
  try {
    run({"--set", "period_s=0.002"});
    FAIL() << "replayed with another period";
  } catch (const InputError& error) {
    EXPECT_EQ(std::string(error.what()).find("--set period_s:1:1: period_s: cannot be set"), 0u)
        << error.what();
  }
}

TEST_F(CommandReplay, TheLogHoldsEveryNumberAsAParameter) {
  writeLogOf({{"controller.time_constant_s", "0.25"}});
  const auto parameters = test::readLog(log_.content()).description.parameters;
  const auto value = [&parameters](const std::string& name) {
    std::vector<double> values;
    for (const auto& [key, number] : parameters) {
      if (key == name) values.push_back(number);
    }
    return values;
  };
  EXPECT_EQ(value("controller/time_constant_s"), std::vector<double>{0.25});
  EXPECT_EQ(value("controller/damping"), std::vector<double>{0.5}) << "a default";
  EXPECT_EQ(value("simulation/obstacles/0/stiffness_N_per_m"), std::vector<double>{60.0});
}

TEST_F(CommandReplay, ASettingOfTheRunIsOverruledByTheCommandLine) {
  writeLogOf({{"controller.time_constant_s", "0.2"}});
  EXPECT_EQ(run({"--set", "controller.time_constant_s=0.2"}), kExitDone);
  EXPECT_EQ(output_, "400 cycles, every output equal to the bit\n");
  EXPECT_EQ(run({"--set", "controller.time_constant_s=0.1"}), kExitDone);
  EXPECT_NE(output_.find("cycles differ"), std::string::npos);
}

TEST_F(CommandReplay, RecordedGainsAreFed) {
  writeLogOf({{"controller.damping", "0.8"}});
  description_.overrides.clear();
  rewriteLog();
  EXPECT_EQ(run({}), kExitDone) << "the scene says 0.5, the cycles 0.8" << output_;
  EXPECT_EQ(run({"--set", "controller.damping=0.5"}), kExitDone);
  EXPECT_NE(output_.find("cycles differ"), std::string::npos) << "--set is not laid over them";
}

TEST_F(CommandReplay, RecordedGainsOutOfRangeAreRefusedInOneLine) {
  writeLogOf({});
  const auto refusal = [this] {
    try {
      run({});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  records_[200].gains.force.time_constant_s = -0.1;
  rewriteLog();
  EXPECT_EQ(refusal(), log_.path() +
                           ":1:1: controller.time_constant_s: -0.1 is out of range, in the gains "
                           "recorded at 0.2 s, expected a number from 0.001 to 100 in s");
  records_[200].gains.force.time_constant_s = std::nan("");
  rewriteLog();
  EXPECT_NE(refusal().find("controller.time_constant_s: nan is out of range"), std::string::npos);
  records_[200].gains = records_[0].gains;
  records_[200].gains.task.drift_gain_per_s = 1001.0;
  rewriteLog();
  EXPECT_NE(refusal().find("task.drift_gain_per_s: 1001 is too high"), std::string::npos);
}

TEST_F(CommandReplay, JsonSaysTheSame) {
  writeLogOf({});
  EXPECT_EQ(run({"--json"}), kExitDone);
  EXPECT_NE(output_.find("\"differing_cycles\": 0"), std::string::npos) << output_;
  EXPECT_NE(output_.find("\"first_difference\": null"), std::string::npos) << output_;
  records_[3].gamma = 0.5;
  rewriteLog();
  EXPECT_EQ(run({"--json"}), kExitFault);
  EXPECT_NE(output_.find("\"column\": \"gamma\",\n    \"cycle\": 3,"), std::string::npos)
      << output_;
}

/// A run of several logs, as the daemon leaves it.
class CommandReplayOfParts : public CommandReplay {
 protected:
  /// From cycle `from` up to `to`.
  void writePart(const test::TemporaryFile& file, const std::string& run, int part, int from,
                 int to) {
    LogDescription description = description_;
    description.infos.emplace_back("run", run);
    description.infos.emplace_back("part", std::to_string(part));
    file.setContent(test::writeLog(description, {records_.begin() + from, records_.begin() + to}));
  }

  int replay(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "replay");
    return test::runCommand(addReplayCommand, std::move(arguments), output_);
  }

  std::string refusal(std::vector<std::string> arguments) {
    try {
      replay(std::move(arguments));
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  /// From which on the controller begins anew, from a state of its own.
  void resetIn(int cycle) {
    const Scene scene = test::shippedScene("scenario1_null_space");
    const auto first = records_.begin() + cycle;
    first->mode = static_cast<std::uint64_t>(Mode::kFault);
    const Controller controller(scene.controller);
    Replayer replayer(controller, description_.shape.joints, scene.period_s);
    for (CycleRecord& record : records_) record = replayer.replay(record);
  }

  test::TemporaryFile first_{".2.ulg"}, second_{".1.ulg"}, third_{".0.ulg"};
};

TEST_F(CommandReplayOfParts, AreOneRun) {
  writeLogOf({});
  writePart(second_, "a", 1, 100, 101);
  writePart(third_, "a", 2, 101, 400);
  writePart(first_, "a", 0, 0, 100);
  EXPECT_EQ(replay({first_.path(), second_.path(), third_.path()}), kExitDone);
  EXPECT_EQ(output_, "400 cycles, every output equal to the bit\n");
  records_[390].dq[4] += 1.0;
  writePart(third_, "a", 2, 101, 400);
  EXPECT_EQ(replay({first_.path(), second_.path(), third_.path()}), kExitFault);
  EXPECT_EQ(output_.find("1 of 400 cycles differ, first cycle 390 at 0.39 s: dq_5"), 0u) << output_;
}

TEST_F(CommandReplayOfParts, ALaterOneAloneIsReplayedFromTheFirstReset) {
  writeLogOf({}, 2400);
  resetIn(2300);
  writePart(third_, "a", 2, 200, 2400);
  EXPECT_EQ(replay({third_.path(), "-o", csv_.path()}), kExitDone);
  EXPECT_EQ(output_,
            "not replayed from 0.2 s to 2.299 s: the part before is missing\n"
            "100 of 2200 cycles compared\n"
            "100 cycles, every output equal to the bit\n");
  const std::string csv = csv_.content();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 101);
  records_[250].dq[4] += 1.0;
  records_[2350].dq[4] += 1.0;
  writePart(third_, "a", 2, 200, 2400);
  EXPECT_EQ(replay({third_.path(), "--json"}), kExitFault);
  for (const char* expected :
       {"\"cycles\": 2200", "\"compared_cycles\": 100", "\"from_s\": 0.2", "\"to_s\": 2.299",
        "\"reason\": \"the part before is missing\"", "\"differing_cycles\": 1", "\"cycle\": 2150"})
    EXPECT_NE(output_.find(expected), std::string::npos) << expected << " in\n" << output_;
}

TEST_F(CommandReplayOfParts, NothingComparedIsRefusedAndWritesNothing) {
  writeLogOf({});
  writePart(third_, "a", 2, 200, 400);
  const std::string remedy =
      ", just before it, %s missing, expected all logs of the run, the oldest first; behind "
      "missing "
      "ones replay begins where the drives have stopped the arm by themselves, which none of these "
      "logs holds";
  const auto lacks = [&](const std::string& parts, const char* verb) {
    std::string text = third_.path() + ":1:1: part: " + parts + remedy;
    return text.replace(text.find("%s"), 2, verb);
  };
  EXPECT_EQ(refusal({third_.path(), "-o", csv_.path()}), lacks("parts 0 to 1 of the run", "are"));
  EXPECT_THROW(replayLogs({.logs = {third_.path()}, .settings = {}, .output = {}}, [](double) {}),
               MissingPartsError);
  EXPECT_FALSE(std::filesystem::exists(csv_.path()));
  records_.back().mode = static_cast<std::uint64_t>(Mode::kOff);  // a reset, with which it ends
  writePart(third_, "a", 2, 200, 400);
  EXPECT_EQ(refusal({third_.path()}), lacks("parts 0 to 1 of the run", "are"));
  writePart(first_, "a", 0, 0, 0);
  EXPECT_EQ(refusal({first_.path(), third_.path()}), lacks("part 1 of the run", "is"));
}

TEST_F(CommandReplayOfParts, OneThatLostItsFirstRecordsIsRefusedForThat) {
  writeLogOf({});
  records_.erase(records_.begin(), records_.begin() + 10);
  rewriteLog();
  EXPECT_EQ(refusal({log_.path()}),
            log_.path() +
                ":1:1: cycle: none with a command can be replayed: from 0 s on records "
                "are missing, expected a log that goes on to where the drives have "
                "stopped the arm by themselves");
}

TEST_F(CommandReplayOfParts, DroppedRecordsAreSaidAndNoDifference) {
  writeLogOf({}, 2400);
  resetIn(2300);
  records_.erase(records_.begin() + 50, records_.begin() + 60);
  rewriteLog();
  EXPECT_EQ(run({}), kExitDone) << output_;
  EXPECT_EQ(output_,
            "not replayed from 0.05 s to 2.299 s: records are missing\n"
            "150 of 2390 cycles compared\n"
            "150 cycles, every output equal to the bit\n");
}

TEST_F(CommandReplayOfParts, AnOlderLogTakesAGapForMissedCycles) {
  writeLogOf({});
  records_.erase(records_.begin() + 1, records_.begin() + 4);
  rewriteLog();
  std::string bytes = log_.content();
  bytes.replace(bytes.find("missed_cycles"), 13, "something_new");
  log_.setContent(bytes);
  EXPECT_EQ(run({}), kExitFault) << "the run did not coast, as it missed no cycle";
  EXPECT_EQ(output_.find("396 of 397 cycles differ, first cycle 1 "), 0u) << output_;
}

TEST_F(CommandReplayOfParts, RefusesWhatIsNotOneRunInItsOrder) {
  writeLogOf({});
  writePart(first_, "a", 0, 0, 100);
  writePart(second_, "a", 1, 100, 200);
  writePart(third_, "b", 2, 200, 400);
  EXPECT_EQ(refusal({second_.path(), first_.path()}),
            first_.path() +
                ":1:1: part: part 0 of the run behind part 1, expected the oldest first, "
                "as in run.2.ulg run.1.ulg run.ulg");
  EXPECT_NE(refusal({first_.path(), first_.path()}).find("part 0 of the run behind part 0"),
            std::string::npos);
  EXPECT_EQ(refusal({first_.path(), second_.path(), third_.path()})
                .find(third_.path() + ":1:1: run: is not of the same run as "),
            0u);
  EXPECT_NE(refusal({log_.path(), log_.path()}).find(": run: is not of the same run"),
            std::string::npos)
      << "a log of no parts";
  for (const char* part : {"-1", "1x", "99999999999"}) {
    LogDescription description = description_;
    description.infos.emplace_back("part", part);
    log_.setContent(test::writeLog(description, records_));
    EXPECT_NE(refusal({log_.path()}).find(": part: "), std::string::npos) << part;
  }
}

TEST_F(CommandReplayOfParts, AnEmptyLastOneAndACutOneAreRead) {
  writeLogOf({});
  writePart(first_, "a", 0, 0, 100);
  writePart(second_, "a", 1, 100, 100);
  EXPECT_EQ(replay({first_.path(), second_.path()}), kExitDone);
  EXPECT_EQ(output_, "100 cycles, every output equal to the bit\n");
  std::string bytes = first_.content();
  bytes.pop_back();
  first_.setContent(bytes);
  EXPECT_EQ(replay({first_.path(), second_.path(), "--json"}), kExitDone);
  EXPECT_NE(output_.find("\"cut_off\": true"), std::string::npos) << output_;
}

TEST_F(CommandReplayOfParts, NoneOfThemIsOverwritten) {
  writeLogOf({});
  writePart(first_, "a", 0, 0, 100);
  writePart(second_, "a", 1, 100, 200);
  const std::string before = second_.content();
  EXPECT_THROW(replay({first_.path(), second_.path(), "-o", second_.path()}), InputError);
  EXPECT_EQ(second_.content(), before);
}

TEST_F(CommandReplay, RefusesALogThatDoesNotBelongToItsScene) {
  writeLogOf({});
  description_.shape.joints = 8;
  rewriteLog();
  EXPECT_THROW(run({}), InputError);
  description_.shape.joints = 9;
  const int task_size = description_.shape.task_size;
  description_.shape.task_size = task_size - 1;
  rewriteLog();
  EXPECT_THROW(run({}), InputError);
  description_.shape.task_size = task_size;
  description_.sources.clear();
  rewriteLog();
  EXPECT_THROW(run({}), InputError);
}

TEST_F(CommandReplay, RefusesALogWithoutCyclesAndABadSetting) {
  writeLogOf({});
  EXPECT_THROW(run({"--set", "controller.nonsense=1"}), InputError);
  EXPECT_THROW(run({"--set", "nonsense"}), InputError);
  records_.clear();
  rewriteLog();
  EXPECT_THROW(run({}), InputError);
}

}  // namespace
}  // namespace tactus
