#include <fmt/format.h>
#include <gtest/gtest.h>

#include "support/hardware_files.h"
#include "tactus/scene/key_words.h"

namespace tactus {
namespace {

using Kind = Trouble::Kind;
using test::hardwareFiles;
using test::SceneFiles;

SceneFiles withTrouble(const std::string& text) {
  SceneFiles files = hardwareFiles();
  files.scene += "  troubles:\n    - {" + text + "}\n";
  return files;
}

Trouble load(const std::string& text) {
  const Scene scene = withTrouble(text).load();
  EXPECT_EQ(scene.troubles.size(), 1u);
  return scene.troubles.at(0);
}

TEST(TroubleLoad, PutsEveryValueInItsPlace) {
  const Trouble trouble =
      load("kind: delay, from_s: 1, until_s: 2.5, interface: can1, id: 0x183, delay_s: 0.002");
  EXPECT_EQ(trouble.kind, Kind::kDelay);
  EXPECT_EQ(trouble.from_s, 1.0);
  EXPECT_EQ(trouble.until_s, 2.5);
  EXPECT_EQ(trouble.bus, 1);
  EXPECT_EQ(trouble.id, 0x183u);
  EXPECT_EQ(trouble.delay_s, 0.002);
}

TEST(TroubleLoad, SpellsEveryKind) {
  const std::string time = ", from_s: 1, until_s: 2";
  const std::string bus = time + ", interface: can0";
  EXPECT_EQ(load("kind: drop, id: 1" + bus).kind, Kind::kDrop);
  EXPECT_EQ(load("kind: delay, delay_s: 0.25" + bus).kind, Kind::kDelay);
  EXPECT_EQ(load("kind: reorder" + bus).kind, Kind::kReorder);
  EXPECT_EQ(load("kind: corrupt" + bus).kind, Kind::kCorrupt);
  EXPECT_EQ(load("kind: duplicate" + bus).kind, Kind::kDuplicate);
  EXPECT_EQ(load("kind: bus_off" + bus).kind, Kind::kBusOff);
  EXPECT_EQ(load("kind: power_cut" + bus).kind, Kind::kPowerCut);
  EXPECT_EQ(load("kind: drive_fault, id: 2" + bus).kind, Kind::kDriveFault);
  EXPECT_EQ(load("kind: ignore_commands, id: 2" + bus).kind, Kind::kIgnoreCommands);
  EXPECT_EQ(load("kind: freeze_feedback, id: 2" + bus).kind, Kind::kFreezeFeedback);
  EXPECT_EQ(load("kind: nonsense_status, id: 2" + bus).kind, Kind::kNonsenseStatus);
  EXPECT_EQ(load("kind: boot_up, id: 2" + bus).kind, Kind::kBootUp);
  EXPECT_EQ(load("kind: heartbeat_only, id: 2" + bus).kind, Kind::kHeartbeatOnly);
  EXPECT_EQ(load("kind: emergency_stop" + time).kind, Kind::kEmergencyStop);
  EXPECT_EQ(static_cast<std::size_t>(Kind::kEmergencyStop) + 1, kTroubleWords.size());
}

TEST(TroubleLoad, KeepsTheOrder) {
  SceneFiles files = withTrouble("kind: drop, from_s: 3, until_s: 4, interface: can0");
  files.scene += "    - {kind: reorder, from_s: 1, until_s: 2, interface: can1}\n";
  const std::vector<Trouble> troubles = files.load().troubles;
  ASSERT_EQ(troubles.size(), 2u);
  EXPECT_EQ(troubles[0].kind, Kind::kDrop);
  EXPECT_EQ(troubles[0].id, 0u) << "all of the bus";
  EXPECT_EQ(troubles[1].kind, Kind::kReorder);
}

TEST(TroubleLoad, HasNoneUnlessGiven) { EXPECT_TRUE(hardwareFiles().load().troubles.empty()); }

struct BrokenTrouble {
  std::string_view text, place, problem, expectation;
};

void PrintTo(const BrokenTrouble& broken, std::ostream* stream) { *stream << broken.text; }

class BrokenTroubles : public testing::TestWithParam<BrokenTrouble> {};

TEST_P(BrokenTroubles, EndsAsOneLine) {
  const BrokenTrouble& broken = GetParam();
  const std::string place = fmt::format("scene.yaml:23:{}: ", broken.place);
  test::expectError(test::loadError(withTrouble(std::string(broken.text)).sources()),
                    {"", broken.text, place, broken.problem, broken.expectation});
}

INSTANTIATE_TEST_SUITE_P(
    All, BrokenTroubles,
    testing::Values(
        BrokenTrouble{"kind: smoke, from_s: 1, until_s: 2", "14: simulation.troubles[0].kind",
                      "'smoke'", "one of drop, delay"},
        BrokenTrouble{"kind: drop, from_s: 1, interface: can0", "7: simulation.troubles[0].until_s",
                      "is missing", "a number"},
        BrokenTrouble{"kind: drop, from_s: 2, until_s: 2, interface: can0",
                      "40: simulation.troubles[0].until_s", "2 s is too early",
                      "more than from_s = 2"},
        BrokenTrouble{"kind: drop, from_s: 1, until_s: 2", "7: simulation.troubles[0].interface",
                      "is missing", "one of can0, can1"},
        BrokenTrouble{"kind: drop, from_s: 1, until_s: 2, interface: can2",
                      "54: simulation.troubles[0].interface", "'can2' is no bus of this scene",
                      "one of can0, can1"},
        BrokenTrouble{"kind: drop, from_s: 1, until_s: 2, interface: can0, id: 0x800",
                      "64: simulation.troubles[0].id", "out of range", "from 0 to 2047"},
        BrokenTrouble{"kind: drop, from_s: 1, until_s: 2, interface: can0, delay_s: 0.1",
                      "69: simulation.troubles[0].delay_s", "says nothing with drop",
                      "no such key"},
        BrokenTrouble{"kind: delay, from_s: 1, until_s: 2, interface: can0",
                      "7: simulation.troubles[0].delay_s", "is missing", "a number > 0 in s"},
        BrokenTrouble{"kind: power_cut, from_s: 1, until_s: 2, interface: can0, id: 1",
                      "69: simulation.troubles[0].id", "says nothing with power_cut",
                      "no such key"},
        BrokenTrouble{"kind: drive_fault, from_s: 1, until_s: 2, interface: can0, id: 3",
                      "71: simulation.troubles[0].id", "3 is no drive of 'can0'",
                      "the node id of a drive"},
        BrokenTrouble{"kind: ignore_commands, from_s: 1, until_s: 2, interface: can0, id: 3",
                      "75: simulation.troubles[0].id", "3 is no drive of 'can0'",
                      "the node id of a drive"},
        BrokenTrouble{"kind: freeze_feedback, from_s: 1, until_s: 2, interface: can0, id: 3",
                      "75: simulation.troubles[0].id", "3 is no drive of 'can0'",
                      "the node id of a drive"},
        BrokenTrouble{"kind: nonsense_status, from_s: 1, until_s: 2, interface: can0, id: 3",
                      "75: simulation.troubles[0].id", "3 is no drive of 'can0'",
                      "the node id of a drive"},
        BrokenTrouble{"kind: boot_up, from_s: 1, until_s: 2, interface: can0, id: 3",
                      "67: simulation.troubles[0].id", "3 is no drive of 'can0'",
                      "the node id of a drive"},
        BrokenTrouble{"kind: heartbeat_only, from_s: 1, until_s: 2, id: 3",
                      "7: simulation.troubles[0].interface", "is missing", "one of can0, can1"},
        BrokenTrouble{"kind: heartbeat_only, from_s: 1, until_s: 2, interface: can0, id: 3",
                      "74: simulation.troubles[0].id", "3 is no drive of 'can0'",
                      "the node id of a drive"},
        BrokenTrouble{"kind: emergency_stop, from_s: 1, until_s: 2, interface: can0",
                      "64: simulation.troubles[0].interface", "says nothing with emergency_stop",
                      "no such key"}));

TEST(TroubleLoad, NeedsHardware) {
  SceneFiles files;
  files.scene += "  troubles: [{kind: drop, from_s: 1, until_s: 2, interface: can0}]\n";
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:22:13: simulation.troubles: ",
                     "the robot has no can section", "no troubles, or such a robot"});
}

TEST(TroubleLoad, NeedsALineForAnEmergencyStop) {
  SceneFiles files = withTrouble("kind: emergency_stop, from_s: 1, until_s: 2");
  files.robot =
      test::replaced(files.robot, "  e_stop: {line: 3, active_low: true, debounce_s: 0.01}\n", "");
  test::expectError(test::loadError(files.sources()),
                    {"", "", "scene.yaml:23:14: simulation.troubles[0].kind: ",
                     "the robot has no gpio.e_stop", "such a robot"});
}

}  // namespace
}  // namespace tactus
