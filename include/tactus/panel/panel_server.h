#pragma once

#include <memory>
#include <string>

#include "tactus/panel/daemon_watch.h"
#include "tactus/panel/event_feed.h"
#include "tactus/panel/panel_requests.h"

namespace tactus {

/// Where a panel listens: on this machine alone.
struct PanelPlace {
  int port = 0;        ///< of 127.0.0.1; 0: any that is free
  std::string socket;  ///< path of an AF_UNIX socket in its place; empty: none
};

/// Serves the page, its events and its requests over HTTP.
class PanelServer {
 public:
  /// Binds; throws RunError where it cannot. All that is given has to outlive this.
  PanelServer(const PanelPlace& place, std::string token, EventFeed& feed, const DaemonWatch& watch,
              PanelRequests& requests);
  ~PanelServer();

  int port() const noexcept;  ///< 0 of an AF_UNIX socket
  /// Until stop(), which another thread calls, or until the socket fails.
  void serve();
  void stop();

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace tactus
