// Talks to the daemon's control socket as nobody should: bytes at random, requests with bytes at random
// in them, too long ones, connections that are never read, and that are left in the middle; the same ones
// for the same seed.
//
// usage: hostile_client SEED COUNT SOCKET
#include <errno.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

enum { kConnections = 12, kLongest = 40000 };

static const char* const kRequests[] = {
    "{\"do\":\"set\",\"values\":{\"controller.damping\":0.6},\"for_s\":60}",
    "{\"do\":\"set\",\"values\":{\"controller.time_constant_s\":1e-9,\"robot.tip\":\"x\"}}",
    "{\"do\":\"show\"}", "{\"do\":\"undo\",\"for_s\":0}",
    "{\"do\":\"move\",\"to_m\":[0,0.02,0],\"relative\":true,\"speed_m_per_s\":0.05}",
    "{\"do\":\"follow\",\"waypoints\":[{\"to_m\":[0,0.01,0],\"relative\":true}]}",
    "{\"do\":\"hold\"}", "[[[[[[[[[[[[[[[[[[[[[[[["};

static uint64_t state;

static unsigned below(unsigned end) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (unsigned)((state >> 20) % end);
}

static int open_connection(const char* path) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  strncpy(address.sun_path, path, sizeof(address.sun_path) - 1);
  const int fd = socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK, 0);
  if (connect(fd, (const struct sockaddr*)&address, sizeof(address)) == 0) return fd;
  if (errno != EAGAIN) {
    fprintf(stderr, "hostile_client: %s: %s\n", path, strerror(errno));
    exit(1);
  }
  close(fd);
  return -1;
}

static size_t make_message(char* message) {
  if (below(4) == 0) {
    const size_t size = below(50) == 0 ? kLongest : below(200);
    for (size_t i = 0; i < size; ++i) message[i] = (char)below(256);
    return size;
  }
  const char* request = kRequests[below(sizeof(kRequests) / sizeof(kRequests[0]))];
  const size_t size = strlen(request);
  memcpy(message, request, size);
  for (unsigned i = below(4) + 1; i > 0; --i) message[below((unsigned)size)] = (char)below(256);
  return size;
}

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  state = strtoull(argv[1], NULL, 10) * 2654435761u + 1;
  int connections[kConnections];
  for (int i = 0; i < kConnections; ++i) connections[i] = -1;
  static char message[kLongest], answer[1 << 18];
  const struct timespec pause = {.tv_nsec = 500000};
  for (long count = strtol(argv[2], NULL, 10), sent = 0; sent < count;) {
    int* const fd = &connections[below(kConnections)];
    if (*fd < 0) *fd = open_connection(argv[3]);
    if (*fd >= 0 && send(*fd, message, make_message(message), MSG_NOSIGNAL) >= 0) ++sent;
    if (*fd >= 0 && below(2) == 0) recv(*fd, answer, sizeof(answer), 0);
    if (*fd >= 0 && below(20) == 0) {
      close(*fd);
      *fd = -1;
    }
    nanosleep(&pause, NULL);
  }
  return 0;
}
