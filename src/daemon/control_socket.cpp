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
constexpr const char* kTooMany = R"({"done":false,"error":"too many clients"})";

bool hasRuntimeFolder() {
  const char* folder = std::getenv("RUNTIME_DIRECTORY");
  return folder && *folder;
}

bool isReady(const PacketSocket& socket) noexcept {
  pollfd ready{socket.fd(), POLLIN, 0};
  return ::poll(&ready, 1, 0) > 0;
}

/// Who has asked was told that nobody answers, or was interrupted.
bool hasLeft(const PacketSocket& socket) noexcept {
  pollfd end{socket.fd(), 0, 0};
  return ::poll(&end, 1, 0) > 0 && (end.revents & POLLHUP) != 0;
}

bool isHold(std::string_view message) {
  const Json request = Json::parse(message, nullptr, false);
  return request.is_object() && wishOf(request) == "hold";
}

}  // namespace

std::string controlPath() { return runtimePath(kControlName); }

ControlSocket::ControlSocket(const Scene& scene, LoopLink& link)
    : link_(link), requests_(scene, link), listening_(PacketSocket::ofManager()) {
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
  receive();
  answerOne();
}

/// A request of each client that waits for none.
void ControlSocket::receive() {
  const double now_s = monotonicTime_s();
  std::vector<pollfd> polled(1, {listening_.fd(), POLLIN, 0});
  for (const Client& client : clients_) {
    const bool may_speak = client.may_speak_s <= now_s && client.request.empty();
    polled.push_back({client.socket.fd(), static_cast<short>(may_speak ? POLLIN : 0), 0});
  }
  await(polled);
  auto client = clients_.begin();
  for (std::size_t i = 1; i < polled.size(); ++i) {
    const bool is_new = polled[i].revents != 0 && client->request.empty();
    const bool stays = !is_new || hear(*client);
    client = stays ? std::next(client) : clients_.erase(client);
  }
  acceptAll();
}

/// As poll(). What is there at once came since the last look, which may be long ago.
void ControlSocket::await(std::vector<pollfd>& polled) {
  const auto cycle = [this] { return link_.pulse.cycles.load(std::memory_order_relaxed); };
  const std::int64_t before = std::exchange(looked_at_cycle_, cycle());
  const auto count = ::poll(polled.data(), polled.size(), 0);
  came_after_cycle_ = before;
  const bool has_to_answer =
      std::ranges::any_of(clients_, [](const Client& client) { return !client.request.empty(); });
  if (count != 0 || has_to_answer) return;
  const double now_s = monotonicTime_s();
  const bool is_all_ears = std::ranges::all_of(
      clients_, [now_s](const Client& client) { return client.may_speak_s <= now_s; });
  ::poll(polled.data(), polled.size(), is_all_ears ? kLook_ms : 1000 / kMessagesPerS);
  came_after_cycle_ = looked_at_cycle_;
}

void ControlSocket::acceptAll() {
  for (int i = 0; i < kMaxClients && isReady(listening_); ++i) accept();
}

void ControlSocket::accept() {
  PacketSocket socket = listening_.accept();
  if (!socket.isOpen()) return;
  if (makeRoom()) {
    clients_.push_back({.socket = std::move(socket), .is_extra = clients_.size() >= kMaxClients});
    return;
  }
  std::array<char, 1> room;
  socket.receive(room);  // closed with a request unread, the other side would see that alone
  socket.send(kTooMany);
}

/// False: the extra client wants something, which comes first. One that is silent has to go, as the
/// next may want to hold.
bool ControlSocket::makeRoom() {
  if (clients_.size() <= kMaxClients) {  // with places for all that are here
    for (Client& client : clients_) client.is_extra = false;
    return true;
  }
  const auto extra = std::ranges::find_if(clients_, &Client::is_extra);
  if (!extra->request.empty() || extra->socket.waiting() > 0) return false;
  extra->socket.send(kTooMany);
  clients_.erase(extra);
  return true;
}

/// False: it is to be closed.
bool ControlSocket::hear(Client& client) {
  client.may_speak_s = monotonicTime_s() + 1.0 / kMessagesPerS;
  std::array<char, kMaxControlMessage> room;
  const long size = client.socket.receive(room);
  if (size <= 0) return size < 0;
  if (static_cast<std::size_t>(size) > room.size()) {
    client.socket.send(R"({"done":false,"error":"request: longer than 32768 bytes"})");
    return false;
  }
  client.request.assign(room.data(), static_cast<std::size_t>(size));
  client.is_hold = isHold(client.request);
  if (client.is_extra && clients_.size() > kMaxClients && !client.is_hold) {
    client.socket.send(kTooMany);
    return false;
  }
  client.asker = {.waits = [&client] { return !hasLeft(client.socket); },
                  .hold_comes = [this] { return holdComes(); },
                  .is_overtaken = client.overtaken_bytes > 0,
                  .came_after_cycle = came_after_cycle_};
  client.overtaken_bytes -= std::min(size, client.overtaken_bytes);
  return true;
}

/// Next of a client, also of one that has connected while a request is answered. None is longer.
bool ControlSocket::holdComes() {
  acceptAll();
  return std::ranges::any_of(clients_, [](const Client& client) {
    std::array<char, 256> room;
    const long size = client.socket.peek(room);
    const bool is_whole = size > 0 && static_cast<std::size_t>(size) <= room.size();
    return is_whole && isHold({room.data(), static_cast<std::size_t>(size)});
  });
}

/// A hold, or else who was answered the longest ago. What had come before the hold, also what has
/// not been read yet, would move the arm behind it.
void ControlSocket::answerOne() {
  auto client = std::ranges::find_if(
      clients_, [](const Client& it) { return it.is_hold && !it.request.empty(); });
  if (client != clients_.end()) {
    acceptAll();
    for (Client& other : clients_) {
      if (&other == &*client) continue;
      other.asker.is_overtaken = true;
      other.overtaken_bytes = other.socket.waiting();
    }
  } else {
    client = std::ranges::find_if(clients_, [](const Client& it) { return !it.request.empty(); });
  }
  if (client == clients_.end()) return;
  clients_.splice(clients_.end(), clients_, client);
  if (!answer(*client)) clients_.erase(client);
}

/// False: it is to be closed.
bool ControlSocket::answer(Client& client) {
  const std::string request = std::exchange(client.request, "");
  // What nobody waits for any more would move the arm unasked. To stop it is never wrong.
  if (hasLeft(client.socket) && !client.is_hold) return true;
  return client.socket.send(requests_.answer(request, client.asker));
}

}  // namespace tactus
