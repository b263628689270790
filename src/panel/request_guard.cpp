#include "tactus/panel/request_guard.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <system_error>

namespace tactus {
namespace {

char lowered(char c) noexcept { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }

bool isSameText(std::string_view one, std::string_view other) noexcept {
  return std::ranges::equal(one, other, {}, lowered, lowered);
}

bool isDigit(char c) noexcept { return c >= '0' && c <= '9'; }

/// "; charset=utf-8" may follow.
bool isJsonType(std::string_view type) noexcept {
  return isSameText(type.substr(0, std::min(type.find(';'), type.size())), "application/json");
}

/// Who asks: the page itself, or none that a browser speaks for.
std::optional<HttpRefusal> strangerRefusal(const RequestHead& head) {
  if (head.hosts.size() != 1 || !isLoopbackHost(head.hosts.front()))
    return HttpRefusal{403, "Host is none of 127.0.0.1, localhost and [::1]"};
  const bool is_own =
      head.origins.empty() || (head.origins.size() == 1 &&
                               isSameText(head.origins.front(), "http://" + head.hosts.front()));
  if (!is_own) return HttpRefusal{403, "Origin is another page"};
  // A link from elsewhere may lead to the page itself.
  const bool is_from_here = head.fetch_site.empty() || head.fetch_site == "same-origin" ||
                            head.fetch_site == "none" || head.path == "/";
  if (!is_from_here) return HttpRefusal{403, "asked for by another page"};
  return std::nullopt;
}

}  // namespace

/// The library reads what is encoded without a limit, and what has a length up to it. Of a range it
/// makes a copy for each of thousands that fit into a header.
std::optional<HttpRefusal> bodyRefusal(const RequestHead& head) {
  if (head.method != "GET" && head.method != "HEAD" && head.method != "POST")
    return HttpRefusal{405, "expected GET or POST"};
  if (head.is_encoded) return HttpRefusal{415, "a body is to be sent as it is, with its length"};
  if (head.is_partial) return HttpRefusal{416, "files are sent whole"};
  std::size_t length = 0;
  for (const std::string& text : head.lengths) {
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data(), end, length);
    if (error != std::errc() || stop != end || head.lengths.size() > 1)
      return HttpRefusal{400, "Content-Length is no single number"};
  }
  if (length > kMaxBody) return HttpRefusal{413, fmt::format("at most {} bytes", kMaxBody)};
  if (head.method != "POST")
    return length > 0 ? std::optional(HttpRefusal{400, "a body without POST"}) : std::nullopt;
  if (head.lengths.empty()) return HttpRefusal{411, "Content-Length is missing"};
  if (!isJsonType(head.content_type)) return HttpRefusal{415, "expected application/json"};
  return std::nullopt;
}

std::optional<HttpRefusal> senderRefusal(const RequestHead& head, std::string_view token) {
  if (auto refusal = strangerRefusal(head)) return refusal;
  const bool has_token = head.tokens.size() == 1 && isSameToken(head.tokens.front(), token);
  if (head.path == kWritePath && !has_token)
    return HttpRefusal{401, "changes need the token of the address that tactus panel prints"};
  return std::nullopt;
}

bool isLoopbackHost(std::string_view host) noexcept {
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != std::string_view::npos && colon + 1 < host.size() &&
                        host.size() - colon <= 6 &&
                        std::ranges::all_of(host.substr(colon + 1), isDigit);
  const std::string_view name = has_port ? host.substr(0, colon) : host;
  return name == "127.0.0.1" || name == "[::1]" || isSameText(name, "localhost");
}

bool isSameToken(std::string_view given, std::string_view token) noexcept {
  if (token.empty()) return false;
  unsigned difference = given.size() == token.size() ? 0 : 1;
  for (std::size_t i = 0; i < given.size(); ++i)
    difference |=
        static_cast<unsigned char>(given[i]) ^ static_cast<unsigned char>(token[i % token.size()]);
  return difference == 0;
}

std::string makeToken() {
  std::array<unsigned char, 16> bytes{};
  if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
    throw std::system_error(errno, std::generic_category(), "getrandom");
  return fmt::format("{:02x}", fmt::join(bytes, ""));
}

}  // namespace tactus
