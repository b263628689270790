// Tells the daemon's tool where to go, 500 times a second: each target some millimetres on. Fails where
// one is refused. Ends in the middle of it, without a word.
//
// usage: stream_client COUNT SOCKET
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  strncpy(address.sun_path, argv[2], sizeof(address.sun_path) - 1);
  const int fd = socket(AF_UNIX, SOCK_SEQPACKET, 0);
  if (connect(fd, (const struct sockaddr*)&address, sizeof(address)) != 0) return 3;
  const char* target = "{\"do\":\"stream\",\"to_m\":[0,0.008,0],\"relative\":true}";
  static char answer[1 << 18];
  const struct timespec period = {.tv_nsec = 2000000};
  for (long i = strtol(argv[1], NULL, 10); i > 0; --i) {
    if (send(fd, target, strlen(target), MSG_NOSIGNAL) < 0) return 4;
    const long size = recv(fd, answer, sizeof(answer) - 1, 0);
    if (size <= 0) return 5;
    answer[size] = '\0';
    if (!strstr(answer, "\"done\":true")) {
      fprintf(stderr, "stream_client: %s\n", answer);
      return 1;
    }
    nanosleep(&period, NULL);
  }
  return 0;
}
