// Sends signals to a process and prints the wall clock's time of the first, to be compared with
// candump's.
//
// usage: send_signal PID NUMBER [MILLISECONDS NUMBER]...
//
// `send_signal 42 19 2.5 18` stops process 42 for 2.5 ms.
#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

int main(int count, char** arguments) {
  if (count < 3 || count % 2 == 0) {
    fprintf(stderr, "usage: send_signal PID NUMBER [MILLISECONDS NUMBER]...\n");
    return 2;
  }
  const pid_t process = atoi(arguments[1]);
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  for (int i = 2; i < count; i += 2) {
    if (kill(process, atoi(arguments[i])) != 0) {
      fprintf(stderr, "send_signal: process %d: %s\n", process, strerror(errno));
      return 1;
    }
    if (i + 1 == count) break;
    const long wait_ns = (long)(1e6 * atof(arguments[i + 1]));
    nanosleep(&(struct timespec){.tv_sec = wait_ns / 1000000000, .tv_nsec = wait_ns % 1000000000},
              NULL);
  }
  printf("(%lld.%09ld)\n", (long long)now.tv_sec, now.tv_nsec);
  return 0;
}
