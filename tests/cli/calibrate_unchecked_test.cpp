#include <algorithm>

#include "support/calibrate_session.h"
#include "tactus/cli/push_file.h"

/// Pushes that no other ones tell: what is typed wrong there would be written.
namespace tactus {
namespace {

class UncheckedPushes : public test::CalibrateSession {
 protected:
  /// Twelve pushes that check each other, and these; `typed` says what the file has.
  void recordWith(const std::vector<std::pair<KnownPush, std::string>>& more) {
    test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random_), 5), 0.005,
                               0x100);
    std::deque<test::ScriptedAnswer> script = test::scriptOf(random_, false);
    for (const auto& [push, typed] : more) {
      script.insert(script.end() - 1, {typed});
      script.insert(script.end() - 1, test::held(push));
    }
    std::filesystem::remove(path("pushes.yaml"));
    record(module, script);
  }

  std::string text() {
    std::string output;
    EXPECT_EQ(
        test::runCommand(addCalibrateCommand,
                         {"calibrate", "fit", path("pushes.yaml"), path("scene.yaml")}, output),
        kExitDone);
    return output;
  }

  std::string refusalToWrite() {
    try {
      fit({"--write"});
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  test::Random random_{51};
};

const KnownPush kTurned{4.0, 0.0, 0.19, 0.3}, kTurnedBack{0.0, 4.0, 0.1, -0.3};

TEST_F(UncheckedPushes, AreNamedAndNotWritten) {
  recordWith({{kTurned, "4 +y 0.19 3.0"}});  // ten times as much as it was
  const int line = readPushFile(path("pushes.yaml")).pushes.back().at.line;
  EXPECT_EQ(fit()["unchecked_lines"], Json({line}));
  const std::string said = fmt::format("line {} is checked by nothing", line);
  EXPECT_NE(text().find("\nunchecked  " + said + ": one more of each\n"), std::string::npos);
  const std::string before = folder_.content("robot.yaml"), refused = refusalToWrite();
  EXPECT_NE(refused.find(said + ", so nothing is written, expected one more push"),
            std::string::npos)
      << refused;
  EXPECT_EQ(folder_.content("robot.yaml"), before);
  EXPECT_FALSE(folder_.has("robot.yaml~"));
}

TEST_F(UncheckedPushes, AreNoneWhereEachKindIsThereTwice) {
  recordWith({});
  EXPECT_EQ(fit()["unchecked_lines"], Json::array());
  EXPECT_EQ(text().find("unchecked"), std::string::npos);
  recordWith({{kTurned, "4 +y 0.19 0.3"}, {kTurnedBack, "4 +z 0.1 -0.3"}});
  const Json found = fit({"--write"});
  EXPECT_EQ(found["unchecked_lines"], Json::array());
  EXPECT_EQ(found["written"], path("robot.yaml"));
  recordWith({{kTurned, "4 +y 0.19 3.0"}, {kTurnedBack, "4 +z 0.1 -0.3"}});
  EXPECT_NE(refusal().find("records: this push"), std::string::npos) << refusal();
}

/// What is refused above 15 % is the largest share, and so is what is shown.
TEST_F(UncheckedPushes, WorstIsTheOneThatIsOffByTheLargestShare) {
  recordWith({{{4.0, 0.0, 0.1}, "4 +y 0.12"}, {{0.0, 4.0, 0.3}, "4 +z 0.28"}});
  const Json found = fit();
  const auto farthest = std::ranges::max_element(found["pushes"], {}, [](const Json& push) {
    return push["left_out"]["share"].get<double>();
  });
  EXPECT_EQ(found["worst_line"], (*farthest)["line"]);
  const auto share = (*farthest)["left_out"]["share"].get<double>();
  EXPECT_NE(text().find(fmt::format("worst      line {}: {:.1f} %", (*farthest)["line"].get<int>(),
                                    100.0 * share)),
            std::string::npos);
}

TEST_F(UncheckedPushes, AtOnePlaceAreToldSo) {
  test::VirtualModule module(test::channelsWith(test::hiddenCalibration(random_), 4), 0.005, 0x100);
  std::deque<test::ScriptedAnswer> script = test::scriptOf(random_, false);
  script.erase(script.begin() + 1, script.end() - 9);  // those at 0.34 m stay
  record(module, script);
  EXPECT_NE(refusal().find("are all at one place along the cover and hardly tell M_"),
            std::string::npos)
      << refusal();
}

}  // namespace
}  // namespace tactus
