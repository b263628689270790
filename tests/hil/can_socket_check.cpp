/// Checks the CAN socket on a real interface of the kernel, as root on a vcan that nobody else
/// uses: it is taken down, congested and in the end removed.
///
///     can_socket_check INTERFACE
///
/// With `modprobe vcan echo=1` and `modprobe sch_plug` a dead bus is played as well: the plug holds
/// frames in the kernel, and their echoes come once it is pulled, as on copper. Without them that
/// part is reported as left out. Exit status: 0 if all that was checked holds, 1 if not.

#include <errno.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "tactus/io/can_socket.h"
#include "tactus/io/raw_can_socket.h"

namespace tactus {
namespace {

int failures = 0;

void check(bool holds, const std::string& what) {
  std::printf("%s  %s\n", holds ? "ok    " : "FAILED", what.c_str());
  if (!holds) ++failures;
}

bool shell(const std::string& command) { return std::system(command.c_str()) == 0; }

/// A plain socket of somebody else on the same bus: sends and hears everything.
class OtherNode {
 public:
  explicit OtherNode(const std::string& interface)
      : descriptor_(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK, CAN_RAW)) {
    const int on = 1;
    setsockopt(descriptor_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on));
    sockaddr_can address{};
    address.can_family = AF_CAN;
    address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
    if (bind(descriptor_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) != 0)
      throw std::runtime_error(interface + ": no CAN interface");
  }
  ~OtherNode() { close(descriptor_); }

  bool send(std::uint32_t id, std::vector<std::uint8_t> data = {}) const {
    can_frame frame{};
    frame.can_id = id;
    frame.len = static_cast<std::uint8_t>(data.size());
    std::copy(data.begin(), data.end(), frame.data);
    return write(descriptor_, &frame, CAN_MTU) == CAN_MTU;
  }

  bool sendFd(std::uint32_t id) const {
    canfd_frame frame{};
    frame.can_id = id;
    frame.len = 64;
    return write(descriptor_, &frame, CANFD_MTU) == CANFD_MTU;
  }

  /// Ids of the data frames since the last call. Also takes note of an interface that was down,
  /// which the next call of a socket fails with.
  std::vector<std::uint32_t> heard() const {
    std::vector<std::uint32_t> ids;
    canfd_frame frame;
    for (;;) {
      if (read(descriptor_, &frame, sizeof(frame)) > 0)
        ids.push_back(frame.can_id);
      else if (errno != ENETDOWN)
        return ids;
    }
  }

 private:
  int descriptor_;
};

constexpr IdFilter kReceived[] = {{0x181}, {0x701}, {0x100, 0x7FC}};
constexpr IdFilter kSent[] = {{0x201}, {0x080}, {0x77F}};

CanFrame frameOf(std::uint32_t id, std::uint8_t size = 0) {
  CanFrame frame;
  frame.id = id;
  frame.size = size;
  for (std::uint8_t i = 0; i < size; ++i) frame.data[i] = static_cast<std::uint8_t>(0x10 + i);
  return frame;
}

const std::vector<CanFrame> kSetpoints = {frameOf(0x201, 6), frameOf(0x080)};
const CanFrame kHeartbeat = frameOf(0x77F, 1);

/// The daemon's cycle on one bus: receive, judge, send or probe.
FrameBatch cycle(CanSocket& bus) {
  FrameBatch frames;
  bus.receive(frames);
  bus.monitor().update();
  bus.send(kSetpoints);
  bus.probe(kHeartbeat);
  return frames;
}

/// vcan works in soft interrupts, which come soon but not at once.
void pause() { usleep(2000); }

int cyclesUntil(CanSocket& bus, Fault fault, int max_cycles) {
  int count = 0;
  for (; count < max_cycles && bus.monitor().fault() != fault; ++count) {
    cycle(bus);
    pause();
  }
  return count;
}

void checkExchange(const std::string& interface) {
  CanSocket bus(interface, kReceived, kSent);
  const OtherNode other(interface);
  for (int i = 0; i < 10; ++i) {
    cycle(bus);
    pause();
  }
  const BusCounters& counters = bus.monitor().counters();
  check(counters.sent == 20 && counters.held_back == 0 && counters.refused == 0 &&
            bus.monitor().fault() == Fault::kNone,
        "ten cycles are sent, each confirmed before the next");
  check(counters.received == 0, "own echoes are not returned");
  check(other.heard().size() == 20, "another node hears all twenty frames");

  other.send(0x181, {1, 2, 3, 4, 5, 6});
  other.send(0x102, {7, 8});
  pause();
  const FrameBatch frames = cycle(bus);
  check(frames.size() == 2 && frames.begin()[0].id == 0x181 && frames.begin()[0].size == 6 &&
            frames.begin()[0].data[5] == 6 && frames.begin()[1].id == 0x102 &&
            frames.begin()[1].kind == FrameKind::kData,
        "frames of the filters arrive in order, with id, size and data");
}

