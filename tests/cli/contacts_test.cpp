#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "support/command_run.h"
#include "support/run_folder.h"
#include "support/shipped_scene.h"
#include "support/telemetry.h"
#include "tactus/cli/commands.h"
#include "tactus/daemon/run_status.h"
#include "tactus/record/run_log.h"
#include "tactus/run/simulation.h"
#include "tactus/scene/json.h"

namespace tactus {
namespace {

/// The log of a simulated scene, and what is known of its contacts otherwise.
struct LoggedRun {
  explicit LoggedRun(const std::string& name) : scene(test::shippedScene(name)) {
    figures =
        simulate(scene, [&](const CycleRecord& record) { records.push_back(record); }).figures;
    log.setContent(test::writeLog(describeLog(scene), records));
  }

  Json contacts() const {
    std::string output;
    EXPECT_EQ(test::runCommand(addContactsCommand, {"contacts", log.path(), "--json"}, output), 0);
    return Json::parse(output);
  }

  /// As the daemon's log, cut into files, some of them in the middle of a contact. How many.
  int writeFiles(const test::RunFolder& folder) const {
    Scene cut = scene;
    cut.log.max_bytes = static_cast<double>(log.content().size()) / 5.0 + 3e5;
    cut.log.keep = 20;
    RunLog files(cut, folder.path());
    for (const CycleRecord& record : records) files.write(record);
    files.close();
    EXPECT_EQ(files.state().stop_reason, "");
    return files.state().files;
  }

  Scene scene;
  std::vector<CycleRecord> records;
  RunFigures figures;
  test::TemporaryFile log{".ulg"};
};

TEST(Contacts, AreThoseOfTheSummary) {
  const LoggedRun run("whole_arm/crops9_skin_two_links");
  const Json contacts = run.contacts();
  ASSERT_EQ(contacts.size(), run.figures.contacts.size());
  ASSERT_GE(contacts.size(), 2u);
  EXPECT_EQ(contacts, summaryJson(run.scene, run.figures, 1.0).at("contacts"));
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const ContactSummary& expected = run.figures.contacts[i];
    EXPECT_EQ(contacts[i].at("start_s"), expected.start_s);
    EXPECT_EQ(contacts[i].at("peak_force_N"), expected.peak_force_N);
    EXPECT_EQ(contacts[i].at("settling_s"), expected.settling_s);
    EXPECT_EQ(contacts[i].at("tactile_module"),
              run.scene.module_links[static_cast<std::size_t>(expected.module)]);
    EXPECT_LE(contacts[i].at("rest_force_N"), expected.peak_force_N);
    EXPECT_LE(contacts[i].at("tcp_error_max_m"), run.figures.tcp_error_max_m);
  }
}

/// The springs of the scenes in series with what gives way before them.
TEST(Contacts, TellHowStiffTheyWere) {
  for (const auto& [name, stiffness_N_per_m] :
       {std::pair{"scenario1_multi_space", 1.0 / (1.0 / 60.0 + 1.0 / 7000.0)},
        std::pair{"scenario2_tactus", 1.0 / (1.0 / 30.0 + 1.0 / 7000.0)},
        std::pair{"scenario3_tactus", 1.0 / (1.0 / 1400.0 + 1.0 / 17000.0 + 1.0 / 7000.0)}}) {
    const Json fit = LoggedRun(name).contacts()[0].at("contact_stiffness_N_per_m");
    EXPECT_NEAR(fit.at("value"), stiffness_N_per_m, 0.01 * stiffness_N_per_m) << name;
    EXPECT_LE(fit.at("low"), fit.at("value"));
    EXPECT_GE(fit.at("high"), fit.at("value"));
    EXPECT_LT(fit.at("high"), 1.08 * stiffness_N_per_m) << name;
  }
}

std::vector<Json> followedContacts(std::vector<std::string> arguments) {
  std::string output;
  EXPECT_EQ(test::runCommand(addContactsCommand, std::move(arguments), output), 0);
  std::istringstream lines(output);
  std::vector<Json> followed;
  for (std::string line; std::getline(lines, line);) followed.push_back(Json::parse(line));
  std::ranges::sort(followed, {},
                    [](const Json& contact) { return contact.at("start_s").get<double>(); });
  return followed;
}

/// A run that has ended, by its summary.
TEST(Contacts, FollowedAreTheSame) {
  for (const char* name : {"whole_arm/crops9_skin_two_links", "scenario2_tactus"}) {
    const LoggedRun run(name);
    const test::RunFolder folder;
    std::filesystem::copy_file(run.log.path(), folder.path() + "/run.ulg");
    std::ofstream(folder.path() + "/summary.json") << "{}";
    EXPECT_EQ(
        Json(followedContacts({"contacts", folder.path() + "/run.ulg", "--json", "--follow"})),
        run.contacts());
  }
}

TEST(Contacts, OfTheDaemonThatRunsAreThoseOfAllItsFiles) {
  const LoggedRun run("whole_arm/crops9_skin_two_links");
  const test::RunFolder folder;
  ASSERT_GE(run.writeFiles(folder), 3);
  const auto tellThatItRuns = [&] {
    std::ofstream(folder.path() + "/status.json")
        << Json({{"monotonic_s", monotonicTime_s()}, {"log", {{"folder", folder.path()}}}});
  };
  std::ofstream(folder.path() + "/summary.json") << "{}";
  std::string output;
  tellThatItRuns();
  ASSERT_EQ(test::runCommand(addContactsCommand, {"contacts", "--json"}, output), 0);
  EXPECT_EQ(Json::parse(output), run.contacts());
  tellThatItRuns();
  EXPECT_EQ(Json(followedContacts({"contacts", "--json", "--follow"})), run.contacts());
}

/// The newest file alone: where its run goes on from another one is said.
TEST(Contacts, OfAPartOfARunDoNotPassForThoseOfAll) {
  const LoggedRun run("whole_arm/crops9_skin_two_links");
  const test::RunFolder folder;
  const int files = run.writeFiles(folder);
  std::ofstream(folder.path() + "/summary.json") << "{}";
  const auto said = [&](const std::string& name, bool follows) {
    std::vector<std::string> arguments{"contacts", folder.path() + "/" + name};
    if (follows) arguments.emplace_back("--follow");
    std::string output;
    testing::internal::CaptureStderr();
    EXPECT_EQ(test::runCommand(addContactsCommand, std::move(arguments), output), 0);
    return testing::internal::GetCapturedStderr();
  };
  for (const bool follows : {false, true}) {
    EXPECT_NE(said("run.ulg", follows).find("/run.ulg: begins at "), std::string::npos);
    EXPECT_EQ(said(logName(files - 1), follows), "");
  }
}

TEST(Contacts, OfARunWithoutAny) {
  const LoggedRun run("free_motion");
  EXPECT_TRUE(run.contacts().empty());
  std::string output;
  EXPECT_EQ(test::runCommand(addContactsCommand, {"contacts", run.log.path()}, output), 0);
  EXPECT_EQ(output, "no contact\n");
}

}  // namespace
}  // namespace tactus
