#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <csignal>

#include "support/calibrate_session.h"
#include "tactus/cli/calibrate_fit.h"
#include "tactus/cli/push_file.h"
#include "tactus/cli/wrench_rows.h"
#include "tactus/record/run_error.h"

/// The whole way: from a module whose calibration nobody knows to one that robot.yaml has.
namespace tactus {
namespace {

using test::held;
using test::scriptOf;
using CalibrateTest = test::CalibrateSession;

/// Of what a hidden module says under loads that nobody calibrated with, by the written
/// calibration.
double largestMiss(test::Random& random, test::VirtualModule& module,
                   const TactileChannels& calibration, int rows) {
  CanTactileConfig config;
  const auto meanUnder = [&](const Wrench5& load) {
    module.load = load;
    module.growth_per_s.setZero();
    return listen(module.source(), {"can3", config}, 1.0).figures().mean;
  };
  const ChannelVector zero = meanUnder(Wrench5::Zero());
  double largest = 0.0;
  for (int i = 0; i < 20; ++i) {
    const double angle = random.uniform(-3.14, 3.14);
    KnownPush push{5.0 * std::cos(angle), 5.0 * std::sin(angle), random.uniform(0.0, 0.38)};
    if (rows == 5) push.moment_x_Nm = random.uniform(-0.2, 0.2);
    const Wrench5 found = wrenchFrom(calibration, meanUnder(wrenchOf(push)) - zero);
    const Wrench5 scale{{1.0, 1.0, 1.0 / 0.19, 1.0 / 0.19, rows == 5 ? 1.0 / 0.06 : 0.0}};
    largest = std::max(largest, scale.cwiseProduct(found - wrenchOf(push)).norm());
  }
  return largest;
}

TEST_F(CalibrateTest, FindsHiddenCalibrationsAndWritesThemIntoTheRobot) {
  test::Random random(41);
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    const int rows = i % 3 == 2 ? 5 : 4;
    test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), rows), 0.01,
                               0x100);
    for (std::int32_t& counts : module.offset) counts = random.integer(-200000, 200000);
    std::filesystem::remove(path("pushes.yaml"));
    std::filesystem::copy_file(TACTUS_SOURCE_DIR "/config/robots/crops9/robot.yaml",
                               path("robot.yaml"),
                               std::filesystem::copy_options::overwrite_existing);
    const std::string said = record(module, scriptOf(random, rows == 5));
    EXPECT_EQ(said.find("refused"), std::string::npos) << said;
    EXPECT_NE(said.find("12 pushes, condition"), std::string::npos) << said;
    EXPECT_NE(said.find(": enough"), std::string::npos) << said;
    EXPECT_NE(said.find("of them nothing checks yet"), std::string::npos) << "at first: " << said;
    const Json found = fit({"--write"});
    EXPECT_EQ(found["pushes"].size(), 12u);
    EXPECT_EQ(found["calibration"].size(), static_cast<std::size_t>(rows));
    EXPECT_EQ(found["written"], path("robot.yaml"));
    EXPECT_LT(largestMiss(random, module, written(), rows), 0.05) << "of 5 N, with 10 mN of noise";
    EXPECT_GT(largestMiss(random, module, test::channelsWith(test::hiddenCalibration(random), rows),
                          rows),
              1.0)
        << "another calibration does it, too: this test is blind";
  }
  EXPECT_NE(folder_.content("robot.yaml").find("# M_x, m"), std::string::npos);
  EXPECT_NE(folder_.content("robot.yaml").find("# Two rings of four cells"), std::string::npos);
  EXPECT_EQ(folder_.content("robot.yaml~").find("# M_x, m"), std::string::npos);
}

TEST_F(CalibrateTest, ARecordingIsContinuedFromANewZero) {
  test::Random random(42);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  std::deque<test::ScriptedAnswer> script = scriptOf(random, false);
  // Five pushes, then the power fails; the module wakes with other offsets.
  record(module, {script.begin(), script.begin() + 11});
  const std::string first = folder_.content("pushes.yaml");
  for (std::int32_t& counts : module.offset) counts = random.integer(-500000, 500000);
  std::ofstream(path("pushes.yaml"), std::ios::app) << "  # after lunch";  // without line break
  script.erase(script.begin() + 1, script.begin() + 11);
  record(module, script);
  EXPECT_EQ(folder_.content("pushes.yaml").find(first), 0u);
  const Json found = fit({"--write"});
  EXPECT_EQ(found["pushes"].size(), 12u);
  EXPECT_LT(largestMiss(random, module, written(), 4), 0.03);
}

