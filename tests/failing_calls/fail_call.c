/* Preloaded: one call of the C library fails, the FAIL_AT-th (the first) of the function FAIL_CALL;
   with FAIL_WAY the FAIL_AT-th of those that come by this way, a hash of the return addresses and
   how deep the stack is. All that ask for memory are one function, malloc. Where it failed is then
   in the file FAIL_PLACE, a line a frame, library and offset, and zeros. At the end FAIL_COUNT is
   written, a line a function, how many calls there were, and FAIL_WAYS, a line a way: function,
   way, how many. What came before main() counts, too; with FAIL_SIGNAL what comes after SIGUSR2
   alone, and with FAIL_THREADS what comes from other threads than main()'s. With FAIL_BUSES there
   are CAN interfaces of any name, on which nobody answers. */
#define _GNU_SOURCE
#include <dirent.h>
#include <dlfcn.h>
#include <errno.h>
#include <execinfo.h>
#include <fcntl.h>
#include <link.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/sendfile.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <time.h>
#include <unistd.h>

extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);
extern void* __libc_stack_end;

/* All that can fail are in one section of the library, between these two. */
struct call {
  const char* name;
  atomic_long count;
};
extern struct call __start_calls[], __stop_calls[];

/* The ways that calls came by, in a table that does not fill: a hash of zero is free. */
#define WAYS (1 << 17)
#define FRAMES 64
#define PLACE (1 << 14)
#define STREAM_ERROR 0x20 /* glibc's _IO_ERR_SEEN, by which ferror() tells */
#define ALIGNMENT 64      /* of variables on the stack: how deep it is differs by as much */
struct way {
  _Atomic uint64_t hash;
  long depth;
  struct call* call;
  atomic_long count;
};
static struct way ways[WAYS];

static const char* failing_call = "";
static uint64_t failing_hash;
static long failing_depth;
static char* place; /* written without a system call, as the loop may not make one */
static long fail_at;
static atomic_long asked;
static atomic_int is_counting;
static int counts_main = 1, counts_ways = 0, has_buses = 0;
static __thread int is_inside __attribute__((tls_model("initial-exec")));

static void begin_counting(int signal) {
  (void)signal;
  is_counting = 1;
}

