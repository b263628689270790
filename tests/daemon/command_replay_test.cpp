#include <gtest/gtest.h>

#include <cmath>

#include "support/command_run.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/control/controller.h"
#include "tactus/daemon/commands.h"
#include "tactus/daemon/input_error.h"

namespace tactus {
namespace {

/// A log of a scene of this repository, with a touch that comes and goes.
class CommandReplay : public ::testing::Test {
 protected:
  std::vector<CycleRecord> record(const Scene& scene, int cycles) const {
    const Controller controller(scene.controller);
    ControllerState state = controller.initialState();
    ControllerOutput output;
    RobotInput input;
    input.q_measured = scene.controller.q_start;
    std::vector<CycleRecord> records(static_cast<std::size_t>(cycles));
    for (int i = 0; i < cycles; ++i) {
      const double t_s = i * scene.period_s;
      input.tactile.force_y_N = std::max(0.0, 6.0 * std::sin(4.0 * t_s));
      input.tactile.moment_z_Nm = 0.2 * input.tactile.force_y_N;
      input.tactile.sequence = static_cast<std::uint32_t>(i / 4);
      controller.update(input, t_s, scene.period_s, state, output);
      fillRecord(t_s, input, output, Vector3::Zero(), records[i]);
    }
    return records;
  }

  void writeLogOf(const std::vector<Override>& overrides) {
    const Scene scene = test::shippedScene("scenario1_null_space", overrides);
    description_ = describeLog(scene);
    records_ = record(scene, 400);
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
  writeLogOf({{"controller.time_constant_s", "0.2"}, {"controller.damping", "0.8"}});
  EXPECT_EQ(run({}), kExitDone) << output_;
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
  const std::string csv = csv_.content();
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 401);
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
