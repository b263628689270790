#include "tactus/daemon/control_socket.h"

#include <gtest/gtest.h>
#include <linux/sockios.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <system_error>
#include <vector>

#include "support/run_folder.h"
#include "support/shipped_scene.h"
#include "support/tool_sight.h"
#include "support/unread_stderr.h"
#include "tactus/daemon/control_client.h"
#include "tactus/io/packet_socket.h"
#include "tactus/record/run_error.h"

namespace tactus {
namespace {

class ControlSocketTest : public testing::Test {
 protected:
  static int connect(const std::string& path) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path.copy(address.sun_path, path.size());
    const int fd = ::socket(AF_UNIX, SOCK_SEQPACKET, 0);
    EXPECT_EQ(::connect(fd, reinterpret_cast<sockaddr*>(&address), sizeof(address)), 0);
    return fd;
  }

  static PacketSocket asker() { return PacketSocket::connectTo(controlPath(), 60.0); }
  static Json answerTo(const PacketSocket& asker) {
    std::string room(4096, ' ');
    room.resize(static_cast<std::size_t>(std::max(0L, asker.receive(room))));
    return Json::parse(room);
  }

  void runAtStart() {
    ToolSight sight;
    test::placeAtStart(scene_.controller, true, sight);
    link_->tool_sights.put(sight);
  }