void checkForeign(const std::string& interface) {
  CanSocket bus(interface, kReceived, kSent);
  const OtherNode other(interface);
  other.send(0x182, {1});                 // another id
  other.send(0x104, {1});                 // just beside a masked filter
  other.send(0x181 | CAN_RTR_FLAG);       // remote
  other.send(0x181 | CAN_EFF_FLAG, {1});  // extended
  shell("ip link set " + interface + " down && ip link set " + interface +
        " mtu 72 && ip link set " + interface + " up");
  other.heard();
  const bool has_fd = other.sendFd(0x181);
  pause();
  FrameBatch frames;
  bus.receive(frames);  // tells of the interface's going down
  bus.receive(frames);
  check(frames.empty() && bus.monitor().counters().foreign == 0,
        "remote, extended and other ids are kept out by the kernel");
  check(has_fd && frames.empty(), "so are FD frames");
  other.send(0x201, {1, 2, 3, 4, 5, 6});
  pause();
  bus.receive(frames);
  check(frames.empty() && bus.monitor().counters().foreign == 1,
        "another node that sends by our ids is counted as foreign, and no confirmation");
}

CanFrame fdFrameOf(std::uint32_t id, std::uint8_t size) {
  CanFrame frame;
  frame.id = id;
  frame.is_fd = true;
  frame.extended = id > CAN_SFF_MASK;
  frame.size = size;
  for (std::uint8_t i = 0; i < size; ++i) frame.data[i] = static_cast<std::uint8_t>(0x40 + i);
  return frame;
}

/// After checkForeign(), which lets the interface carry CAN FD.
void checkFd(const std::string& interface) {
  constexpr std::uint32_t kToNode = 0x8001;
  const IdFilter received[] = {{0x100, 0x7FF, false, true}, {0x181}};
  const IdFilter sent[] = {{kToNode, CAN_EFF_MASK, true, true}, {0x201}};
  CanSocket bus(interface, received, sent, true);
  RawCanSocket player(interface, true);
  const std::vector<CanFrame> ours = {fdFrameOf(kToNode, 24), frameOf(0x201, 6)};
  FrameBatch frames;
  for (int i = 0; i < 5; ++i) {
    bus.receive(frames);
    bus.monitor().update();
    bus.send(ours);
    pause();
    player.receive(frames);
    check(std::equal(frames.begin(), frames.end(), ours.begin(), ours.end()),
          "a cycle of both kinds arrives as it was sent");
    player.send({{fdFrameOf(0x100, 64), frameOf(0x181, 6)}});
    pause();
  }
  bus.receive(frames);
  check(frames.size() == 2 && *frames.begin() == fdFrameOf(0x100, 64) &&
            *(frames.begin() + 1) == frameOf(0x181, 6),
        "so do answers of both kinds, after frames that were shorter");
  check(bus.monitor().fault() == Fault::kNone && bus.monitor().counters().sent == 10,
        "and each is confirmed");
  player.send({{fdFrameOf(0x181, 8), frameOf(0x100, 8)}});
  pause();
  bus.receive(frames);
  check(frames.empty() && bus.monitor().counters().foreign == 2,
        "an id that comes by the other kind of frame is foreign");
}

void checkUnconfirmed(const std::string& interface) {
  CanSocket bus(interface, kReceived, {});
  const OtherNode other(interface);
  const int cycles = cyclesUntil(bus, Fault::kBusUnacknowledged, 20);
  check(cycles == BusMonitor::kMaxUnconfirmedCycles + 2, "without echoes a bus is unacknowledged");
  check(other.heard().size() == 2, "and got one cycle's frames only");
}

