#include "tactus/panel/panel_server.h"

#include <fmt/format.h>
#include <httplib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "tactus/panel/panel_page.h"
#include "tactus/panel/request_guard.h"
#include "tactus/record/run_error.h"
#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

constexpr std::size_t kThreads = 16;  ///< one a connection that is being answered
constexpr int kMaxStreams = 8;        ///< connections that wait for events, of these
constexpr time_t kPatience_s = 5;     ///< with a client that neither sends nor takes
constexpr std::chrono::milliseconds kSignOfLife{2000};
constexpr const char* kJsonType = "application/json";

/// default-src: of a browser that has other sources, none of them may add to this page.
const httplib::Headers kSecurity = {
    {"Content-Security-Policy",
     "default-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"},
    {"X-Content-Type-Options", "nosniff"},
    {"X-Frame-Options", "DENY"},
    {"Referrer-Policy", "no-referrer"},
    {"Cross-Origin-Resource-Policy", "same-origin"},
    {"Cross-Origin-Opener-Policy", "same-origin"},
    {"Cache-Control", "no-store"}};

std::vector<std::string> allOf(const httplib::Request& request, const char* name) {
  std::vector<std::string> values;
  const auto [begin, end] = request.headers.equal_range(name);
  for (auto header = begin; header != end; ++header) values.push_back(header->second);
  return values;
}

RequestHead headOf(const httplib::Request& request) {
  RequestHead head;
  head.method = request.method;
  head.path = request.path;
  head.hosts = allOf(request, "Host");
  head.origins = allOf(request, "Origin");
  head.lengths = allOf(request, "Content-Length");
  head.tokens = allOf(request, kTokenHeader);
  head.fetch_site = request.get_header_value("Sec-Fetch-Site");
  head.content_type = request.get_header_value("Content-Type");
  head.is_encoded =
      request.has_header("Transfer-Encoding") || request.has_header("Content-Encoding");
  head.is_partial = request.has_header("Range");
  return head;
}

std::string textOf(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

void give(const PanelAnswer& answer, httplib::Response& response) {
  response.status = answer.status;
  response.set_content(textOf(answer.json), kJsonType);
}

void refuse(const HttpRefusal& refusal, httplib::Response& response) {
  give({refusal.status, {{"done", false}, {"error", refusal.reason}}}, response);
}

/// Not SO_REUSEPORT, by which two panels would share a port.
void setOptions(int socket) {
  const int on = 1;
  ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
}

/// True: whoever bound this socket has gone. Of any type: only the system knows who listens, and
/// one that takes a connection and says nothing, or speaks no HTTP, is in use.
bool isDeadSocket(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof(address.sun_path)) return false;
  path.copy(address.sun_path, path.size());
  const int asking = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (asking < 0) return false;
  const int result =
      ::connect(asking, reinterpret_cast<const sockaddr*>(&address), sizeof(address));
  const bool is_dead = result != 0 && errno == ECONNREFUSED;
  ::close(asking);
  return is_dead;
}

/// What is a socket at this path.
std::optional<struct stat> socketAt(const std::string& path) {
  struct stat state {};
  if (::lstat(path.c_str(), &state) != 0 || !S_ISSOCK(state.st_mode)) return std::nullopt;
  return state;
}

/// Left behind by a panel that was killed.
void removeDeadSocket(const std::string& path) {
  if (socketAt(path) && isDeadSocket(path)) ::unlink(path.c_str());
}

bool sendEvent(const std::string& event, httplib::DataSink& sink) {
  const std::string text = "data: " + event + "\n\n";
  return sink.write(text.data(), text.size());
}

}  // namespace

struct PanelServer::Server {
  httplib::Server http;
  std::string token, socket;
  EventFeed& feed;
  const DaemonWatch& watch;
  PanelRequests& requests;
  const std::vector<PageFile> files = pageFiles();
  std::atomic<int> streams{0};
  std::atomic<bool> has_served{false};
  int port = 0;
  std::optional<struct stat> bound = std::nullopt;  ///< the socket as it was made

  void limit();
  void guard();
  void answer(const httplib::Request& request, httplib::Response& response);
  void bind(const PanelPlace& place);
  void removeSocket() const;
  void stream(httplib::Response& response);
  bool sendNew(std::uint64_t& number, httplib::DataSink& sink);
};

void PanelServer::Server::limit() {
  http.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  // One request a connection: what is left of one that was refused is never taken for another one,
  // and no idle connection takes a thread.
  http.set_keep_alive_max_count(1);
  http.set_keep_alive_timeout(kPatience_s);
  http.set_read_timeout(kPatience_s);
  http.set_write_timeout(kPatience_s);
  http.set_payload_max_length(kMaxBody);
  http.set_socket_options(setOptions);
  http.set_tcp_nodelay(true);
  http.set_default_headers(kSecurity);
}

