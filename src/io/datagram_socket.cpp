#include "tactus/io/datagram_socket.h"

#include <netdb.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <memory>
#include <stdexcept>
#include <system_error>

namespace tactus {
namespace {

struct HostAndPort {
  std::string host = "127.0.0.1", port;
};

HostAndPort split(const std::string& to) {
  HostAndPort place;
  const std::size_t colon = to.rfind(':');
  place.port = colon == std::string::npos ? to : to.substr(colon + 1);
  if (colon != std::string::npos) place.host = to.substr(0, colon);
  if (place.host.starts_with('[') && place.host.ends_with(']'))
    place.host = place.host.substr(1, place.host.size() - 2);
  if (place.host == "localhost") place.host = HostAndPort().host;  // may be ::1, where few listen
  return place;
}

}  // namespace

DatagramSocket::DatagramSocket(const std::string& to) {
  const HostAndPort place = split(to);
  unsigned port = 0;
  const char* const last = place.port.data() + place.port.size();
  const auto [end, error] = std::from_chars(place.port.data(), last, port);
  if (error != std::errc() || end != last || port == 0 || port > 65535)
    throw std::invalid_argument(to + ": no port");
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int problem = ::getaddrinfo(place.host.c_str(), place.port.c_str(), &hints, &found);
  if (problem != 0) throw std::invalid_argument(to + ": " + ::gai_strerror(problem));
  const std::unique_ptr<addrinfo, void (*)(addrinfo*)> addresses(found, ::freeaddrinfo);
  fd_ = ::socket(found->ai_family, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd_ >= 0 && ::connect(fd_, found->ai_addr, found->ai_addrlen) == 0) return;
  const int reason = errno;
  if (fd_ >= 0) ::close(fd_);
  throw std::system_error(reason, std::generic_category(), to);
}

DatagramSocket::~DatagramSocket() { ::close(fd_); }

void DatagramSocket::send(std::string_view datagram) const noexcept {
  ::send(fd_, datagram.data(), datagram.size(), MSG_NOSIGNAL);
}

}  // namespace tactus
