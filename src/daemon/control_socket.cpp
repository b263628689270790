#include "tactus/daemon/control_socket.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <iterator>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "tactus/daemon/request_refusal.h"
#include "tactus/daemon/run_status.h"
#include "tactus/record/message.h"

namespace tactus {
namespace {

constexpr int kLook_ms = 50;

bool hasRuntimeFolder() {
  const char* folder = std::getenv("RUNTIME_DIRECTORY");
  return folder && *folder;
}

/// Who has asked was told that nobody answers, or was interrupted.
bool hasLeft(const PacketSocket& socket) noexcept {
  pollfd end{socket.fd(), 0, 0};
  return ::poll(&end, 1, 0) > 0 && (end.revents & POLLHUP) != 0;
}

bool isHold(std::span<const char> room, long size) {
  const auto length = std::min(static_cast<std::size_t>(size), room.size());
  const Json request = Json::parse(room.begin(), room.begin() + length, nullptr, false);
  return request.is_object() && wishOf(request) == "hold";
}

}  // namespace

std::string controlPath() { return runtimePath(kControlName); }

ControlSocket::ControlSocket(const Scene& scene, LoopLink& link)
    : requests_(scene, link), listening_(PacketSocket::ofManager()) {
  if (!listening_.isOpen() && hasRuntimeFolder()) {
    made_path_ = controlPath();
    listening_ = PacketSocket::listenAt(made_path_, kMaxClients);
  }
  if (!listening_.isOpen()) return;
  try {
    thread_ = std::jthread([this](const std::stop_token& stop) { serve(stop); });
  } catch (const std::system_error& error) {
    throw std::system_error(error.code(), "starting the thread of the control socket");
  }
}

ControlSocket::~ControlSocket() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
  if (!made_path_.empty()) ::unlink(made_path_.c_str());
}

/// Where memory is short the arm goes on: an answer is lost, and whether its request was taken
/// shows in the next one.
void ControlSocket::serve(const std::stop_token& stop) noexcept {
  while (!stop.stop_requested()) {
    try {
      look();
    } catch (const std::exception& error) {
      clients_.clear();
      say("control socket: {}; its clients are closed", error.what());
      std::this_thread::sleep_for(std::chrono::milliseconds(kLook_ms));
    }
  }
}

/// What is new, for a while.
void ControlSocket::look() {
  const std::string news = requests_.look();
  if (!news.empty()) say("{}", news);
  const double now_s = monotonicTime_s();
  std::vector<pollfd> polled(1, {listening_.fd(), POLLIN, 0});
  for (const Client& client : clients_) {
    const bool may_speak = client.may_speak_s <= now_s;
    polled.push_back({client.socket.fd(), static_cast<short>(may_speak ? POLLIN : 0), 0});
  }
  const bool is_all_ears = std::ranges::all_of(
      clients_, [now_s](const Client& client) { return client.may_speak_s <= now_s; });
  const int ready =
      ::poll(polled.data(), polled.size(), is_all_ears ? kLook_ms : 1000 / kMessagesPerS);
  if (ready <= 0) return;
  auto client = clients_.begin();
  for (std::size_t i = 1; i < polled.size(); ++i) {
    const bool stays = polled[i].revents == 0 || hear(*client);
    client = stays ? std::next(client) : clients_.erase(client);
  }
  if (polled[0].revents != 0) accept();
}

void ControlSocket::accept() {
  PacketSocket socket = listening_.accept();
  if (!socket.isOpen()) return;
  if (clients_.size() < kMaxClients) {
    clients_.push_back({std::move(socket)});
  } else {
    socket.send(R"({"done":false,"error":"too many clients"})");
  }
}

/// False: it is to be closed.
bool ControlSocket::hear(Client& client) {
  client.may_speak_s = monotonicTime_s() + 1.0 / kMessagesPerS;
  std::array<char, kMaxControlMessage> room;
  const long size = client.socket.receive(room);
  if (size <= 0) return size < 0;
  // What nobody waits for any more would move the arm unasked. To stop it is never wrong.
  if (hasLeft(client.socket) && !isHold(room, size)) return true;
  const bool is_whole = static_cast<std::size_t>(size) <= room.size();
  const auto is_asked = [&client] { return !hasLeft(client.socket); };
  return client.socket.send(answer(room, size, is_asked)) && is_whole;
}

std::string ControlSocket::answer(std::span<char> room, long size, const IsAsked& is_asked) {
  const auto length = static_cast<std::size_t>(size);
  if (length > room.size()) return R"({"done":false,"error":"request: longer than 32768 bytes"})";
  return requests_.answer({room.data(), length}, is_asked);
}

}  // namespace tactus
