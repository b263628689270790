#include <fmt/format.h>
#include <malloc.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <thread>

#include "tactus/daemon/named_file.h"
#include "tactus/panel/daemon_watch.h"
#include "tactus/panel/event_feed.h"
#include "tactus/panel/panel_requests.h"
#include "tactus/panel/panel_server.h"
#include "tactus/panel/request_guard.h"
#include "tactus/scene/exit_code.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr int kUsualPort = 8470;
constexpr rlim_t kMaxMemory = rlim_t{1} << 30;  ///< bytes of addresses; some 300 MB are in use

sigset_t stopSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&signals, signal);
  return signals;
}

/// The HTTP library takes a line of any length, from anybody. Who sends a longer one ends the
/// panel, and takes no memory from the daemon. Before threads start, each of which might have an
/// arena.
void limitMemory() {
  mallopt(M_ARENA_MAX, 2);
  rlimit limit{};
  ::getrlimit(RLIMIT_AS, &limit);
  limit.rlim_cur = std::min(limit.rlim_cur, kMaxMemory);
  ::setrlimit(RLIMIT_AS, &limit);
}

/// Behind the #: a browser tells that nobody.
void printAddress(const PanelPlace& place, int port, const std::string& token) {
  const std::string socket =  // `ssh -L` begins in another folder
      place.socket.empty() ? "" : escaped(std::filesystem::absolute(place.socket).string());
  if (socket.empty())
    fmt::print("http://127.0.0.1:{}/#token={}\n", port, token);
  else
    fmt::print(
        "{} listens; from elsewhere: ssh -L {}:{} HOST, then\nhttp://127.0.0.1:{}/#token={}\n",
        socket, kUsualPort, socket, kUsualPort, token);
  std::fflush(stdout);
}

void serve(const PanelPlace& place) {
  limitMemory();
  const sigset_t signals = stopSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);  // of all threads that come
  signal(SIGPIPE, SIG_IGN);                       // a page that has gone
  const std::string token = makeToken();
  EventFeed feed;
  const DaemonWatch watch(feed);
  PanelRequests requests(watch);
  PanelServer server(place, token, feed, watch, requests);
  printAddress(place, server.port(), token);
  const std::jthread serving([&server] {
    server.serve();
    ::kill(::getpid(), SIGTERM);  // nobody listens any more
  });
  int signal = 0;
  sigwait(&signals, &signal);
  server.stop();
}

int run(int argc, char** argv) {
  CLI::App app{"A page in the browser for who works at the running arm", "tactus panel"};
  PanelPlace place{kUsualPort, ""};
  CLI::Option* const port =
      app.add_option("--port", place.port, "Of 127.0.0.1; 0: any that is free")
          ->check(CLI::Range(0, 65535))
          ->capture_default_str();
  app.add_option("--socket", place.socket, "Path of an AF_UNIX socket to listen at in its place")
      ->excludes(port)
      ->check(isNamed);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kExitDone : kExitUsage;
  }
  serve(place);
  return kExitDone;
}

}  // namespace
}  // namespace tactus

int main(int argc, char** argv) {
  try {
    return tactus::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return tactus::kExitFault;
  }
}