void checkErrorFrames(const std::string& interface) {
  CanSocket bus(interface, kReceived, kSent);
  const OtherNode other(interface);
  cycle(bus);
  pause();
  other.send(CAN_ERR_FLAG | CAN_ERR_ACK | CAN_ERR_CRTL, {0, CAN_ERR_CRTL_TX_PASSIVE, 0, 0, 0, 0});
  pause();
  check(cycle(bus).empty() && bus.monitor().fault() == Fault::kBusUnacknowledged &&
            bus.monitor().counters().error_frames == 1,
        "an error frame names the unacknowledged bus in its cycle");
  other.heard();
  for (int i = 0; i < 90; ++i) cycle(bus);
  check(other.heard().empty(), "which gets no set-points");
  check(cyclesUntil(bus, Fault::kNone, 200) < 200, "a confirmed probe arms it again");
  other.send(CAN_ERR_FLAG | CAN_ERR_BUSOFF, {0, 0, 0, 0, 0, 0, 0, 0});
  pause();
  cycle(bus);
  check(bus.monitor().fault() == Fault::kBusOff, "bus-off is named in its cycle");
}

void checkFlood(const std::string& interface) {
  CanSocket bus(interface, kReceived, kSent);
  const OtherNode other(interface);
  for (int i = 0; i < 1000; ++i) other.send(0x181, {1, 2, 3, 4, 5, 6});
  pause();
  std::size_t received = 0;
  for (int i = 0; i < 10; ++i) {
    received += cycle(bus).size();
    pause();
  }
  check(received >= FrameBatch::kCapacity && received < 3 * FrameBatch::kCapacity &&
            bus.monitor().fault() == Fault::kNone,
        "of a backlog " + std::to_string(received) + " frames are kept, and are no flood");
  for (int i = 0; i < BusMonitor::kMaxFullBatches; ++i) {
    for (int k = 0; k < 100; ++k) other.send(0x181, {1, 2, 3, 4, 5, 6});
    pause();
    FrameBatch frames;
    bus.receive(frames);
    bus.monitor().update();
  }
  check(bus.monitor().fault() == Fault::kBusFlooded, "three full batches are a flood");
  check(cyclesUntil(bus, Fault::kNone, 100) < 100, "which passes");
}

void checkDown(const std::string& interface) {
  CanSocket bus(interface, kReceived, kSent);
  const OtherNode other(interface);
  cyclesUntil(bus, Fault::kBusDown, 5);
  shell("ip link set " + interface + " down");
  check(cyclesUntil(bus, Fault::kBusDown, 2) == 1, "an interface that goes down is named at once");
  for (int i = 0; i < 250; ++i) cycle(bus);
  check(bus.monitor().fault() == Fault::kBusDown, "and as long as it is down");
  other.heard();
  shell("ip link set " + interface + " up");
  const std::uint64_t sent = bus.monitor().counters().sent;
  const int cycles = cyclesUntil(bus, Fault::kNone, 300);
  check(cycles <= BusMonitor::kProbeCycles + BusMonitor::kCalmCycles + 5,
        "a probe finds it when it is up again, after " + std::to_string(cycles) + " cycles");
  const std::vector<std::uint32_t> ids = other.heard();
  check(!ids.empty() && ids.front() == 0x77F, "the first frame then is the probe");
  check(bus.monitor().counters().sent == sent + 1 + 2, "one probe and the new set-points");

  bool is_refused = false;
  shell("ip link set " + interface + " down");
  try {
    const CanSocket second(interface, kReceived, kSent);
  } catch (const std::exception& error) {
    is_refused = std::string(error.what()).find("is down") != std::string::npos;
    std::printf("        %s\n", error.what());
  }
  check(is_refused, "a socket on an interface that is down is refused");
  try {
    requireUp(interface);
    check(false, "an interface that is down is told apart");
  } catch (const std::system_error& error) {
    check(error.code().value() == ENETDOWN, "an interface that is down is told apart");
  }
  shell("ip link set " + interface + " up");
}

void checkLock(const std::string& interface) {
  const InterfaceLock lock(interface);
  int refused = 0;
  for (int i = 0; i < 2; ++i) {
    try {
      const InterfaceLock second(interface);
    } catch (const std::runtime_error& error) {
      std::printf("        %s\n", error.what());
      ++refused;
    }
  }
  check(refused == 2, "a second lock is refused, twice");
  const InterfaceLock of_another_program(interface, "another program");
}

constexpr unsigned kEchoFlag = 1U << 18;  // IFF_ECHO of linux/if.h, which bites with net/if.h

bool echoesAtTheDriver(const std::string& interface) {
  std::FILE* file = std::fopen(("/sys/class/net/" + interface + "/flags").c_str(), "r");
  unsigned flags = 0;
  if (file != nullptr) {
    if (std::fscanf(file, "%x", &flags) != 1) flags = 0;
    std::fclose(file);
  }
  return (flags & kEchoFlag) != 0;
}

