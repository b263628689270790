#pragma once

#include <poll.h>

#include <cstdint>
#include <list>
#include <stop_token>
#include <string>
#include <thread>
#include <vector>

#include "tactus/daemon/control_requests.h"
#include "tactus/io/packet_socket.h"

namespace tactus {

inline constexpr const char* kControlName = "control";    ///< in the folder of the status file
inline constexpr std::size_t kMaxControlMessage = 32768;  ///< bytes

/// The path of the socket of a daemon that runs as a service, or of RUNTIME_DIRECTORY.
std::string controlPath();

/// Serves ControlRequests on an AF_UNIX socket of packets (SOCK_SEQPACKET), in a thread of its own.
/// The socket is the service manager's, or else lies in RUNTIME_DIRECTORY; without either there is
/// none. A hold is answered before all that waits, also before what came earlier. Clients are taken
/// for hostile: at most kMaxClients of them, each as often as kMessagesPerS; what is too long, or
/// does not take its answer, is closed. One more is heard for a hold alone: those who have all
/// places may be silent for hours.
class ControlSocket {
 public:
  static constexpr int kMaxClients = 8;
  static constexpr int kMessagesPerS = 1000;

  /// Throws std::system_error, also where another daemon answers at that path.
  ControlSocket(const Scene& scene, LoopLink& link);
  ~ControlSocket();
  ControlSocket(const ControlSocket&) = delete;
  ControlSocket& operator=(const ControlSocket&) = delete;

 private:
  struct Client {
    PacketSocket socket;
    double may_speak_s = 0.0;  ///< on the monotonic clock
    std::string request{};     ///< that waits for its answer
    bool is_hold = false;
    bool is_extra = false;     ///< came when all places were taken
    long overtaken_bytes = 0;  ///< sent, and not received yet, when a hold was answered
    Asker asker{};
  };

  void serve(const std::stop_token& stop) noexcept;
  void look();
  void receive();
  void await(std::vector<pollfd>& polled);
  void acceptAll();
  void accept();
  bool makeRoom();
  bool hear(Client& client);
  bool holdComes();
  void answerOne();
  bool answer(Client& client);

  LoopLink& link_;
  ControlRequests requests_;
  std::string made_path_;  ///< of a socket of our own, to be removed
  PacketSocket listening_;
  std::list<Client> clients_;          ///< who was answered last is the last
  std::int64_t looked_at_cycle_ = 0;   ///< of the loop, when all that had come was taken
  std::int64_t came_after_cycle_ = 0;  ///< what was taken last
  std::jthread thread_;
};

}  // namespace tactus
