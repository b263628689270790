#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Which requests are answered at all. A page of somebody else, open in the same browser, can send
/// requests here too: what tells them apart are the headers that a browser does not let it choose.
namespace tactus {

inline constexpr std::size_t kMaxBody = 16384;                 ///< bytes
inline constexpr const char* kTokenHeader = "X-Tactus-Token";  ///< of writes
inline constexpr const char* kWritePath = "/api/do";           ///< all else only reads

/// What of an HTTP request decides. Of headers that may stand there once all are listed.
struct RequestHead {
  std::string method, path;
  std::vector<std::string> hosts, origins, lengths, tokens;
  std::string fetch_site;    ///< Sec-Fetch-Site, empty without
  std::string content_type;  ///< likewise
  bool is_encoded = false;   ///< has a Transfer-Encoding or Content-Encoding
  bool is_partial = false;   ///< has a Range
};

struct HttpRefusal {
  int status = 403;
  std::string reason;
};

/// Of a request that is not even read to its end; nothing: it may be.
std::optional<HttpRefusal> bodyRefusal(const RequestHead& head);

/// Of who sends it; nothing: it may be answered. token: what a write has to bring along.
std::optional<HttpRefusal> senderRefusal(const RequestHead& head, std::string_view token);

/// A name of this machine to itself, with or without a port: a name that somebody else's server
/// has led here (DNS rebinding) is none.
bool isLoopbackHost(std::string_view host) noexcept;

/// Takes as long wherever they differ.
bool isSameToken(std::string_view given, std::string_view token) noexcept;

/// 128 bits of the kernel's as 32 hexadecimal digits. Throws std::system_error.
std::string makeToken();

}  // namespace tactus
