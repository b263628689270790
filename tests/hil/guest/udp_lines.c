// Prints what comes to a UDP port of this machine, a line a datagram.
//
// usage: udp_lines PORT COUNT
#include <arpa/inet.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/socket.h>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  struct sockaddr_in address = {.sin_family = AF_INET,
                                .sin_port = htons(atoi(argv[1])),
                                .sin_addr.s_addr = htonl(INADDR_LOOPBACK)};
  const int fd = socket(AF_INET, SOCK_DGRAM, 0);
  if (bind(fd, (const struct sockaddr*)&address, sizeof(address)) != 0) return 3;
  static char datagram[65536];
  for (long i = strtol(argv[2], NULL, 10); i > 0; --i) {
    const long size = recv(fd, datagram, sizeof(datagram), 0);
    if (size < 0) return 4;
    fwrite(datagram, 1, size, stdout);
    putchar('\n');
  }
  return 0;
}