/// What was measured before the disk was full can still be gone on with.
TEST_F(CalibrateTest, AFullDiskLeavesNoHalfARecord) {
  test::Random random(49);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  const std::deque<test::ScriptedAnswer> script = scriptOf(random, false);
  record(module, {script.begin(), script.begin() + 11});
  const std::string first = folder_.content("pushes.yaml");
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, SIG_IGN);
  const rlimit nearly_full{first.size() + 100, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &nearly_full);
  EXPECT_THROW(record(module, {{""}}), RunError);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(folder_.content("pushes.yaml"), first);
}

TEST_F(CalibrateTest, OfSeveralModulesOnlyTheOneThatWasPushedIsWritten) {
  const std::string skin = TACTUS_SOURCE_DIR "/config/robots/crops9_skin/robot.yaml";
  std::ifstream in(skin, std::ios::binary);
  std::string robot{std::istreambuf_iterator<char>(in), {}};
  robot.replace(robot.find("../crops9/"), 10, "");
  std::ofstream(path("robot.yaml")) << robot;
  const auto modules = [&] {
    return loadScene(path("scene.yaml"), {{"controller.variant", "none"}}).plant.modules;
  };
  const std::vector<SimulatedModuleConfig> before = modules();
  test::Random random(48);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  record(module, scriptOf(random, false));
  EXPECT_THROW(fit({"--module", "0"}), CLI::ValidationError) << "the file says which";
  std::string output;
  const auto show = [&](const char* index) {
    return test::runCommand(addCalibrateCommand,
                            {"calibrate", "show", path("scene.yaml"), "--module", index}, output);
  };
  EXPECT_THROW(show("-1"), CLI::ValidationError);
  EXPECT_THROW(show("8"), CLI::ValidationError) << "more than there may be";
  EXPECT_EQ(fit({"--write"})["tactile_module"], "link4");
  const std::vector<SimulatedModuleConfig> after = modules();
  ASSERT_EQ(after.size(), 3u);
  EXPECT_EQ(after[0].channels.calibration, before[0].channels.calibration);
  EXPECT_EQ(after[2].channels.calibration, before[2].channels.calibration);
  EXPECT_LT(largestMiss(random, module, after[1].channels, 4), 0.03);
  EXPECT_NE(folder_.content("robot.yaml").find("# rings at x = 0.03 m"), std::string::npos);
}