__attribute__((constructor)) static void begin(void) {
  void* frames[2];
  backtrace(frames, 2); /* loads what it needs */
  const char* at = getenv("FAIL_AT");
  const char* call = getenv("FAIL_CALL");
  const char* way = getenv("FAIL_WAY");
  fail_at = at ? atol(at) : call != NULL;
  const char* path = getenv("FAIL_PLACE");
  const int fd = path ? open(path, O_CREAT | O_RDWR, 0666) : -1;
  if (fd >= 0 && ftruncate(fd, PLACE) == 0)
    place = mmap(NULL, PLACE, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
  if (fd >= 0) close(fd);
  if (call) failing_call = call;
  if (way) sscanf(way, "%lx:%ld", &failing_hash, &failing_depth);
  counts_ways = getenv("FAIL_WAYS") != NULL;
  counts_main = getenv("FAIL_THREADS") == NULL;
  has_buses = getenv("FAIL_BUSES") != NULL;
  is_counting = getenv("FAIL_SIGNAL") == NULL;
  if (!is_counting) signal(SIGUSR2, begin_counting);
}

__attribute__((destructor)) static void end(void) {
  is_counting = 0;
  const char* path = getenv("FAIL_COUNT");
  FILE* file = path ? fopen(path, "w") : NULL;
  if (file) {
    for (struct call* call = __start_calls; call < __stop_calls; ++call)
      if (call->count) fprintf(file, "%s %ld\n", call->name, (long)call->count);
    fclose(file);
  }
  path = getenv("FAIL_WAYS");
  file = path ? fopen(path, "w") : NULL;
  if (!file) return;
  for (struct way* way = ways; way < ways + WAYS; ++way)
    if (way->hash)
      fprintf(file, "%s %016lx:%ld %ld\n", way->call->name, way->hash, way->depth,
              (long)way->count);
  fclose(file);
}

/* Of the stack; the same in each process. A thread's own variables lie where its stack begins. */
static long depth_of_call(void) {
  static __thread const char* begin __attribute__((tls_model("initial-exec")));
  if (!begin) begin = gettid() == getpid() ? __libc_stack_end : __builtin_thread_pointer();
  return begin - (const char*)__builtin_frame_address(0);
}

static uintptr_t offset_of(void* address, const char** library) {
  struct dl_find_object object;
  if (_dl_find_object(address, &object) != 0) return 0;
  *library = object.dlfo_link_map->l_name;
  return (uintptr_t)address - object.dlfo_link_map->l_addr;
}

/* The same in each process, wherever its libraries are. */
static uint64_t hash_of_way(struct call* call) {
  void* frames[FRAMES];
  const char* library;
  const int count = backtrace(frames, FRAMES);
  uint64_t hash = 14695981039346656037u ^ (uint64_t)(call - __start_calls);
  for (int i = 0; i < count; ++i) {
    hash = (hash ^ offset_of(frames[i], &library)) * 1099511628211u;
    hash ^= hash >> 29;
  }
  return hash ? hash : 1;
}

static void count_way(uint64_t hash, long depth, struct call* call) {
  for (uint64_t i = hash;; ++i) {
    struct way* way = &ways[i % WAYS];
    uint64_t there = 0;
    if (!atomic_compare_exchange_strong(&way->hash, &there, hash) && there != hash) continue;
    way->call = call;
    way->depth = depth;
    ++way->count;
    return;
  }
}

static int is_its_turn(struct call* call) {
  ++call->count;
  const int may_fail = strcmp(call->name, failing_call) == 0;
  if (!counts_ways && !may_fail) return 0;
  if (!counts_ways && !failing_hash) return ++asked == fail_at;
  const long depth = depth_of_call();
  if (!counts_ways && labs(depth - failing_depth) > ALIGNMENT) return 0;
  const uint64_t hash = hash_of_way(call);
  if (counts_ways) count_way(hash, depth, call);
  return may_fail && hash == failing_hash && ++asked == fail_at;
}

static void tell_place(void) {
  void* frames[FRAMES];
  const char* library = "";
  const int count = backtrace(frames, FRAMES);
  for (int i = 0, end = 0; i < count && end < PLACE; ++i) {
    const uintptr_t offset = offset_of(frames[i], &library);
    end += snprintf(place + end, PLACE - end, "%s %lx\n", *library ? library : "-", offset);
  }
}

static int __attribute__((noinline)) fails(struct call* call, int error) {
  if (!is_counting || is_inside) return 0;
  if (!counts_main && gettid() == getpid()) return 0;
  const int before = errno;
  is_inside = 1;
  const int is_failing = is_its_turn(call);
  if (is_failing && place) tell_place();
  is_inside = 0;
  errno = is_failing ? error : before;
  return is_failing;
}

/* The function behind is looked for before main(): the dynamic linker's lock is a system call where
   two threads want it, and the loop may make none. */
#define CALL(name)                                                                     \
  static struct call name##_call __attribute__((section("calls"), used)) = {#name, 0}; \
  static __typeof__(&name) name##_next __attribute__((used));                          \
  static void __attribute__((constructor)) find_##name(void) {                         \
    name##_next = (__typeof__(&name))dlsym(RTLD_NEXT, #name);                          \
  }                                                                                    \
  struct call