void PanelServer::Server::guard() {
  http.set_pre_routing_handler([](const httplib::Request& request, httplib::Response& response) {
    const std::optional<HttpRefusal> refusal = bodyRefusal(headOf(request));
    if (!refusal) return httplib::Server::HandlerResponse::Unhandled;
    refuse(*refusal, response);
    return httplib::Server::HandlerResponse::Handled;
  });
  const auto answer = [this](const httplib::Request& request, httplib::Response& response) {
    this->answer(request, response);
  };
  http.Get(".*", answer);
  http.Post(".*", answer);
  http.set_exception_handler(
      [](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
        refuse({500, "the panel failed"}, response);
      });
  http.set_error_handler([](const httplib::Request&, httplib::Response& response) {
    if (response.body.empty())
      refuse({response.status, fmt::format("status {}", response.status)}, response);
  });
}

void PanelServer::Server::answer(const httplib::Request& request, httplib::Response& response) {
  if (const auto refusal = senderRefusal(headOf(request), token)) return refuse(*refusal, response);
  const bool is_post = request.method == "POST";
  if (is_post && request.path == kWritePath)
    return give(PanelRequests::act(request.body), response);
  if (is_post && request.path == "/api/check") return give(requests.check(request.body), response);
  if (!is_post && request.path == kWritePath) return give({200, {{"done", true}}}, response);
  if (!is_post && request.path == "/api/keys") return give({200, PanelRequests::keys()}, response);
  if (!is_post && request.path == "/api/events") return stream(response);
  const auto file = std::ranges::find(files, request.path, &PageFile::path);
  if (is_post || file == files.end()) return refuse({404, "there is no such page"}, response);
  response.set_content(file->text, file->type);
}

/// Server-sent events: at first all that there is, then what is new.
void PanelServer::Server::stream(httplib::Response& response) {
  if (streams.fetch_add(1) >= kMaxStreams) {
    --streams;
    return refuse({503, fmt::format("{} pages are open already", kMaxStreams)}, response);
  }
  auto number = std::make_shared<std::optional<std::uint64_t>>();
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, number](std::size_t, httplib::DataSink& sink) {
        if (feed.hasEnded() || !sink.is_writable()) return false;
        if (*number) return sendNew(**number, sink);
        const auto [all, last] = watch.all();
        *number = last;
        return sendEvent(all, sink);
      },
      [this](bool) { --streams; });
}

bool PanelServer::Server::sendNew(std::uint64_t& number, httplib::DataSink& sink) {
  const EventFeed::Batch batch = feed.wait(number, kSignOfLife);
  number = batch.number;
  if (batch.is_lost) return false;  // the page comes again, and gets all
  if (batch.events.empty())         // no comment: pages see none of these
    return sendEvent(DaemonWatch::signOfLife(), sink);
  for (const EventFeed::Event& event : batch.events)
    if (!sendEvent(*event, sink)) return false;
  return true;
}

void PanelServer::Server::bind(const PanelPlace& place) {
  socket = place.socket;
  if (socket.empty()) {
    const bool is_bound = place.port > 0 ? http.bind_to_port("127.0.0.1", place.port)
                                         : (port = http.bind_to_any_port("127.0.0.1")) > 0;
    if (!is_bound)
      throw RunError(fmt::format(
          "127.0.0.1:{}: cannot be listened at, expected a port that is free", place.port));
    if (place.port > 0) port = place.port;
    return;
  }
  removeDeadSocket(socket);
  http.set_address_family(AF_UNIX);
  const mode_t before = ::umask(0177);
  const bool is_bound = http.bind_to_port(socket, 1);
  ::umask(before);
  if (!is_bound)
    throw RunError(
        fmt::format("{}: cannot be listened at, expected the path of no file in a folder "
                    "that may be written",
                    escaped(std::exchange(socket, ""))));
  bound = socketAt(socket);
}

/// Not another program's, which has taken the place meanwhile.
void PanelServer::Server::removeSocket() const {
  if (!bound) return;
  const std::optional<struct stat> now = socketAt(socket);
  const bool is_own = now && now->st_dev == bound->st_dev && now->st_ino == bound->st_ino;
  if (is_own) ::unlink(socket.c_str());
}

PanelServer::PanelServer(const PanelPlace& place, std::string token, EventFeed& feed,
                         const DaemonWatch& watch, PanelRequests& requests)
    : server_(new Server{{}, std::move(token), "", feed, watch, requests}) {
  server_->limit();
  server_->guard();
  server_->bind(place);
}

PanelServer::~PanelServer() { server_->removeSocket(); }

int PanelServer::port() const noexcept { return server_->port; }

void PanelServer::serve() {
  server_->http.listen_after_bind();
  server_->has_served = true;
}

void PanelServer::stop() {
  server_->feed.end();
  // The library forgets a stop of before it listens.
  while (!server_->http.is_running() && !server_->has_served)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  server_->http.stop();
}

}  // namespace tactus