TEST_F(CalibrateTest, WhatTellsNothingIsRefusedAndNotWritten) {
  test::Random random(43);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  const KnownPush push{4.0, 0.0, 0.1}, tiny{0.001, 0.0, 0.1}, huge{900.0, 0.0, 0.1};
  const auto saidOf = [&](const test::ScriptedAnswer& hold, std::int32_t top = kModuleFullScale) {
    std::filesystem::remove(path("pushes.yaml"));
    module.top = top;
    const std::string said = record(module, {{""}, {"4 +y 0.1"}, hold});
    module.top = kModuleFullScale;
    EXPECT_EQ(said.find("refused") == std::string::npos,
              folder_.content("pushes.yaml").find("force_N") != std::string::npos);
    return said;
  };
  EXPECT_EQ(saidOf(held(push)).find("refused"), std::string::npos);
  EXPECT_NE(saidOf(held(tiny)).find("refused: no channel moved"), std::string::npos);
  const std::string at_end = saidOf(held(huge));
  EXPECT_NE(at_end.find("is at its end, at"), std::string::npos) << at_end;
  EXPECT_NE(saidOf(held(push), 100000).find("is flat-topped: it stops at"), std::string::npos);
  module = test::VirtualModule(test::channelsWith(test::hiddenCalibration(random), 4), 0.0, 0x100);
  const std::string narrow = saidOf(held({40.0, 40.0, 0.1}), 32767);
  EXPECT_NE(narrow.find("is at its end, at 32767 counts: push less"), std::string::npos) << narrow;
  module =
      test::VirtualModule(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  module.offset[3] = 300000;
  module.top = 200000;
  std::filesystem::remove(path("pushes.yaml"));
  EXPECT_NE(record(module, {{""}}).find("refused: channel 3 is flat-topped: it stops at 200000"),
            std::string::npos);
  module.offset[3] = 0;
  test::ScriptedAnswer growing = held(push);
  growing.growth_per_s[0] = 2.0;
  EXPECT_NE(saidOf(growing).find("refused: the push changed by"), std::string::npos);
  std::filesystem::remove(path("pushes.yaml"));
  record(module, {{""}, {"4 +y 0.1"}, {"s", wrenchOf(push)}, {"4 +z 0.1"}});
  EXPECT_EQ(folder_.content("pushes.yaml").find("force_N"), std::string::npos) << "skipped";
  module.is_silent = true;
  EXPECT_THROW(saidOf(held(push)), RunError);
  module.is_silent = false;
  module.is_cable_broken = true;
  EXPECT_THROW(saidOf(held(push)), RunError);
}

/// Enter twice at a push is no end of the session; and the end says of what it was.
TEST_F(CalibrateTest, WhatWasTypedBeforeAQuestionIsNoAnswer) {
  test::Random random(50);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  test::ScriptedAnswer again;
  again.is_too_early = true;
  const std::string said = record(module, {{""},
                                           again,
                                           {"4 +y 0.1"},
                                           held({4.0, 0.0, 0.1}),
                                           again,
                                           {"4 +z 0.1"},
                                           held({0.0, 4.0, 0.1}),
                                           again,
                                           {""}});
  EXPECT_EQ(readPushFile(path("pushes.yaml")).pushes.size(), 2u);
  EXPECT_NE(said.find("ended; module link4, " + path("pushes.yaml") + ": 2 pushes, which"),
            std::string::npos)
      << said;
  std::filesystem::remove(path("pushes.yaml"));
  EXPECT_TRUE(record(module, {{""}, {""}})
                  .ends_with("ended; module link4, " + path("pushes.yaml") + ": no push yet\n"));
}

/// What was meant for the next question shall not be measured as a push.
TEST_F(CalibrateTest, EnterAloneBeginsToMeasure) {
  test::Random random(52);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  const Wrench5 load = wrenchOf({4.0, 0.0, 0.1});
  const std::string said = record(module, {{"y"},
                                           {" "},
                                           {"4 +y 0.1"},
                                           {"S", load},
                                           {"4 +z 0.1", load},
                                           {"\t\r", load},
                                           {"4 +z 0.2"},
                                           {" s\r", load},
                                           {"  "}});
  const PushFile file = readPushFile(path("pushes.yaml"));
  ASSERT_EQ(file.pushes.size(), 1u);
  EXPECT_EQ(file.pushes[0].push.position_m, 0.1);
  EXPECT_EQ(file.pushes[0].push.force_y_N, 4.0);
  const std::string content = folder_.content("pushes.yaml");
  EXPECT_EQ(content.find("zero:"), content.rfind("zero:"));
  EXPECT_NE(said.find("'y' is no answer, expected enter\n"), std::string::npos) << said;
  EXPECT_NE(said.find("'S' is no answer, expected enter or s\n"), std::string::npos) << said;
  EXPECT_NE(said.find("ended; module link4"), std::string::npos) << said;
}

TEST_F(CalibrateTest, AWrongEntryIsNamedByItsLine) {
  test::Random random(45);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  record(module, scriptOf(random, false));
  std::string text = folder_.content("pushes.yaml");
  std::size_t at = 0;
  for (int push = 0; push < 6; ++push) at = text.find("  - force_N", at + 1);
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n');
  const std::size_t place = text.find("position_m: ", at) + 12;
  text.replace(place, text.find('\n', place) - place, "0.34");
  std::ofstream(path("pushes.yaml")) << text;
  EXPECT_EQ(refusal().find(fmt::format("{}:{}:5: records: this push", path("pushes.yaml"), line)),
            0u)
      << refusal();
}

TEST_F(CalibrateTest, ARobotWithoutRoomForTheCalibrationStaysAsItIs) {
  test::Random random(46);
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random), 4), 0.005, 0x100);
  record(module, scriptOf(random, false));
  std::filesystem::copy_file(TACTUS_SOURCE_DIR "/config/robots/crops9/robot_with_mx.yaml",
                             path("robot.yaml"), std::filesystem::copy_options::overwrite_existing);
  const std::string before = folder_.content("robot.yaml");
  try {
    fit({"--write"});
    ADD_FAILURE() << "written";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("has a row of M_x, and no push"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(folder_.content("robot.yaml"), before);
  EXPECT_FALSE(folder_.has("robot.yaml~") || folder_.has("robot.yaml.next"));
}

}  // namespace
}  // namespace tactus
