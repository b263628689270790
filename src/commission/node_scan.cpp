#include "tactus/commission/node_scan.h"

#include <algorithm>
#include <numeric>

#include "tactus/canopen/canopen.h"
#include "tactus/canopen/cycle_count.h"

namespace tactus {
namespace {

constexpr double kSettling_s = 0.1;
constexpr int kTries = 2;

enum Entry : std::size_t {
  kDeviceType,
  kVendor,
  kProduct,
  kStatusWord,
  kIncrements,
  kMotorTurns,
  kGearMotorTurns,
  kGearShaftTurns,
  kSpeedLimit,
};

const std::vector<ObjectEntry>& scannedEntries() {
  static const std::vector<ObjectEntry> kEntries = {{0x1000, 0, 4}, {0x1018, 1, 4}, {0x1018, 2, 4},
                                                    {0x6041, 0, 2}, {0x608F, 1, 4}, {0x608F, 2, 4},
                                                    {0x6091, 1, 4}, {0x6091, 2, 4}, {0x607F, 0, 4}};
  return kEntries;
}

std::optional<double> ratio(const ObjectReader& node, Entry numerator, Entry denominator) {
  const auto above = node.value(numerator), below = node.value(denominator);
  if (!above || !below || *above == 0 || *below == 0) return std::nullopt;
  return static_cast<double>(*above) / *below;
}

FoundNode foundNode(int bus, const ObjectReader& node) {
  FoundNode found{bus,
                  node.nodeId(),
                  node.value(kDeviceType),
                  node.value(kVendor),
                  node.value(kProduct),
                  std::nullopt,
                  std::nullopt,
                  node.isAnsweredTwice()};
  if (const auto word = node.value(kStatusWord))
    found.status_word = static_cast<std::uint16_t>(*word);
  const auto encoder = ratio(node, kIncrements, kMotorTurns);
  const auto gear = ratio(node, kGearMotorTurns, kGearShaftTurns);
  found.has_speed_limit = node.value(kSpeedLimit).has_value();
  if (encoder && gear) found.counts_per_turn = *encoder * *gear;
  return found;
}

}  // namespace

NodeScan::NodeScan(const HardwareConfig& hardware, double period_s)
    : settling_cycles_(cyclesLasting(kSettling_s, period_s)) {
  std::vector<int> ids(kMaxNodeId);
  std::iota(ids.begin(), ids.end(), 1);
  const int timeout = cyclesLasting(hardware.canopen.sdo_timeout_s, period_s);
  for (const BusConfig& bus : hardware.buses)
    buses_.emplace_back(ids, scannedEntries(), timeout, kTries,
                        readingPace(bus.bit_rate_per_s, period_s));
}

void NodeScan::receive(int bus, std::span<const CanFrame> frames) noexcept {
  for (const CanFrame& frame : frames) buses_[bus].receive(frame);
}

void NodeScan::update(std::span<FrameBatch> outboxes) noexcept {
  for (std::size_t bus = 0; bus < buses_.size(); ++bus) {
    if (cycles_ == 0) outboxes[bus].push(nmtFrame({NmtCommand::kEnterPreOperational, 0}));
    if (cycles_ >= settling_cycles_) buses_[bus].update(outboxes[bus]);
  }
  cycles_ = std::min(cycles_, settling_cycles_) + 1;
}

bool NodeScan::isDone() const noexcept {
  return std::ranges::all_of(buses_, [](const BusReader& bus) { return bus.isDone(); });
}

std::vector<FoundNode> NodeScan::nodes() const {
  std::vector<FoundNode> found;
  for (std::size_t bus = 0; bus < buses_.size(); ++bus) {
    for (const ObjectReader& node : buses_[bus].nodes())
      if (!node.isSilent()) found.push_back(foundNode(static_cast<int>(bus), node));
  }
  return found;
}

}  // namespace tactus
