#include "tactus/cli/push_file.h"

#include "support/calibrate_session.h"

/// What a recording's answers and its file may say.
namespace tactus {
namespace {

using PushFileTest = test::CalibrateSession;

TEST_F(PushFileTest, WhatIsSaidWrongIsAskedAgain) {
  KnownPush push;
  std::string problem;
  const auto isPush = [&](const char* line) { return parsePush(line, 0.38, push, problem); };
  EXPECT_TRUE(isPush("5 -z 0.1"));
  EXPECT_EQ(push.force_z_N, -5.0);
  EXPECT_EQ(push.position_m, 0.1);
  EXPECT_TRUE(isPush("  +0  1.5 -2e0, 0.38 0.1 "));
  EXPECT_EQ(push.force_y_N, 1.5);
  EXPECT_EQ(push.force_z_N, -2.0);
  EXPECT_EQ(push.moment_x_Nm, 0.1);
  EXPECT_TRUE(isPush("0 0 0 0.1 0.2"));
  for (const char* line :
       {"",          "5",           "5 +y",         "5 y 0.1",      "-5 +y 0.1",
        "0 +y 0.1",  "5 +q 0.1",    "5 +y 0.39",    "5 +y -0.1",    "5 +x 0.1",
        "1 5 0 0.1", "0 0 0 0.1",   "0 5 0",        "5 +y 0.1 0 0", "nan +y 0.1",
        "5 +y inf",  "0 5 1e9 0.1", "5 +y 0,1 2 3", "z 5",          "0 5 0 0.1 0.1 0.1"})
    EXPECT_FALSE(isPush(line) || problem.empty()) << line;
  // A decimal comma, by which 0.1 m would be 0 m and a moment of 1 Nm.
  for (const char* line : {"5 +y 0,1", "5,5 +y 0.1", "0 5 0 0,1", "0,5,0,0.1"}) {
    EXPECT_FALSE(isPush(line)) << line;
    EXPECT_TRUE(problem.ends_with("is no number")) << problem;
  }
  test::Random random(44);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  const std::string said = record(
      module, {{""}, {"5 +x 0.1"}, {"4 +y 0.1"}, test::held({4.0, 0.0, 0.1}), {"z"}, {""}, {""}});
  EXPECT_NE(said.find("a force along x, which no module tells"), std::string::npos);
  const PushFile file = readPushFile(path("pushes.yaml"));
  EXPECT_EQ(file.pushes.size(), 1u);
  EXPECT_TRUE(file.zero);
}

/// A file that a hand wrote, with a hidden calibration's counts.
std::string pushFileText(const std::string& pushes) {
  ChannelFigures zero;
  zero.sigma.setConstant(100.0);
  return pushFileBeginning("link4") + zeroRecord(zero) + pushes;
}

TEST_F(PushFileTest, MistakesInThePushesAreNamedWhereTheyStand) {
  const std::string good =
      "  - {force_N: [0, 5, 0], position_m: 0.1, mean_counts: [1, 2, 3, 4, 5, 6, 7, 8],\n"
      "     sigma_counts: [1, 1, 1, 1, 1, 1, 1, 1]}\n";
  const auto errorOf = [&](const std::string& text) {
    std::ofstream(path("pushes.yaml")) << text;
    return refusal();
  };
  const auto expectError = [&](const std::string& from, const std::string& to, const char* error) {
    std::string text = pushFileText(good);
    text.replace(text.find(from), from.size(), to);
    const std::string said = errorOf(text);
    EXPECT_NE(said.find(error), std::string::npos) << said;
    EXPECT_EQ(said.find(path("pushes.yaml") + ":"), 0u) << said;
    EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 0) << said;
  };
  expectError("position_m: 0.1", "position_m: x", "11:38: records[1].position_m: 'x' is no number");
  expectError("position_m: 0.1", "position_m: 0.4", "11:5: position_m: 0.4 m is not on the cover");
  expectError("position_m", "positon_m", "perhaps position_m");
  expectError("[0, 5, 0]", "[1, 5, 0]", "11:15: records[1].force_N: 1 N along the link");
  expectError("[0, 5, 0]", "[0, 0, 0]", "there is no force");
  expectError("[0, 5, 0]", "[0, 5]", "a list of 2, expected a list of 3 numbers");
  expectError("7, 8],", "7, .nan],", "records[1].mean_counts[7]: '.nan' is no number");
  expectError("7, 8],", "7, 1e99],", "is out of range");
  expectError("module: link4", "module: link5", "'link5' has no tactile module");
  expectError("records:", "record:", "perhaps records");
  expectError("  - zero:", "  - zerro:", "records[0]");
  expectError("[100.0", "[-100.0", "sigma_counts: is negative");
  EXPECT_NE(errorOf("").find("-: no value, expected a section"), std::string::npos);
  EXPECT_NE(errorOf(pushFileBeginning("link4") + good).find("a push before any zero"),
            std::string::npos);
  EXPECT_NE(errorOf(pushFileText(good)).find("1 pushes do not tell 4 rows"), std::string::npos);
}

/// Of a converter whose counts come in steps, and hardly rustle: what was recorded is fitted.
TEST_F(PushFileTest, StepsOfCountsAreKept) {
  ChannelFigures zero;
  zero.sigma.setConstant(100.0);
  zero.step = 256.0;
  ChannelFigures held = zero;
  held.mean.setConstant(25600.0);
  held.sigma.setZero();
  const std::string records = zeroRecord(zero) + pushRecord({5.0, 0.0, 0.1}, held);
  std::ofstream(path("pushes.yaml")) << pushFileBeginning("link4") << records;
  const PushFile file = readPushFile(path("pushes.yaml"));
  EXPECT_EQ(file.pushes.size(), 1u);
  EXPECT_EQ(file.zero->step, 256.0);
  EXPECT_EQ(zeroRecord({}).find("step"), std::string::npos);
}

/// As a hand wrote them down, or before a limit was known.
TEST_F(PushFileTest, APushThatAChannelStoppedAtIsNamedWithTheCounts) {
  const auto errorOf = [&](const char* counts, const char* sigma) {
    std::ofstream(path("pushes.yaml"))
        << pushFileText(fmt::format("  - {{force_N: [0, 5, 0], position_m: 0.1,\n     mean_counts: "
                                    "[1, 2, {}, 4, 5, 6, 7, 8],\n     sigma_counts: [90, 90, {}, "
                                    "90, 90, 90, 90, 90]}}\n",
                                    counts, sigma));
    return refusal();
  };
  const std::string begin = path("pushes.yaml") + ":12:26: records[1].mean_counts[2]: channel 2 ";
  EXPECT_EQ(errorOf("8388607", "0"), begin +
                                         "is at its end, at 8388607 counts, expected a smaller "
                                         "push, or no entry");
  EXPECT_EQ(errorOf("-8388500.0", "90"), begin +
                                             "is at its end, at -8388500 counts, expected a "
                                             "smaller push, or no entry");
  EXPECT_EQ(errorOf("250000", "3"), begin +
                                        "is flat-topped: it stops at 250000 counts, expected a "
                                        "smaller push, or no entry");
  EXPECT_NE(errorOf("250000", "90").find("1 pushes do not tell 4 rows"), std::string::npos);
}

TEST_F(PushFileTest, AFileThatCannotBeIsRefusedBeforeAnythingIsAsked) {
  RecordSession session{};
  session.path = path("nowhere/pushes.yaml");
  session.answer = [](std::string&) -> bool { throw std::logic_error("asked"); };
  EXPECT_THROW(recordPushes(session), InputError);
}

TEST_F(PushFileTest, AFileOfAnotherModuleIsNotContinued) {
  test::Random random(47);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  for (const std::string& text :
       {pushFileBeginning("link6"), std::string("module: link4\nrecords: []\n"),
        std::string("records:\nmodule: link4\n")}) {
    std::ofstream(path("pushes.yaml")) << text;
    EXPECT_THROW(record(module, {{""}}), InputError) << text;
    EXPECT_EQ(folder_.content("pushes.yaml"), text);
  }
}

}  // namespace
}  // namespace tactus
