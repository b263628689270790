// The wires at the virtual machine's GPIO chips (gpio.asl): sets what a line reads, shows what the
// kernel drives it to.
//
// usage: gpio_poke CHIP LINE [LEVEL]     CHIP: gpiochip0 (edge events) or gpiochip1 (polled)
//        gpio_poke gpiochip0 LINE falls  waits until the kernel drives it low
//
// Prints the wall clock's time of the change, to be compared with candump's. On gpiochip0 only one
// line in each group of four may be armed for edges: RAM keeps the flags of all four.
#include <errno.h>
#include <fcntl.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/io.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

typedef volatile uint32_t Register;

// pinctrl-amd: one register a line.
enum {
  kLevelTriggered = 1 << 8,
  kActiveLow = 1 << 9,
  kBothEdges = 1 << 10,
  kInterruptEnabled = 1 << 11,
  kInterruptUnmasked = 1 << 12,
  kInput = 1 << 16,
  kOutput = 1 << 22,
  kOutputEnabled = 1 << 23,
  kInterruptPending = 1 << 28,
};
// pinctrl-amd: registers of the whole chip, as indices.
enum { kMaster = 0xFC / 4, kGroupStatus = 0x2F8 / 4, kLinesOfEdgeChip = 63 };
enum { kEndOfInterrupt = 1 << 29 };
// gpio-amdpt: one bit a line.
enum { kDirection = 0, kInputs = 1, kOutputs = 2, kLinesOfPolledChip = 24 };
// The second serial port, whose "transmitter empty" is an interrupt that can be had at any time.
enum { kInterruptEnable = 0x2F9, kTransmitterEmpty = 0x02 };

static const off_t kRegisters = 0x20000000;
static const size_t kPolledChipOffset = 0x1000;

static void fail(const char* what) {
  fprintf(stderr, "gpio_poke: %s: %s\n", what, strerror(errno));
  exit(1);
}

static int number(const char* text, int end) {
  char* rest = NULL;
  const long value = strtol(text, &rest, 10);
  if (*text == '\0' || *rest != '\0' || value < 0 || value >= end) {
    fprintf(stderr, "gpio_poke: %s: expected 0 to %d\n", text, end - 1);
    exit(2);
  }
  return (int)value;
}

static Register* map_registers(void) {
  const int file = open("/dev/mem", O_RDWR | O_SYNC);
  if (file < 0) fail("/dev/mem");
  void* memory = mmap(NULL, 0x2000, PROT_READ | PROT_WRITE, MAP_SHARED, file, kRegisters);
  if (memory == MAP_FAILED) fail("mapping /dev/mem (kernel option iomem=relaxed)");
  return memory;
}

static void print_time(void) {
  struct timespec now;
  clock_gettime(CLOCK_REALTIME, &now);
  printf("(%lld.%09ld) ", (long long)now.tv_sec, now.tv_nsec);
}

static bool is_armed_for(uint32_t line, bool rises) {
  if (!(line & kInterruptEnabled) || !(line & kInterruptUnmasked)) return false;
  if (line & kLevelTriggered) return false;
  return (line & kBothEdges) || rises == !(line & kActiveLow);
}

// Waits until the driver says that it has handled the interrupt.
static void raise_interrupt(Register* chip, int line) {
  if (ioperm(kInterruptEnable, 1, 1) != 0) fail("ioperm");
  Register* group_status = &chip[kGroupStatus + line / 4 / 32];
  const uint32_t group = 1U << (line / 4 % 32);
  chip[line] |= kInterruptPending;
  *group_status |= group;
  chip[kMaster] &= ~kEndOfInterrupt;
  outb(kTransmitterEmpty, kInterruptEnable);
  bool handled = false;
  for (int i = 0; i < 1000 && !handled; ++i) {
    nanosleep(&(struct timespec){.tv_nsec = 10000}, NULL);
    handled = chip[kMaster] & kEndOfInterrupt;
  }
  outb(0, kInterruptEnable);
  *group_status &= ~group;
  chip[line] &= ~kInterruptPending;
  if (!handled) {
    errno = ETIMEDOUT;
    fail("no driver answers the interrupt");
  }
}

static void wait_until_low(const Register* chip, int line) {
  while (chip[line] & kOutput) nanosleep(&(struct timespec){.tv_nsec = 100000}, NULL);
}

static void poke_edge_chip(Register* chip, const char* line_text, const char* level_text) {
  const int line = number(line_text, kLinesOfEdgeChip);
  if (level_text && strcmp(level_text, "falls") == 0) {
    wait_until_low(chip, line);
    level_text = NULL;
  }
  const uint32_t before = chip[line];
  const bool was = before & kInput;
  const bool level = level_text ? number(level_text, 2) : was;
  print_time();
  if (level != was) {
    chip[line] ^= kInput;
    if (is_armed_for(before, level)) raise_interrupt(chip, line);
  }
  printf("in=%d out=%d driven=%d\n", level, !!(before & kOutput), !!(before & kOutputEnabled));
}

static void poke_polled_chip(Register* chip, const char* line_text, const char* level_text) {
  const uint32_t line = 1U << number(line_text, kLinesOfPolledChip);
  print_time();
  if (level_text && number(level_text, 2)) chip[kInputs] |= line;
  if (level_text && !number(level_text, 2)) chip[kInputs] &= ~line;
  printf("in=%d out=%d driven=%d\n", !!(chip[kInputs] & line), !!(chip[kOutputs] & line),
         !!(chip[kDirection] & line));
}

int main(int count, char** arguments) {
  const bool is_edge_chip = count > 1 && strcmp(arguments[1], "gpiochip0") == 0;
  const bool is_polled_chip = count > 1 && strcmp(arguments[1], "gpiochip1") == 0;
  if (count < 3 || count > 4 || (!is_edge_chip && !is_polled_chip)) {
    fprintf(stderr, "usage: gpio_poke gpiochip0|gpiochip1 LINE [LEVEL|falls]\n");
    return 2;
  }
  const char* level = count == 4 ? arguments[3] : NULL;
  Register* registers = map_registers();
  if (is_edge_chip)
    poke_edge_chip(registers, arguments[2], level);
  else
    poke_polled_chip(registers + kPolledChipOffset / sizeof(Register), arguments[2], level);
  return 0;
}
