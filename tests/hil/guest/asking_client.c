// Asks the daemon the same again and again. Fails where that is refused; ends without a word.
//
// usage: asking_client COUNT PERIOD_US REQUEST SOCKET
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  strncpy(address.sun_path, argv[4], sizeof(address.sun_path) - 1);
  const int fd = socket(AF_UNIX, SOCK_SEQPACKET, 0);
  if (connect(fd, (const struct sockaddr*)&address, sizeof(address)) != 0) return 3;
  static char answer[1 << 18];
  const struct timespec period = {.tv_nsec = strtol(argv[2], NULL, 10) * 1000};
  for (long i = strtol(argv[1], NULL, 10); i > 0; --i) {
    if (send(fd, argv[3], strlen(argv[3]), MSG_NOSIGNAL) < 0) return 4;
    const long size = recv(fd, answer, sizeof(answer) - 1, 0);
    if (size <= 0) return 5;
    answer[size] = '\0';
    if (!strstr(answer, "\"done\":true")) {
      fprintf(stderr, "asking_client: %s\n", answer);
      return 1;
    }
    nanosleep(&period, NULL);
  }
  return 0;
}
