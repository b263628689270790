/* Preloaded: one call of the C library fails, the FAIL_AT-th of the function FAIL_CALL; with
   FAIL_COUNT, a file, how many there were is written there at the end. What came before main()
   counts, too; with FAIL_SIGNAL what comes after SIGUSR2 alone, and with FAIL_THREADS what comes from
   other threads than main()'s. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);

static const char* failing_call = "";
static long fail_at;
static atomic_long calls;
static atomic_int is_counting = 1;
static int counts_main = 1;

static void begin_counting(int signal) {
  (void)signal;
  is_counting = 1;
}

__attribute__((constructor)) static void begin(void) {
  const char* at = getenv("FAIL_AT");
  const char* call = getenv("FAIL_CALL");
  fail_at = at ? atol(at) : 0;
  if (call) failing_call = call;
  counts_main = getenv("FAIL_THREADS") == NULL;
  if (getenv("FAIL_SIGNAL")) {
    is_counting = 0;
    signal(SIGUSR2, begin_counting);
  }
}

__attribute__((destructor)) static void end(void) {
  const char* path = getenv("FAIL_COUNT");
  const long count = calls;
  failing_call = "";
  FILE* file = path ? fopen(path, "w") : NULL;
  if (!file) return;
  fprintf(file, "%ld\n", count);
  fclose(file);
}

static int fails(const char* call, int error) {
  if (!is_counting || strcmp(call, failing_call) != 0) return 0;
  if ((!counts_main && gettid() == getpid()) || ++calls != fail_at) return 0;
  errno = error;
  return 1;
}

#define NEXT(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

void* malloc(size_t size) { return fails("malloc", ENOMEM) ? NULL : __libc_malloc(size); }
void* calloc(size_t n, size_t size) {
  return fails("malloc", ENOMEM) ? NULL : __libc_calloc(n, size);
}

int open(const char* path, int flags, ...) {
  va_list more;
  va_start(more, flags);
  const mode_t mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(more, mode_t) : 0;
  va_end(more);
  return fails("open", EMFILE) ? -1 : NEXT(open)(path, flags, mode);
}
FILE* fopen(const char* path, const char* mode) {
  return fails("open", EMFILE) ? NULL : NEXT(fopen)(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  return fails("open", EMFILE) ? NULL : NEXT(fopen64)(path, mode);
}
ssize_t read(int fd, void* to, size_t size) {
  return fails("read", EIO) ? -1 : NEXT(read)(fd, to, size);
}
ssize_t pread(int fd, void* to, size_t size, off_t at) {
  return fails("read", EIO) ? -1 : NEXT(pread)(fd, to, size, at);
}
ssize_t write(int fd, const void* from, size_t size) {
  return fails("write", ENOSPC) ? -1 : NEXT(write)(fd, from, size);
}
ssize_t writev(int fd, const struct iovec* from, int count) {
  return fails("write", ENOSPC) ? -1 : NEXT(writev)(fd, from, count);
}
size_t fwrite(const void* from, size_t size, size_t n, FILE* file) {
  return fails("write", ENOSPC) ? 0 : NEXT(fwrite)(from, size, n, file);
}
int fflush(FILE* file) { return fails("write", ENOSPC) ? EOF : NEXT(fflush)(file); }
int fclose(FILE* file) {
  const int is_failing = fails("close", EIO);
  const int result = NEXT(fclose)(file);
  return is_failing ? EOF : result;
}
int close(int fd) {
  const int is_failing = fails("close", EIO);
  const int result = NEXT(close)(fd);
  return is_failing ? (errno = EIO, -1) : result;
}
int fsync(int fd) { return fails("fsync", EIO) ? -1 : NEXT(fsync)(fd); }
int rename(const char* from, const char* to) {
  return fails("rename", EACCES) ? -1 : NEXT(rename)(from, to);
}
int mkdir(const char* path, mode_t mode) {
  return fails("mkdir", EACCES) ? -1 : NEXT(mkdir)(path, mode);
}
int stat(const char* path, struct stat* to) {
  return fails("stat", EACCES) ? -1 : NEXT(stat)(path, to);
}
int unlink(const char* path) { return fails("unlink", EACCES) ? -1 : NEXT(unlink)(path); }
void* mmap(void* at, size_t size, int protection, int flags, int fd, off_t offset) {
  return fails("mmap", ENOMEM) ? MAP_FAILED : NEXT(mmap)(at, size, protection, flags, fd, offset);
}
int socket(int domain, int type, int protocol) {
  return fails("socket", EMFILE) ? -1 : NEXT(socket)(domain, type, protocol);
}
int poll(struct pollfd* fds, nfds_t count, int timeout_ms) {
  return fails("poll", EINTR) ? -1 : NEXT(poll)(fds, count, timeout_ms);
}
int accept4(int fd, struct sockaddr* from, socklen_t* size, int flags) {
  return fails("accept", EMFILE) ? -1 : NEXT(accept4)(fd, from, size, flags);
}
ssize_t send(int fd, const void* from, size_t size, int flags) {
  return fails("send", ENOBUFS) ? -1 : NEXT(send)(fd, from, size, flags);
}
ssize_t recv(int fd, void* to, size_t size, int flags) {
  return fails("recv", EIO) ? -1 : NEXT(recv)(fd, to, size, flags);
}
int mlockall(int flags) { return fails("mlockall", ENOMEM) ? -1 : NEXT(mlockall)(flags); }
