#include "tactus/daemon/gain_save.h"

#include <gtest/gtest.h>
#include <poll.h>

#include <array>
#include <fstream>
#include <functional>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/written_scene.h"
#include "tactus/daemon/control_requests.h"
#include "tactus/io/packet_socket.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

constexpr const char* kSet = R"({"do": "set", "values": {"controller.damping": 0.8}})";

/// Answers two requests, show and the reload behind what was written, and lets something happen
/// between them; or the first alone.
class Daemon {
 public:
  Daemon(const std::string& path, ControlRequests& requests, std::function<void()> between,
         bool ends)
      : listening_(PacketSocket::listenAt(path, 1)), thread_([this, &requests, between, ends] {
          const PacketSocket client = accepted();
          answer(client, requests);
          between();
          if (!ends) answer(client, requests);
        }) {}
  ~Daemon() { thread_.join(); }

 private:
  static void await(int fd) {
    pollfd waiting{fd, POLLIN, 0};
    ::poll(&waiting, 1, 10000);
  }
  PacketSocket accepted() const {
    await(listening_.fd());
    return listening_.accept();
  }
  static void answer(const PacketSocket& client, ControlRequests& requests) {
    std::array<char, 4096> room{};
    await(client.fd());
    const long size = client.receive(room);
    if (size > 0) client.send(requests.answer({room.data(), static_cast<std::size_t>(size)}));
  }

  const PacketSocket listening_;
  std::thread thread_;
};

class SavedGainsTest : public testing::Test {
 protected:
  explicit SavedGainsTest(const std::vector<Override>& settings = {})
      : requests_(loadScene(file_.path(), settings), *link_) {}

  SavedGains save(std::function<void()> between, bool ends = false) {
    const std::string socket = file_.folder().path() + "/asked";
    const Daemon daemon(socket, requests_, std::move(between), ends);
    return saveGains(ControlClient(socket));
  }

  std::string keptText() const {
    std::ifstream in(file_.path() + "~");
    return {std::istreambuf_iterator<char>(in), {}};
  }

  test::WrittenScene file_{0.7};
  const std::unique_ptr<LoopLink> link_ = std::make_unique<LoopLink>();
  ControlRequests requests_;
};

TEST_F(SavedGainsTest, AreInTheFileWhichTheDaemonHasRead) {
  requests_.answer(kSet);
  const SavedGains saved = save([] {});
  EXPECT_TRUE(saved.is_new);
  EXPECT_NE(saved.state, "kept") << "they are on trial";
  EXPECT_NE(file_.text().find("damping: 0.8"), std::string::npos);
  const Json shown = Json::parse(requests_.answer(R"({"do": "show"})"));
  EXPECT_EQ(shown.at("scene_hash"), file_.hash());
  EXPECT_EQ(shown.at("number"), 1) << "nothing was ordered by that";
}

TEST_F(SavedGainsTest, ThatWentBackMeanwhileNeitherReturnNorStayInTheFile) {
  const std::string before = file_.text();
  requests_.answer(kSet);
  const auto fail = [&] {
    link_->gain_reports.put(
        {.number = 1, .state = GainState::kKept, .trouble = GainTrouble::kFault});
  };
  EXPECT_THROW(save(fail), RunError);
  EXPECT_EQ(file_.text(), before);
  EXPECT_EQ(keptText(), before) << "and no refused gains beside it";
  const Json shown = Json::parse(requests_.answer(R"({"do": "show"})"));
  EXPECT_EQ(shown.at("scene_hash"), file_.hash());
  EXPECT_EQ(shown.at("ordered").at("controller.damping"), 0.7);
  EXPECT_EQ(shown.at("number"), 1);
}

TEST_F(SavedGainsTest, AreInTheFileOfADaemonThatEndsBeforeItReadsIt) {
  requests_.answer(kSet);
  try {
    save([] {}, true);
    ADD_FAILURE() << "did not look whether the daemon reads it";
  } catch (const RunError& error) {
    EXPECT_NE(std::string(error.what()).find(": is written, but the daemon may not have read it"),
              std::string::npos)
        << error.what();
  }
  EXPECT_NE(file_.text().find("damping: 0.8"), std::string::npos);
}

TEST_F(SavedGainsTest, AreNotThoseOfATime) {
  const std::string before = file_.text();
  requests_.answer(R"({"do": "set", "values": {"controller.damping": 0.8}, "for_s": 5})");
  try {
    save([] {}, true);
    ADD_FAILURE() << "saved what goes back";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("for a time"), std::string::npos) << error.what();
  }
  EXPECT_EQ(file_.text(), before);
}

