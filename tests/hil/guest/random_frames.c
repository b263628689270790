// Sends random frames by all ids that the daemon listens to, at random among can0 to can3; the same
// ones for the same seed.
//
// usage: random_frames SEED COUNT PER_SECOND malformed|hostile
//
// malformed: of a kind or size that none of its frames has. hostile: mostly such that might be true.
#include <errno.h>
#include <linux/can.h>
#include <net/if.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

enum { kBuses = 4, kModuleBus = 3, kDrivesABus = 3 };

typedef struct {
  unsigned id;
  unsigned size;
} Layout;

// Of a drive, less its node id; of the module, its four frames.
static const Layout kOfDrive[] = {{0x080, 8}, {0x180, 6}, {0x580, 8}, {0x700, 1}};
static const Layout kOfModule[] = {{0x100, 8}, {0x101, 8}, {0x102, 8}, {0x103, 8}};

static uint64_t state;

static unsigned below(unsigned end) {
  state ^= state << 13;
  state ^= state >> 7;
  state ^= state << 17;
  return (unsigned)((state >> 20) % end);
}

static int open_bus(int number) {
  char name[IF_NAMESIZE];
  snprintf(name, sizeof(name), "can%d", number);
  const int bus = socket(PF_CAN, SOCK_RAW, CAN_RAW);
  const struct sockaddr_can address = {.can_family = AF_CAN,
                                       .can_ifindex = (int)if_nametoindex(name)};
  if (bus < 0 || bind(bus, (const struct sockaddr*)&address, sizeof(address)) != 0) {
    fprintf(stderr, "random_frames: %s: %s\n", name, strerror(errno));
    exit(1);
  }
  return bus;
}

static void distort(struct can_frame* frame, unsigned size) {
  switch (below(3)) {
    case 0:
      frame->can_id |= CAN_EFF_FLAG;
      break;
    case 1:
      frame->can_id |= CAN_RTR_FLAG;
      break;
    default:
      frame->len = (unsigned char)((size + 1 + below(8)) % 9);  // any but the right one
  }
}

static struct can_frame random_frame(int bus, bool is_hostile) {
  const Layout layout = (bus == kModuleBus ? kOfModule : kOfDrive)[below(4)];
  struct can_frame frame = {.can_id = layout.id, .len = (unsigned char)layout.size};
  if (bus != kModuleBus) frame.can_id += 1 + below(kDrivesABus);
  for (int i = 0; i < CAN_MAX_DLEN; ++i) frame.data[i] = (unsigned char)below(256);
  // Small numbers are states, sequence numbers and the end of an emergency.
  if (is_hostile && below(2) == 0) frame.data[0] = (unsigned char)below(8);
  if (!is_hostile || below(8) == 0) distort(&frame, layout.size);
  return frame;
}

int main(int count, char** arguments) {
  if (count != 5) {
    fprintf(stderr, "usage: random_frames SEED COUNT PER_SECOND malformed|hostile\n");
    return 2;
  }
  state = strtoull(arguments[1], NULL, 10) * 0x9E3779B97F4A7C15u + 1;
  const long period_ns = 1000000000 / atol(arguments[3]);
  const bool is_hostile = strcmp(arguments[4], "hostile") == 0;
  int buses[kBuses];
  for (int i = 0; i < kBuses; ++i) buses[i] = open_bus(i);
  for (long left = atol(arguments[2]); left > 0; --left) {
    const int bus = (int)below(kBuses);
    const struct can_frame frame = random_frame(bus, is_hostile);
    if (write(buses[bus], &frame, sizeof(frame)) != sizeof(frame) && errno != ENOBUFS) {
      fprintf(stderr, "random_frames: %s\n", strerror(errno));
      return 1;
    }
    nanosleep(&(struct timespec){.tv_nsec = period_ns}, NULL);
  }
  return 0;
}