  const test::RunFolder folder_;
  const Scene scene_ = test::shippedScene("commands");
  const std::unique_ptr<LoopLink> link_ = std::make_unique<LoopLink>();
};

TEST_F(ControlSocketTest, AnswersAndHandsOn) {
  const ControlSocket socket(scene_, *link_);
  struct stat status {};
  ASSERT_EQ(::stat(controlPath().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0660u);
  const ControlClient client(controlPath());
  EXPECT_EQ(client.ask({{"do", "show"}}).at("state"), "kept");
  // Of all orders the one that takes no time to check.
  ToolSight sight;
  sight.is_running = true;
  link_->tool_sights.put(sight);
  client.ask({{"do", "hold"}});
  ToolOrder order;
  ASSERT_TRUE(link_->tool_holds.take(order));
  EXPECT_EQ(order.kind, ToolOrder::Kind::kHold);
  EXPECT_THROW(client.ask({{"do", "jump"}}), InputError);
}

/// As of a service manager: open before the daemon is.
class ManagedSocket {
 public:
  explicit ManagedSocket(const std::string& path)
      : before_(::dup(SD_LISTEN_FDS_START)), listening_(PacketSocket::listenAt(path, 8)) {
    EXPECT_EQ(::dup2(listening_.fd(), SD_LISTEN_FDS_START), SD_LISTEN_FDS_START);
    ::setenv("LISTEN_PID", std::to_string(::getpid()).c_str(), 1);
    ::setenv("LISTEN_FDS", "1", 1);
  }
  ~ManagedSocket() {
    if (before_ < 0) return;
    ::dup2(before_, SD_LISTEN_FDS_START);
    ::close(before_);
  }
  ManagedSocket(const ManagedSocket&) = delete;
  ManagedSocket& operator=(const ManagedSocket&) = delete;

 private:
  int before_;
  PacketSocket listening_;
};

/// An arm that moves by what somebody has asked in vain does so unasked. To stop is never wrong.
TEST_F(ControlSocketTest, TakesOfWhoHasLeftNothingButAHold) {
  const ManagedSocket managed(controlPath());
  const std::string stream = R"({"do": "stream", "to_m": [0, 0.001, 0], "relative": true})";
  const std::string hold = R"({"do": "hold"})";
  for (const std::string& request : {stream, stream, hold}) {
    const int fd = connect(controlPath());
    EXPECT_EQ(::send(fd, request.data(), request.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(request.size()));
    ::close(fd);
  }
  ToolSight sight;
  sight.is_running = true;
  link_->tool_sights.put(sight);
  const ControlSocket socket(scene_, *link_);
  const ControlClient client(controlPath());
  client.ask({{"do", "show"}});  // behind all of them
  ToolOrder order;
  EXPECT_TRUE(link_->tool_holds.take(order));
  EXPECT_FALSE(link_->tool_orders.pop(order));
  client.ask(Json::parse(stream));
  ASSERT_TRUE(link_->tool_orders.pop(order));
  EXPECT_EQ(order.kind, ToolOrder::Kind::kStream);
}

constexpr const char* kHold = R"({"do": "hold"})";
constexpr const char* kShow = R"({"do": "show"})";
constexpr const char* kStream = R"({"do": "stream", "to_m": [0, 0.001, 0], "relative": true})";

/// Whoever connected first, and although the stream came first.
TEST_F(ControlSocketTest, AnswersAHoldBeforeWhatWaits) {
  const ManagedSocket managed(controlPath());
  const PacketSocket streamer = asker(), holder = asker();
  EXPECT_TRUE(streamer.send(kStream));
  EXPECT_TRUE(holder.send(kHold));
  runAtStart();
  const ControlSocket socket(scene_, *link_);
  EXPECT_EQ(answerTo(holder).at("done"), true);
  EXPECT_EQ(answerTo(streamer).value("error", ""), "a hold has come meanwhile");
  ToolOrder order;
  EXPECT_TRUE(link_->tool_holds.take(order));
  EXPECT_FALSE(link_->tool_orders.pop(order));
}

/// Also of whoever connects while something else takes long.
TEST_F(ControlSocketTest, TakesNothingBehindAHoldThatCameBefore) {
  const ControlSocket socket(scene_, *link_);
  runAtStart();
  const PacketSocket holder = asker(), follower = asker();
  Json follow = {{"do", "follow"}, {"waypoints", Json::array()}};
  for (int i = 0; i < 200; ++i)
    follow["waypoints"].push_back({{"to_m", {0, 0.05 * (i % 2), 0}}, {"relative", true}});
  EXPECT_TRUE(follower.send(follow.dump()));
  const PacketSocket streamer = asker();
  EXPECT_TRUE(streamer.send(kStream));
  EXPECT_TRUE(holder.send(kHold));
  const Json held = answerTo(holder), streamed = answerTo(streamer);
  ASSERT_EQ(held.at("done"), true) << held;
  if (streamed.at("done") == true) {
    EXPECT_LT(streamed.at("task").at("number"), held.at("task").at("number"));
  }
  answerTo(follower);
}

/// Also of whoever connects only then. A machine that is busy may be done with the check first.
TEST_F(ControlSocketTest, AHoldThatComesWhileAFollowIsCheckedHasItRefused) {
  const ControlSocket socket(scene_, *link_);
  runAtStart();
  Json follow = {{"do", "follow"}, {"waypoints", Json::array()}};
  for (int i = 0; i < 256; ++i)
    follow["waypoints"].push_back(
        {{"to_m", {0, i % 2 == 0 ? 0.05 : -0.05, 0}}, {"relative", true}});
  bool is_refused = false;
  for (int attempt = 0; attempt < 10 && !is_refused; ++attempt) {
    const PacketSocket follower = asker();
    EXPECT_TRUE(follower.send(follow.dump()));
    for (int unread = 1; unread != 0; ::usleep(100))
      ASSERT_EQ(::ioctl(follower.fd(), SIOCOUTQ, &unread), 0);
    const PacketSocket holder = asker();
    EXPECT_TRUE(holder.send(kHold));
    EXPECT_EQ(answerTo(holder).at("done"), true);
    const std::string refusal = answerTo(follower).value("error", "");
    is_refused = refusal == "a hold has come meanwhile";
    EXPECT_TRUE(is_refused || refusal.empty()) << refusal;
    ToolOrder order;
    EXPECT_EQ(link_->tool_orders.pop(order), !is_refused);
    while (link_->tool_orders.pop(order)) continue;
  }
  EXPECT_TRUE(is_refused);
}

/// Of all that had come, and of nothing that comes later.
TEST_F(ControlSocketTest, AHoldOvertakesWhatWaitsInASocketToo) {
  const ManagedSocket managed(controlPath());
  runAtStart();
  const PacketSocket streamer = asker(), holder = asker();
  for (int i = 0; i < 2; ++i) EXPECT_TRUE(streamer.send(kStream));
  EXPECT_TRUE(holder.send(kHold));
  const ControlSocket socket(scene_, *link_);
  EXPECT_EQ(answerTo(holder).at("done"), true);
  for (int i = 0; i < 2; ++i)
    EXPECT_EQ(answerTo(streamer).value("error", ""), "a hold has come meanwhile");
  EXPECT_TRUE(streamer.send(kShow));
  EXPECT_EQ(answerTo(streamer).at("done"), true);
  EXPECT_TRUE(streamer.send(kStream));
  EXPECT_NE(answerTo(streamer).value("error", "").find("expected it to pause"), std::string::npos);
}

/// As open panels do, and who waits for a change to be kept.
class CrowdedControlSocket : public ControlSocketTest {
 protected:
  CrowdedControlSocket() {
    runAtStart();
    for (int i = 0; i < ControlSocket::kMaxClients; ++i) {
      silent_.push_back(asker());
      EXPECT_TRUE(silent_.back().send(kShow));
      EXPECT_EQ(answerTo(silent_.back()).at("done"), true);
    }
  }

  static std::string refusal(const ControlClient& client, const Json& request) {
    try {
      client.ask(request);
      return "";
    } catch (const InputError& error) {
      return error.what();
    }
  }

  const ControlSocket socket_{scene_, *link_};
  std::vector<PacketSocket> silent_;
};

TEST_F(CrowdedControlSocket, TakesAHoldOfOneMore) {
  for (int i = 0; i < 3; ++i) {
    const ControlClient holder(controlPath());
    EXPECT_EQ(holder.ask({{"do", "hold"}}).at("done"), true);
    ToolOrder order;
    EXPECT_TRUE(link_->tool_holds.take(order));
  }
}

TEST_F(CrowdedControlSocket, TellsOneMoreWhoWantsAnythingElseWhyNot) {
  for (const char* request : {kShow, kStream}) {
    const PacketSocket other = asker();
    EXPECT_TRUE(other.send(request));
    EXPECT_EQ(answerTo(other).value("error", ""), "too many clients");
    EXPECT_EQ(refusal(ControlClient(controlPath()), Json::parse(request)), "too many clients");
  }
  ToolOrder order;
  EXPECT_FALSE(link_->tool_orders.pop(order));
}

/// Else it would shut out a hold as all the others do.
TEST_F(CrowdedControlSocket, IsNotShutByOneMoreThatIsSilent) {
  const ControlClient silent(controlPath());
  ToolOrder order;
  for (int i = 0; i < 3; ++i) {
    const PacketSocket holder = asker();
    EXPECT_TRUE(holder.send(kHold));
    EXPECT_EQ(answerTo(holder).at("done"), true);
    EXPECT_TRUE(link_->tool_holds.take(order));
  }
  EXPECT_EQ(refusal(silent, {{"do", "show"}}), "too many clients") << "what it was told before";
}

TEST_F(CrowdedControlSocket, GivesAPlaceThatIsFreeToWhoWasOneMore) {
  const ControlClient one_more(controlPath());
  EXPECT_EQ(one_more.ask({{"do", "hold"}}).at("done"), true);
  silent_.pop_back();
  EXPECT_EQ(one_more.ask({{"do", "show"}}).at("done"), true);
  const ControlClient next(controlPath());
  EXPECT_EQ(next.ask({{"do", "hold"}}).at("done"), true);
  EXPECT_EQ(one_more.ask({{"do", "show"}}).at("done"), true) << "it has a place";
}

TEST_F(ControlSocketTest, LeavesAPathToTheDaemonThatAnswersThere) {
  const ControlSocket socket(scene_, *link_);
  const auto other = std::make_unique<LoopLink>();
  EXPECT_THROW(ControlSocket(scene_, *other), std::system_error);
  const ControlClient client(controlPath());
  EXPECT_EQ(client.ask({{"do", "show"}}).at("done"), true);
}

/// What the journal is told of gains must not cost the answer to a hold.
TEST_F(ControlSocketTest, AnswersThoughNobodyReadsTheJournal) {
  const Scene scene = test::shippedScene("scenario2_tactus");
  const ControlSocket socket(scene, *link_);
  const ControlClient client(controlPath());
  const test::UnreadStderr pipe;
  client.ask({{"do", "set"}, {"values", {{"controller.damping", 0.7}}}});
  GainOrder order;
  ASSERT_TRUE(link_->gain_orders.take(order));
  const auto report = [&](GainState state) {
    GainReport made;
    made.number = order.number;
    made.state = state;
    link_->gain_reports.put(made);
    // Behind the second answer the socket has looked, and said what it saw.
    for (int i = 0; i < 2; ++i) client.ask({{"do", "show"}});
  };
  report(GainState::kRamping);
  report(GainState::kOnTrial);
  pipe.read();
  report(GainState::kKept);
  const std::string said = pipe.read();
  EXPECT_NE(said.find("that are lost: 2\ntactusd: gains: "), std::string::npos) << said;
}

TEST_F(ControlSocketTest, IsGoneWithTheDaemon) {
  { const ControlSocket socket(scene_, *link_); }
  EXPECT_FALSE(folder_.has(kControlName));
  EXPECT_THROW(ControlClient{controlPath()}, RunError);
}

TEST_F(ControlSocketTest, OutlivesHostileClients) {
  const ControlSocket socket(scene_, *link_);
  std::vector<int> clients;
  const std::string flood(40000, '{');
  for (int i = 0; i < 40; ++i) {
    clients.push_back(connect(controlPath()));
    ::send(clients.back(), flood.data(), i % 2 == 0 ? flood.size() : 100, MSG_NOSIGNAL);
    for (int k = 0; k < 20; ++k) ::send(clients.back(), "{}", 2, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (i % 3 == 0) ::close(clients.back());
  }
  for (std::size_t i = 0; i < clients.size(); ++i)
    if (i % 3 != 0) ::close(clients[i]);
  // Their places are free once the daemon has seen that they left.
  for (int attempt = 0;; ++attempt) {
    try {
      const ControlClient client(controlPath());
      EXPECT_EQ(client.ask({{"do", "show"}}).at("done"), true);
      break;
    } catch (const std::exception& error) {
      ASSERT_LT(attempt, 200) << error.what();
      ::usleep(20'000);
    }
  }
}

TEST_F(ControlSocketTest, DoesNotExistWithoutAFolder) {
  unsetenv("RUNTIME_DIRECTORY");
  const ControlSocket socket(scene_, *link_);
  EXPECT_FALSE(folder_.has(kControlName));
}

}  // namespace
}  // namespace tactus