/// Else saving would write over what nobody has read.
TEST_F(SavedGainsTest, AreNotReadByAReloadThatIsRefused) {
  const auto shown = [this] { return Json::parse(requests_.answer(R"({"do": "show"})")); };
  requests_.answer(kSet);
  link_->gain_reports.put(
      {.number = 1, .state = GainState::kGoingBack, .trouble = GainTrouble::kFault});
  const Json before = shown();
  std::ofstream(file_.path(), std::ios::app) << "  contact_threshold_N: 0.6\n";
  const Json refused = Json::parse(requests_.answer(R"({"do": "reload"})"));
  EXPECT_NE(refused.value("error", "").find("while gains go back"), std::string::npos) << refused;
  EXPECT_EQ(shown(), before);
  EXPECT_NE(before.at("scene_hash"), file_.hash());
  link_->gain_reports.put({.number = 1, .state = GainState::kKept, .trouble = GainTrouble::kFault});
  shown();
  EXPECT_EQ(Json::parse(requests_.answer(R"({"do": "reload"})")).at("done"), true);
  EXPECT_EQ(shown().at("scene_hash"), file_.hash());
}

/// A daemon that was started with --set controller.damping=0.9.
class SetAtTheStart : public SavedGainsTest {
 protected:
  SetAtTheStart() : SavedGainsTest({{"controller.damping", "0.9"}}) {}

  double ordered() {
    return Json::parse(requests_.answer(R"({"do": "show"})"))
        .at("ordered")
        .at("controller.damping");
  }
  Json reload() { return Json::parse(requests_.answer(R"({"do": "reload"})")); }
};

TEST_F(SetAtTheStart, IsWrittenAndHolds) {
  EXPECT_TRUE(save([] {}).is_new);
  EXPECT_NE(file_.text().find("damping: 0.9"), std::string::npos) << file_.text();
  EXPECT_TRUE(reload().at("changes").empty());
  file_.write(0.7);
  EXPECT_TRUE(reload().at("changes").empty()) << "the --set of the start still holds";
}

/// What runs is written, and neither the file's value of before nor the start's comes back.
TEST_F(SetAtTheStart, GivesWayToWhatIsSaved) {
  requests_.answer(kSet);
  EXPECT_TRUE(save([] {}).is_new);
  EXPECT_NE(file_.text().find("damping: 0.8"), std::string::npos) << file_.text();
  EXPECT_TRUE(gainDifferences(file_.path(),
                              Json::parse(requests_.answer(R"({"do": "show"})")).at("ordered"))
                  .empty());
  EXPECT_TRUE(reload().at("changes").empty());
  EXPECT_EQ(ordered(), 0.8);
  file_.write(0.85);
  EXPECT_EQ(reload().at("changes").at("controller.damping").at("to"), 0.85);
}

TEST_F(SetAtTheStart, HidesNoGainsThatWentBackMeanwhile) {
  const std::string before = file_.text();
  requests_.answer(kSet);
  EXPECT_THROW(save([&] {
                 link_->gain_reports.put(
                     {.number = 1, .state = GainState::kKept, .trouble = GainTrouble::kFault});
               }),
               RunError);
  EXPECT_EQ(file_.text(), before);
  EXPECT_EQ(ordered(), 0.9);
}

/// A daemon that was started with a section of --set, whose other keys hold on.
class SectionSetAtTheStart : public SavedGainsTest {
 protected:
  SectionSetAtTheStart()
      : SavedGainsTest({{"controller", "{damping: 0.9, time_constant_s: 0.06}"}}) {}
};

TEST_F(SectionSetAtTheStart, GivesWayToWhatIsSaved) {
  requests_.answer(kSet);
  EXPECT_TRUE(save([] {}).is_new);
  EXPECT_NE(file_.text().find("damping: 0.8"), std::string::npos) << file_.text();
  const Json reload = Json::parse(requests_.answer(R"({"do": "reload"})"));
  EXPECT_TRUE(reload.at("changes").empty()) << reload;
  EXPECT_EQ(reload.at("ordered").at("controller.damping"), 0.8);
  EXPECT_EQ(reload.at("ordered").at("controller.time_constant_s"), 0.06);
}

}  // namespace
}  // namespace tactus