/// Frames of one send that the socket's buffer takes while nothing leaves the kernel.
int sendBufferFrames(const CanSocket& bus) {
  can_frame frame{};
  frame.can_id = 0x77F;
  int count = 0;
  while (count < 1000 && send(bus.descriptor(), &frame, sizeof(frame), MSG_DONTWAIT) > 0) ++count;
  return count;
}

void checkDeadBus(const std::string& interface) {
  const std::string plug = "tc qdisc change dev " + interface + " root plug ";
  if (!echoesAtTheDriver(interface) ||
      !shell("ip link set " + interface + " txqueuelen 10 && tc qdisc add dev " + interface +
             " root plug limit 16384 && " + plug + "release_indefinite")) {
    std::printf("left out: a dead bus (needs vcan echo=1, sch_plug and tc)\n");
    return;
  }
  CanSocket bus(interface, kReceived, kSent);
  const OtherNode other(interface);
  check(transmitQueueLength(interface) == 10, "the transmit queue's length is read");
  for (int i = 0; i < 5; ++i) {
    cycle(bus);
    pause();
  }
  check(bus.monitor().counters().held_back == 0, "the driver's echoes confirm frames");

  shell(plug + "block");
  cycle(bus);
  cycle(bus);
  shell(plug + "release_indefinite");
  pause();
  cycle(bus);
  check(bus.monitor().fault() == Fault::kNone && bus.monitor().counters().held_back == 1,
        "a passing stall holds one cycle back and is no fault");
  pause();

  shell(plug + "block");
  other.heard();
  const int cycles = cyclesUntil(bus, Fault::kBusStalled, 20);
  check(cycles == BusMonitor::kMaxUnconfirmedCycles + 2, "a dead bus is stalled");
  const std::uint64_t sent = bus.monitor().counters().sent;
  for (int i = 0; i < 550; ++i) cycle(bus);
  check(bus.monitor().counters().sent == sent + 5, "it gets a probe each hundred cycles");
  check(other.heard().empty() && bus.monitor().fault() == Fault::kBusStalled,
        "and stays dead as long as nothing is confirmed");
  shell(plug + "release_indefinite");
  const int back = cyclesUntil(bus, Fault::kNone, 300);
  const std::vector<std::uint32_t> ids = other.heard();
  check(back < 300, "it is back after " + std::to_string(back) + " cycles");
  check(ids.size() >= 7 && ids[0] == 0x201 && ids[1] == 0x080 &&
            std::all_of(ids.begin() + 2, ids.begin() + 7, [](auto id) { return id == 0x77F; }),
        "what had waited in the kernel was one cycle's frames and five probes");

  shell(plug + "block");
  const int fit = sendBufferFrames(bus);
  check(fit >= 8 && fit <= 32, "the send buffer holds " + std::to_string(fit) + " frames");
  cycle(bus);
  check(bus.monitor().counters().refused == 2, "frames that do not fit are dropped and counted");
  for (int i = 0; i < 5; ++i) cycle(bus);
  check(bus.monitor().fault() == Fault::kBusStalled, "a buffer that stays full is a stalled bus");
  shell("tc qdisc del dev " + interface + " root");
}

void checkGone(const std::string& interface) {
  CanSocket bus(interface, kReceived, kSent);
  RawCanSocket player(interface);
  FrameBatch frames;
  player.receive(frames);
  check(!player.isGone(), "who plays the bus sees the interface");
  cycle(bus);
  shell("ip link del " + interface);
  do player.receive(frames);
  while (frames.size() > 0);
  check(player.isGone(), "and that it is removed");
  check(cyclesUntil(bus, Fault::kBusDown, 2) == 1, "an interface that is removed is named at once");
  for (int i = 0; i < 250; ++i) cycle(bus);
  check(bus.monitor().fault() == Fault::kBusDown && bus.monitor().counters().sent == 2,
        "and stays away");
}

void checkAll(const std::string& interface) {
  checkExchange(interface);
  checkForeign(interface);
  checkFd(interface);
  checkUnconfirmed(interface);
  checkErrorFrames(interface);
  checkFlood(interface);
  checkDown(interface);
  checkLock(interface);
  checkDeadBus(interface);
  checkGone(interface);
}

}  // namespace
}  // namespace tactus

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: can_socket_check INTERFACE\n");
    return 2;
  }
  try {
    tactus::checkAll(argv[1]);
  } catch (const std::exception& error) {
    tactus::check(false, error.what());
  }
  std::printf("%d failed\n", tactus::failures);
  return tactus::failures == 0 ? 0 : 1;
}
