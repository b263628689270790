// Hands standard input and an exit status to the host, through memory that it shares with the
// virtual machine (a PCI device's BAR). A disk, a shared folder or a network would answer when the
// host gets to it: virtual time would no longer be repeatable.
//
// usage: hand_over MEMORY STATUS
//
// Layout: one page of text "tactus-hil STATUS BYTES\n", written last, then the bytes.
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

enum { kPage = 4096 };

static int fail(const char* what) {
  fprintf(stderr, "hand_over: %s: %s\n", what, strerror(errno));
  return 1;
}

int main(int count, char** arguments) {
  if (count != 3) {
    fprintf(stderr, "usage: hand_over MEMORY STATUS\n");
    return 2;
  }
  const int file = open(arguments[1], O_RDWR);
  struct stat properties;
  if (file < 0 || fstat(file, &properties) != 0) return fail(arguments[1]);
  const size_t size = (size_t)properties.st_size;
  char* memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  if (memory == MAP_FAILED) return fail("mapping the shared memory");

  size_t end = kPage;
  ssize_t got = 0;
  while (end < size && (got = read(STDIN_FILENO, memory + end, size - end)) > 0) end += (size_t)got;
  if (got < 0) return fail("standard input");
  if (end == size) {
    fprintf(stderr, "hand_over: the files are larger than %zu bytes\n", size - kPage);
    return 1;
  }
  snprintf(memory, kPage, "tactus-hil %s %zu\n", arguments[2], end - kPage);
  return 0;
}
