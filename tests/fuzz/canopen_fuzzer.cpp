#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "support/hostile_drive_bus.h"
#include "support/scripted_drive.h"
#include "tactus/canopen/canopen.h"
#include "tactus/canopen/sdo_client.h"

/// A drive, and an SDO client, under any sequence of frames: no velocity but the one that was asked
/// for, and none unless the drive is enabled (tests/support/hostile_drive_bus.h).
namespace {

using tactus::CanFrame;
using tactus::DriveGoal;
using tactus::FrameKind;
using tactus::test::HostileDriveBus;
using tactus::test::ScriptedDrive;

constexpr int kNode = 9;

void require(const char* problem) {
  if (problem == nullptr) return;
  std::fprintf(stderr, "%s\n", problem);
  std::abort();
}

/// The input, byte by byte; zeros behind its end.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool isEmpty() const { return size_ == 0; }
  std::uint8_t next() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  double number() {
    static constexpr double kNumbers[] = {0.0,
                                          -0.0,
                                          0.1,
                                          -0.7,
                                          1e-7,
                                          1e9,
                                          1e308,
                                          std::numeric_limits<double>::infinity(),
                                          std::numeric_limits<double>::quiet_NaN()};
    const std::uint8_t choice = next();
    if (choice < std::size(kNumbers)) return kNumbers[choice];
    return (choice - 128) / 128.0;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

/// Ids and sizes of the drive are likelier than others.
CanFrame nextFrame(Bytes& bytes) {
  static constexpr std::uint32_t kIds[] = {0x180, 0x580, 0x700, 0x080};
  static constexpr std::uint8_t kSizes[] = {6, 8, 1, 8};
  const std::uint8_t head = bytes.next();
  CanFrame frame;
  frame.id = kIds[head & 3] + kNode;
  frame.size = kSizes[head & 3];
  if ((head & 0x70) == 0x70) frame.id = bytes.next() << 3U | (head & 7U);
  if ((head & 0x70) == 0x60) frame.size = bytes.next();
  if ((head & 0x70) == 0x50) frame.kind = static_cast<FrameKind>(bytes.next() % 3);
  frame.extended = (head & 0x70) == 0x40;
  const int given = std::min<int>(frame.size, 8);
  for (int i = 0; i < given; ++i) frame.data[i] = bytes.next();
  return frame;
}

tactus::DriveConfig configOf(std::uint8_t options) {
  tactus::DriveConfig config;
  config.node_id = kNode;
  config.sign = (options & 1) != 0 ? 1 : -1;
  config.tracking_gain_per_s = (options & 2) != 0 ? 50.0 : 0.0;
  config.max_following_error = (options & 4) != 0 ? 1e9 : 0.05;
  config.max_velocity = (options & 4) != 0 ? 2.0 : std::numeric_limits<double>::infinity();
  return config;
}

/// The drive's master and a good drive; the input decides who is heard.
class Run {
 public:
  explicit Run(std::uint8_t options) : bus_(configOf(options), canopen(), 0.001) {}

  void goodCycle(DriveGoal goal, bool restart) {
    hearSlave();
    cycle(goal, restart, 0.0, bus_.drive().report().position);
  }

  void step(Bytes& bytes) {
    const std::uint8_t operation = bytes.next();
    if ((operation & 7) < 3) return bus_.receive(nextFrame(bytes));
    if ((operation & 7) == 3) return hearSlave();
    if ((operation & 7) == 4 && (operation & 0x80) != 0) return slave_.powerUp();
    if ((operation & 7) == 4) return slave_.fault(operation << 4);
    const auto goal = static_cast<DriveGoal>((operation >> 3) % 5);
    const double velocity = bytes.number();
    const bool is_near = (operation & 7) == 7;
    const double here = is_near ? bus_.drive().report().position : 0.0;
    for (int i = 0; i < (is_near ? 3 : 1); ++i) {
      if ((operation & 7) != 6) hearSlave();
      cycle(goal, (operation & 0x80) != 0 && i == 0, velocity, here + 0.05 * bytes.number());
    }
  }

 private:
  static tactus::CanopenConfig canopen() {
    tactus::CanopenConfig canopen;
    canopen.sdo_timeout_s = 0.005;  // short, so that the input gets there
    canopen.heartbeat_timeout_s = 0.03;
    canopen.boot_timeout_s = 0.02;
    return canopen;
  }

  void hearSlave() {
    for (const CanFrame& frame : slave_.take()) bus_.receive(frame);
  }

  void cycle(DriveGoal goal, bool restart, double velocity, double position) {
    require(bus_.update(goal, restart, velocity, position));
    for (const CanFrame& frame : bus_.sent()) slave_.hear(frame);
    slave_.hear(tactus::syncFrame());
  }

  HostileDriveBus bus_;
  ScriptedDrive slave_{kNode};
};

/// A run that is already enabled; made once, since the way there is always the same.
Run enabledRun(std::uint8_t options) {
  Run run(options);
  for (int i = 0; i < 90; ++i) run.goodCycle(DriveGoal::kConfigure, i == 0);
  for (int i = 0; i < 20; ++i) run.goodCycle(DriveGoal::kEnabled, false);
  return run;
}

void driveUnder(Bytes bytes, std::uint8_t options) {
  static const std::array<Run, 8> kEnabled = {enabledRun(0), enabledRun(1), enabledRun(2),
                                              enabledRun(3), enabledRun(4), enabledRun(5),
                                              enabledRun(6), enabledRun(7)};
  Run run = (options & 0x80) != 0 ? Run(options) : kEnabled[options & 7];
  for (int steps = 0; steps < 2000 && !bytes.isEmpty(); ++steps) run.step(bytes);
}

void clientUnder(Bytes bytes, std::uint8_t options) {
  constexpr int kTimeout = 6;
  tactus::SdoClient client(kNode, kTimeout);
  const tactus::ObjectEntry entry{0x6061, 0, 1 + (options >> 3 & 3)};
  int busy_cycles = 0;
  while (!bytes.isEmpty()) {
    const std::uint8_t operation = bytes.next();
    const bool begins = (operation & 7) < 2;
    if ((operation & 7) == 0) client.upload(entry);
    if ((operation & 7) == 1) client.download(entry, 0xFFFFFFFF);
    if (begins) busy_cycles = 0;
    if ((operation & 7) > 3) client.receive(nextFrame(bytes));
    if ((operation & 7) != 2) continue;
    tactus::FrameBatch out;
    client.update(out);
    require(out.size() <= 1 ? nullptr : "more than a frame a cycle");
    const bool is_busy = client.status() == tactus::SdoStatus::kBusy;
    busy_cycles = is_busy ? busy_cycles + 1 : 0;
    require(busy_cycles <= kTimeout ? nullptr : "a transfer without end");
    const std::uint64_t most = (std::uint64_t{1} << 8 * entry.size) - 1;
    require(client.value() <= most ? nullptr : "more bytes than the entry has");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const Bytes bytes(data + 1, size - 1);
  const std::uint8_t options = data[0];
  if ((options & 0x40) != 0) {
    clientUnder(bytes, options);
  } else {
    driveUnder(bytes, options);
  }
  return 0;
}
