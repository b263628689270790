#include "tactus/daemon/control_client.h"

#include <gtest/gtest.h>
#include <poll.h>
#include <pthread.h>

#include <array>
#include <chrono>
#include <csignal>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "support/written_scene.h"
#include "tactus/daemon/control_requests.h"
#include "tactus/io/packet_socket.h"
#include "tactus/scene/input_error.h"
#include "tactus/scene/scene_loader.h"

namespace tactus {
namespace {

/// Answers one client until it has gone; what it orders is on its way for ever. then: after each.
void answerAll(
    const PacketSocket& listening, ControlRequests& requests, LoopLink& link,
    const std::function<void()>& then = [] {}) {
  const auto await = [](int fd) {
    pollfd waiting{fd, POLLIN, 0};
    return ::poll(&waiting, 1, 10000) > 0;
  };
  if (!await(listening.fd())) return;
  const PacketSocket client = listening.accept();
  std::array<char, 4096> room{};
  while (await(client.fd())) {
    const long size = client.receive(room);
    if (size <= 0) return;
    link.gain_reports.put({.number = 1, .state = GainState::kRamping});
    client.send(requests.answer({room.data(), static_cast<std::size_t>(size)}));
    then();
  }
}

/// A ramp of 5 T may be longer than systemd waits for a reload.
TEST(ControlClient, WaitsNoLongerForARampThanItIsTold) {
  test::WrittenScene file(0.7);
  const auto link = std::make_unique<LoopLink>();
  ControlRequests requests(loadScene(file.path(), {}), *link);
  const std::string path = file.folder().path() + "/asked";
  const PacketSocket listening = PacketSocket::listenAt(path, 1);
  file.write(0.8);
  std::thread daemon([&] { answerAll(listening, requests, *link); });
  {
    const ControlClient client(path);
    const Json answer = client.change({{"do", "reload"}}, false, 0.3);
    EXPECT_EQ(answer.at("state"), "ramping");
    EXPECT_EQ(answer.at("changes").at("controller.damping").at("to"), 0.8);
    EXPECT_EQ(answer.at("trouble"), "");
  }
  daemon.join();
}

/// The state of another's change says nothing of ours, which it may have taken back.
TEST(ControlClient, SaysThatAnotherChangeHasComeMeanwhile) {
  test::WrittenScene file(0.7);
  const auto link = std::make_unique<LoopLink>();
  ControlRequests requests(loadScene(file.path(), {}), *link);
  const std::string path = file.folder().path() + "/asked";
  const PacketSocket listening = PacketSocket::listenAt(path, 1);
  std::thread daemon(
      [&] { answerAll(listening, requests, *link, [&] { requests.answer(R"({"do":"undo"})"); }); });
  {
    const ControlClient client(path);
    const Json change = {{"do", "set"}, {"values", {{"controller.damping", 0.8}}}};
    try {
      client.change(change, true);
      ADD_FAILURE() << "another's change is told as ours";
    } catch (const InputError& error) {
      EXPECT_NE(std::string(error.what()).find("another change"), std::string::npos)
          << error.what();
    }
  }
  daemon.join();
}

/// As of Ctrl-Z and fg, or of a program that notes its Ctrl-C: what was asked is done all the same.
TEST(ControlClient, WaitsForItsAnswerThroughSignals) {
  const auto before = std::signal(SIGUSR1, [](int) {});
  test::WrittenScene file(0.7);
  const std::string path = file.folder().path() + "/asked";
  const PacketSocket listening = PacketSocket::listenAt(path, 1);
  std::thread daemon([&listening, asker = ::pthread_self()] {
    pollfd waiting{listening.fd(), POLLIN, 0};
    ASSERT_GT(::poll(&waiting, 1, 10000), 0);
    const PacketSocket client = listening.accept();
    waiting.fd = client.fd();
    ASSERT_GT(::poll(&waiting, 1, 10000), 0);
    std::array<char, 4096> room{};
    EXPECT_GT(client.receive(room), 0);  // left unread, it would reset the connection at its end
    for (int i = 0; i < 5; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      ::pthread_kill(asker, SIGUSR1);
    }
    client.send(R"({"done":true})");
  });
  EXPECT_EQ(ControlClient(path).ask({{"do", "show"}}).at("done"), true);
  daemon.join();
  std::signal(SIGUSR1, before);
}

}  // namespace
}  // namespace tactus
