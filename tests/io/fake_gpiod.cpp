#include "io/fake_gpiod.h"

#include <errno.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>

namespace tactus::test {

FakeChip& resetFakeChip() {
  if (fake_chip.descriptor >= 0) close(fake_chip.descriptor);
  fake_chip = FakeChip{};
  return fake_chip;
}

void drive(unsigned line, int level) {
  if (fake_chip.lines[line].level == level) return;
  fake_chip.lines[line].level = level;
  if (fake_chip.lines[line].requested == Requested::kEdges) fake_chip.events.push_back(level);
}

void unplug(unsigned line) {
  const int pull = fake_chip.lines[line].pull;
  if (pull != 0) drive(line, pull > 0);
}

bool openFakeChip(const char* name) {
  errno = ENOENT;
  if (!fake_chip.is_present || std::strcmp(name, "gpiochip0") != 0) return false;
  return fake_chip.is_open = true;
}

bool answers() {
  ++fake_chip.calls;
  errno = EIO;
  return !fake_chip.is_gone;
}

bool requestLine(FakeLine& line, Requested as, int level, int pull) {
  errno = EBUSY;
  if (line.is_taken || line.requested != Requested::kNo) return false;
  errno = EINVAL;
  if (as == Requested::kEdges && !fake_chip.has_events) return false;
  if (pull != 0 && fake_chip.refuses_pulls) return false;
  line.pull = pull;
  line.requested = as;
  if (as == Requested::kOutput) line.level = level;
  return true;
}

int edgeDescriptor() {
  if (fake_chip.descriptor < 0) fake_chip.descriptor = open("/dev/null", O_RDONLY | O_CLOEXEC);
  return fake_chip.descriptor;
}

std::vector<int> readEdges(int descriptor, unsigned long count) {
  if (!answers()) return {};
  errno = EDEADLK;
  if ((fcntl(descriptor, F_GETFL) & O_NONBLOCK) == 0) return {};
  errno = EAGAIN;
  std::vector<int>& waiting = fake_chip.events;
  const auto end =
      waiting.begin() + static_cast<long>(std::min<std::size_t>(count, waiting.size()));
  const std::vector<int> read(waiting.begin(), end);
  waiting.erase(waiting.begin(), end);
  return read;
}

}  // namespace tactus::test