#define NEXT(name) (name##_next ? name##_next : (__typeof__(&name))dlsym(RTLD_NEXT, #name))
/* A function that comes to failed, and errno to error, where it fails. */
#define FAILING(error, failed, result, name, parameters, arguments) \
  CALL(name);                                                       \
  result name parameters { return fails(&name##_call, error) ? failed : NEXT(name) arguments; }
/* One that frees something: it does, and tells an error of what was written before. */
#define FAILING_AFTER(error, failed, name, parameter, argument) \
  CALL(name);                                                   \
  int name(parameter) {                                         \
    const int is_failing = fails(&name##_call, error);          \
    const int result = NEXT(name)(argument);                    \
    return is_failing ? (errno = error, failed) : result;       \
  }

CALL(malloc);
void* malloc(size_t size) { return fails(&malloc_call, ENOMEM) ? NULL : __libc_malloc(size); }
void* calloc(size_t n, size_t size) {
  return fails(&malloc_call, ENOMEM) ? NULL : __libc_calloc(n, size);
}
void* realloc(void* from, size_t size) {
  return fails(&malloc_call, ENOMEM) ? NULL : __libc_realloc(from, size);
}
void* aligned_alloc(size_t alignment, size_t size) {
  return fails(&malloc_call, ENOMEM) ? NULL : __libc_memalign(alignment, size);
}
int posix_memalign(void** to, size_t alignment, size_t size) {
  if (fails(&malloc_call, ENOMEM)) return ENOMEM;
  *to = __libc_memalign(alignment, size);
  return *to ? 0 : ENOMEM;
}

#define OPENING(name, first_parameters, first)                                      \
  CALL(name);                                                                       \
  int name(first_parameters int flags, ...) {                                       \
    va_list more;                                                                   \
    va_start(more, flags);                                                          \
    const mode_t mode = flags & (O_CREAT | __O_TMPFILE) ? va_arg(more, mode_t) : 0; \
    va_end(more);                                                                   \
    return fails(&name##_call, EMFILE) ? -1 : NEXT(name)(first flags, mode);        \
  }
#define COMMA ,
OPENING(open, const char* path COMMA, path COMMA)
OPENING(open64, const char* path COMMA, path COMMA)
OPENING(openat, int at COMMA const char* path COMMA, at COMMA path COMMA)
OPENING(openat64, int at COMMA const char* path COMMA, at COMMA path COMMA)
FAILING(EMFILE, NULL, FILE*, fopen, (const char* path, const char* mode), (path, mode))
FAILING(EMFILE, NULL, FILE*, fopen64, (const char* path, const char* mode), (path, mode))
FAILING(EMFILE, NULL, FILE*, fdopen, (int fd, const char* mode), (fd, mode))
FAILING(EMFILE, NULL, DIR*, opendir, (const char* path), (path))
FAILING(EMFILE, NULL, DIR*, fdopendir, (int fd), (fd))
FAILING(EIO, NULL, struct dirent*, readdir, (DIR * folder), (folder))
FAILING(EMFILE, -1, int, mkostemp, (char* path, int flags), (path, flags))
FAILING(EMFILE, -1, int, memfd_create, (const char* name, unsigned flags), (name, flags))
FAILING(EMFILE, -1, int, dup, (int fd), (fd))
FAILING(EIO, -1, ssize_t, read, (int fd, void* to, size_t size), (fd, to, size))
FAILING(EIO, -1, ssize_t, pread, (int fd, void* to, size_t size, off_t at), (fd, to, size, at))
FAILING(ENOSPC, -1, ssize_t, write, (int fd, const void* from, size_t size), (fd, from, size))
FAILING(ENOSPC, -1, ssize_t, writev, (int fd, const struct iovec* from, int n), (fd, from, n))
/* A stream remembers that it failed. */
#define FAILING_STREAM(failed, result, name, parameters, arguments, stream) \
  CALL(name);                                                               \
  result name parameters {                                                  \
    if (!fails(&name##_call, ENOSPC)) return NEXT(name) arguments;          \
    (stream)->_flags |= STREAM_ERROR;                                       \
    return failed;                                                          \
  }
FAILING_STREAM(0, size_t, fwrite, (const void* from, size_t size, size_t n, FILE* file),
               (from, size, n, file), file)
FAILING_STREAM(EOF, int, fputs, (const char* text, FILE* file), (text, file), file)
FAILING_STREAM(EOF, int, puts, (const char* text), (text), stdout)
FAILING_STREAM(EOF, int, fflush, (FILE * file), (file), file ? file : stdout)
FAILING(ENOSPC, -1, ssize_t, sendfile, (int to, int from, off_t* at, size_t size),
        (to, from, at, size))
FAILING_AFTER(EIO, EOF, fclose, FILE* file, file)
FAILING_AFTER(EIO, -1, close, int fd, fd)
FAILING_AFTER(EIO, -1, closedir, DIR* folder, folder)
FAILING(EIO, -1, off_t, lseek, (int fd, off_t to, int from), (fd, to, from))
FAILING(EIO, -1, int, fsync, (int fd), (fd))
FAILING(ENOLCK, -1, int, flock, (int fd, int how), (fd, how))
FAILING(EIO, -1, int, ftruncate, (int fd, off_t size), (fd, size))
FAILING(EACCES, -1, int, rename, (const char* from, const char* to), (from, to))
FAILING(EACCES, -1, int, mkdir, (const char* path, mode_t mode), (path, mode))
FAILING(EACCES, -1, int, stat, (const char* path, struct stat* to), (path, to))
FAILING(EACCES, -1, int, lstat, (const char* path, struct stat* to), (path, to))
FAILING(EIO, -1, int, fstat, (int fd, struct stat* to), (fd, to))
FAILING(EACCES, -1, int, fstatat, (int at, const char* path, struct stat* to, int flags),
        (at, path, to, flags))
FAILING(EIO, -1, int, statvfs, (const char* path, struct statvfs* to), (path, to))
FAILING(EACCES, -1, int, access, (const char* path, int mode), (path, mode))
FAILING(EPERM, -1, int, chmod, (const char* path, mode_t mode), (path, mode))
FAILING(EPERM, -1, int, fchmod, (int fd, mode_t mode), (fd, mode))
FAILING(EPERM, -1, int, fchown, (int fd, uid_t user, gid_t group), (fd, user, group))
FAILING(EACCES, NULL, char*, realpath, (const char* path, char* to), (path, to))
FAILING(ENOENT, NULL, char*, getcwd, (char* to, size_t size), (to, size))
FAILING(EACCES, -1, ssize_t, readlink, (const char* path, char* to, size_t size), (path, to, size))
FAILING(EACCES, -1, int, unlink, (const char* path), (path))
FAILING(EACCES, -1, int, unlinkat, (int at, const char* path, int flags), (at, path, flags))
FAILING(EACCES, -1, int, remove, (const char* path), (path))

FAILING(ENOMEM, MAP_FAILED, void*, mmap,
        (void* at, size_t size, int protection, int flags, int fd, off_t offset),
        (at, size, protection, flags, fd, offset))
FAILING(ENOMEM, -1, int, munmap, (void* at, size_t size), (at, size))
FAILING(ENOMEM, -1, int, mprotect, (void* at, size_t size, int protection), (at, size, protection))
FAILING(ENOMEM, -1, int, mlockall, (int flags), (flags))
FAILING(EPERM, -1, int, munlockall, (void), ())
FAILING(EPERM, -1, int, sched_setscheduler,
        (pid_t process, int policy, const struct sched_param* to), (process, policy, to))
FAILING(EPERM, -1, int, sched_getscheduler, (pid_t process), (process))
FAILING(EPERM, -1, int, sched_getparam, (pid_t process, struct sched_param* to), (process, to))
FAILING(EPERM, -1, int, sched_setaffinity, (pid_t process, size_t size, const cpu_set_t* to),
        (process, size, to))
FAILING(EPERM, -1, int, sched_getaffinity, (pid_t process, size_t size, cpu_set_t* to),
        (process, size, to))
FAILING(EAGAIN, EAGAIN, int, pthread_create,
        (pthread_t * to, const pthread_attr_t* how, void* (*run)(void*), void* what),
        (to, how, run, what))
FAILING(EINTR, -1, int, nanosleep, (const struct timespec* time, struct timespec* left),
        (time, left))
FAILING(EINTR, EINTR, int, clock_nanosleep,
        (clockid_t clock, int flags, const struct timespec* time, struct timespec* left),
        (clock, flags, time, left))

FAILING(EMFILE, -1, int, accept4, (int fd, struct sockaddr* from, socklen_t* size, int flags),
        (fd, from, size, flags))
FAILING(ENOBUFS, -1, int, listen, (int fd, int backlog), (fd, backlog))
FAILING(ECONNREFUSED, -1, int, connect, (int fd, const struct sockaddr* to, socklen_t size),
        (fd, to, size))
FAILING(ENOBUFS, -1, int, getsockopt, (int fd, int level, int option, void* to, socklen_t* size),
        (fd, level, option, to, size))
FAILING(ENOBUFS, -1, int, getsockname, (int fd, struct sockaddr* to, socklen_t* size),
        (fd, to, size))
FAILING(ENOBUFS, -1, ssize_t, send, (int fd, const void* from, size_t size, int flags),
        (fd, from, size, flags))
FAILING(ENOBUFS, -1, ssize_t, sendmsg, (int fd, const struct msghdr* from, int flags),
        (fd, from, flags))
FAILING(EIO, -1, ssize_t, recv, (int fd, void* to, size_t size, int flags), (fd, to, size, flags))
FAILING(EIO, -1, ssize_t, recvmsg, (int fd, struct msghdr* to, int flags), (fd, to, flags))
FAILING(ENOMEM, -1, int, recvmmsg,
        (int fd, struct mmsghdr* to, unsigned n, int flags, struct timespec* patience),
        (fd, to, n, flags, patience))
FAILING(ENOBUFS, -1, int, sendmmsg, (int fd, struct mmsghdr* from, unsigned n, int flags),
        (fd, from, n, flags))
FAILING(EINTR, -1, int, poll, (struct pollfd * fds, nfds_t count, int timeout_ms),
        (fds, count, timeout_ms))

CALL(fcntl);
int fcntl(int fd, int what, ...) {
  va_list more;
  va_start(more, what);
  void* to = va_arg(more, void*);
  va_end(more);
  return fails(&fcntl_call, EINVAL) ? -1 : NEXT(fcntl)(fd, what, to);
}

CALL(prctl);
int prctl(int what, ...) {
  va_list more;
  va_start(more, what);
  unsigned long a[4];
  for (int i = 0; i < 4; ++i) a[i] = va_arg(more, unsigned long);
  va_end(more);
  return fails(&prctl_call, EINVAL) ? -1 : NEXT(prctl)(what, a[0], a[1], a[2], a[3]);
}

CALL(syscall);
long syscall(long number, ...) {
  va_list more;
  va_start(more, number);
  long a[6];
  for (int i = 0; i < 6; ++i) a[i] = va_arg(more, long);
  va_end(more);
  if (fails(&syscall_call, ENOSYS)) return -1;
  return NEXT(syscall)(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}

/* A bus is a socket of another kind; what is sent there nobody hears. */
CALL(socket);
int socket(int domain, int type, int protocol) {
  if (fails(&socket_call, EMFILE)) return -1;
  if (!has_buses || domain != PF_CAN) return NEXT(socket)(domain, type, protocol);
  return NEXT(socket)(AF_UNIX, SOCK_DGRAM | (type & (SOCK_NONBLOCK | SOCK_CLOEXEC)), 0);
}

CALL(setsockopt);
int setsockopt(int fd, int level, int option, const void* value, socklen_t size) {
  if (fails(&setsockopt_call, ENOBUFS)) return -1;
  const int is_bus = has_buses && level == SOL_CAN_RAW;
  return is_bus ? 0 : NEXT(setsockopt)(fd, level, option, value, size);
}

CALL(bind);
int bind(int fd, const struct sockaddr* to, socklen_t size) {
  if (fails(&bind_call, EADDRINUSE)) return -1;
  /* A name without a file locks an interface, for all of the machine. */
  const int is_lock = to->sa_family == AF_UNIX && to->sa_data[0] == 0;
  return has_buses && (to->sa_family == AF_CAN || is_lock) ? 0 : NEXT(bind)(fd, to, size);
}

CALL(ioctl);
int ioctl(int fd, unsigned long what, ...) {
  va_list more;
  va_start(more, what);
  void* to = va_arg(more, void*);
  va_end(more);
  if (fails(&ioctl_call, EIO)) return -1;
  const int is_bus = has_buses && fd >= 0;
  struct ifreq* interface = to;
  if (is_bus && what == SIOCGIFINDEX) return interface->ifr_ifindex = 7, 0;
  if (is_bus && what == SIOCGIFFLAGS) return interface->ifr_flags = IFF_UP, 0;
  if (is_bus && what == SIOCGIFTXQLEN) return interface->ifr_qlen = 10, 0;
  return NEXT(ioctl)(fd, what, to);
}
