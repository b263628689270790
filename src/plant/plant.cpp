#include "tactus/plant/plant.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tactus/canopen/visit_kind.h"
#include "tactus/plant/module_frames.h"

namespace tactus {
namespace {

using Kind = Trouble::Kind;

constexpr std::uint32_t kSyncId = 0x80;
constexpr double kFirstMove_periods = 0.25;
// After the first SYNC: behind those of later cycles, which setpoints precede on the bus, and early
// enough that the module's frames do not end as the daemon reads, where chance picks the sample.
constexpr double kMoveAfterSync_periods = 0.5;
constexpr std::int64_t kLongSilence_periods = 100;
constexpr double kStandstill = 1e-3;  // m/s or rad/s

/// Calls a function with the drive, whatever its kind.
template <class Node, class Function>
decltype(auto) with(Node& node, Function function) noexcept {
  return visitKind(function, node.drive);
}

/// A module on a bus has 24 bits, filters only if nobody behind it does, and is tared there.
PlantConfig withModulesOf(const HardwareConfig& hardware, PlantConfig plant) {
  for (std::size_t i = 0; i < hardware.tactile_modules.size(); ++i) {
    const CanTactileConfig& on_bus = hardware.tactile_modules[i];
    SimulatedModuleConfig& module = plant.modules[i];
    module.quantised = true;
    module.channels.sample_period_s = on_bus.channels.sample_period_s;
    if (on_bus.filter_cutoff_hz) module.filter_place = FilterPlace::kNone;
    module.tared = false;
  }
  return plant;
}

}  // namespace

Plant::Plant(const ControllerConfig& robot, const PlantConfig& plant,
             const HardwareConfig& hardware, double period_s, std::vector<Trouble> troubles)
    : hardware_(hardware),
      period_s_(period_s),
      period_ns_(std::llround(1e9 * period_s)),
      world_(robot, withModulesOf(hardware, plant), period_s),
      velocity_(JointVector::Zero(robot.q_start.size())),
      script_(std::move(troubles)),
      next_move_ns_(std::llround(1e9 * kFirstMove_periods * period_s)),
      last_sync_ns_(-(kLongSilence_periods + 1) * period_ns_) {
  std::vector<int> nodes(hardware_.buses.size(), 1);
  for (const DriveConfig& config : hardware_.drives) {
    Node node{SlaveDrive(config, period_s), config.bus, nodes[config.bus]++,
              static_cast<std::uint32_t>(config.node_id)};
    if (config.kind == DriveKind::kMoteus) node.drive = MoteusSlave(config, period_s);
    drives_.push_back(node);
  }
  for (const CanTactileConfig& config : hardware_.tactile_modules)
    modules_.push_back({config.bus, config.first_id, nodes[config.bus]++});
  for (int bus = 0; bus < static_cast<int>(nodes.size()); ++bus)
    links_.push_back({PlantBus(hardware_.buses[bus].bit_rate_per_s, nodes[bus],
                               hardware_.buses[bus].data_bit_rate_per_s),
                      FrameTroubles(bus),
                      {}});
  world_.read(seen_);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    with(drives_[i], [&](auto& drive) {
      drive.setPosition(seen_.q_measured[hardware_.drives[i].joint]);
      drive.setPowered(true, 0);
    });
    noteNextEvent(drives_[i]);
  }
}

void Plant::send(int bus, const CanFrame& frame, std::int64_t t_ns) noexcept {
  const std::uint8_t most = frame.is_fd ? kMaxFdBytes : kMaxClassicBytes;
  if (bus < 0 || bus >= buses() || frame.kind == FrameKind::kError || frame.size > most) return;
  if (t_ns > now_ns_) advance(t_ns);
  links_[bus].bus.send(PlantBus::kOtherSide, frame, now_ns_);
}

void Plant::advance(std::int64_t t_ns) noexcept {
  for (std::int64_t next_ns = nextEvent_ns(); next_ns <= t_ns; next_ns = nextEvent_ns()) {
    now_ns_ = std::max(now_ns_, next_ns);
    step(now_ns_);
  }
  now_ns_ = std::max(now_ns_, t_ns);
}

void Plant::take(int bus, FrameBatch& frames) noexcept {
  frames.clear();
  for (const CanFrame& frame : links_[bus].inbox) frames.push(frame);
  links_[bus].inbox.clear();
}

void Plant::play(std::vector<Trouble> troubles, std::int64_t t_ns) {
  script_ = TroubleScript(std::move(troubles));
  script_.start(t_ns);
  applyTroubles(t_ns);
}

std::int64_t Plant::nextEvent_ns() const noexcept {
  std::int64_t next_ns = std::min(next_move_ns_, next_trouble_ns_);
  for (const Link& link : links_)
    next_ns = std::min({next_ns, link.bus.nextEvent_ns(), link.troubles.nextDelivery_ns()});
  for (const Node& node : drives_) next_ns = std::min(next_ns, node.next_event_ns);
  return next_ns;
}

bool Plant::emergencyStop(std::int64_t t_ns) const noexcept {
  return script_.isActive(Kind::kEmergencyStop, t_ns);
}

PowerState Plant::powerState(int joint) const noexcept {
  return with(drives_[joint], [](const auto& drive) { return drive.powerState(); });
}

PlantCounters Plant::counters() const noexcept {
  PlantCounters counters;
  counters.frames_not_taken = frames_not_taken_;
  counters.powers_taken_in_motion = powers_taken_in_motion_;
  for (const Link& link : links_) counters.frames_refused += link.bus.refused();
  for (const Node& node : drives_)
    counters.stale_setpoints_applied +=
        with(node, [](const auto& drive) { return drive.staleSetpoints(); });
  return counters;
}

void Plant::step(std::int64_t t_ns) noexcept {
  if (t_ns >= next_trouble_ns_) applyTroubles(t_ns);
  for (int bus = 0; bus < buses(); ++bus) moveBus(bus, t_ns);
  for (Node& node : drives_) {
    if (t_ns < node.next_event_ns) continue;
    with(node, [t_ns](auto& drive) { drive.update(t_ns); });
    collect(node, t_ns);
  }
  if (t_ns >= next_move_ns_) moveWorld(t_ns);
}

void Plant::applyTroubles(std::int64_t t_ns) noexcept {
  for (int bus = 0; bus < buses(); ++bus) applyBusTroubles(bus, t_ns);
  for (Node& node : drives_) {
    with(node, [&](auto& drive) { drive.setTroubles(troublesOf(node, t_ns)); });
    collect(node, t_ns);
  }
  next_trouble_ns_ = script_.nextChange_ns(t_ns);
}

DriveTroubles Plant::troublesOf(const Node& node, std::int64_t t_ns) const noexcept {
  const auto has = [&](Kind kind) { return script_.isActive(kind, node.bus, node.id, t_ns); };
  DriveTroubles troubles;
  troubles.is_failing = has(Kind::kDriveFault);
  troubles.ignores_commands = has(Kind::kIgnoreCommands);
  troubles.freezes_feedback = has(Kind::kFreezeFeedback);
  troubles.tells_nonsense = has(Kind::kNonsenseStatus);
  troubles.claims_boot_up = has(Kind::kBootUp);
  troubles.watches_heartbeat_only = has(Kind::kHeartbeatOnly);
  return troubles;
}

void Plant::applyBusTroubles(int bus, std::int64_t t_ns) noexcept {
  Link& link = links_[bus];
  link.troubles.release(t_ns);
  const bool is_powered = !script_.isActive(Kind::kPowerCut, bus, t_ns);
  if (is_powered != link.bus.isPowered()) {
    link.bus.setPowered(is_powered, t_ns);
    for (Node& node : drives_)
      if (node.bus == bus) with(node, [&](auto& drive) { drive.setPowered(is_powered, t_ns); });
  }
  link.bus.setOtherSideOff(script_.isActive(Kind::kBusOff, bus, t_ns), t_ns);
}

void Plant::moveBus(int bus, std::int64_t t_ns) noexcept {
  Link& link = links_[bus];
  if (link.bus.nextEvent_ns() <= t_ns)
    if (const auto delivery = link.bus.step()) link.troubles.add(*delivery, script_, t_ns);
  while (link.troubles.nextDelivery_ns() <= t_ns) deliver(bus, link.troubles.pop(), t_ns);
}

void Plant::deliver(int bus, const BusDelivery& delivery, std::int64_t t_ns) noexcept {
  Link& link = links_[bus];
  if (delivery.sender != PlantBus::kOtherSide) {
    if (delivery.sender == PlantBus::kController || !link.bus.isOtherSideOff())
      give(link, delivery.item.frame);
    return;
  }
  const CanFrame& frame = delivery.item.frame;
  // Controllers of CAN FD have no SYNC: the first command of a cycle is theirs.
  const bool is_sync = frame.id == kSyncId && !frame.extended && !frame.is_fd;
  if (frame.kind == FrameKind::kData && (is_sync || frame.is_fd)) hearSync(t_ns);
  for (Node& node : drives_) {
    if (node.bus != bus) continue;
    tell(node, delivery.item, t_ns);
    collect(node, t_ns);
  }
  noticeEnabling(t_ns);
}

void Plant::tell(Node& node, const QueuedFrame& item, std::int64_t t_ns) noexcept {
  const auto holds = [](const auto& drive) { return hasTorque(drive.powerState()); };
  const bool held = with(node, holds);
  with(node, [&](auto& drive) { drive.receive(item, t_ns); });
  const double speed = with(node, [](const auto& drive) { return std::abs(drive.velocity()); });
  if (held && !with(node, holds) && speed > kStandstill) ++powers_taken_in_motion_;
}

void Plant::hearSync(std::int64_t t_ns) noexcept {
  if (t_ns - last_sync_ns_ > kLongSilence_periods * period_ns_)
    next_move_ns_ = t_ns + std::llround(1e9 * kMoveAfterSync_periods * period_s_);
  last_sync_ns_ = t_ns;
}

void Plant::give(Link& link, const CanFrame& frame) noexcept {
  if (!link.inbox.push(frame)) ++frames_not_taken_;
}

void Plant::noteNextEvent(Node& node) noexcept {
  node.next_event_ns = with(node, [](const auto& drive) { return drive.nextEvent_ns(); });
}

void Plant::collect(Node& node, std::int64_t t_ns) noexcept {
  noteNextEvent(node);
  FrameBatch& outbox = with(node, [](auto& drive) -> FrameBatch& { return drive.outbox(); });
  for (const CanFrame& frame : outbox) links_[node.bus].bus.send(node.number, frame, t_ns);
  outbox.clear();
}

void Plant::moveWorld(std::int64_t t_ns) noexcept {
  next_move_ns_ = t_ns + period_ns_;
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    velocity_[hardware_.drives[i].joint] = with(drives_[i], [&](auto& drive) {
      drive.move(period_s_);
      return drive.velocity();
    });
  }
  world_.write(velocity_);
  world_.read(seen_);
  for (std::size_t i = 0; i < drives_.size(); ++i) {
    with(drives_[i],
         [&](auto& drive) { drive.setPosition(seen_.q_measured[hardware_.drives[i].joint]); });
    collect(drives_[i], t_ns);
  }
  sendSamples(t_ns);
}

void Plant::sendSamples(std::int64_t t_ns) noexcept {
  for (std::size_t i = 0; i < modules_.size(); ++i) {
    Module& module = modules_[i];
    const std::uint32_t sequence = seen_.tactile[i].sequence;
    if (sequence == module.sample_sequence) continue;
    module.sample_sequence = sequence;
    for (const CanFrame& frame : moduleFrames(module.first_id, static_cast<std::uint8_t>(sequence),
                                              world_.module(static_cast<int>(i)).counts(), false))
      links_[module.bus].bus.send(module.number, frame, t_ns);
  }
}

void Plant::noticeEnabling(std::int64_t t_ns) noexcept {
  if (script_.hasStarted()) return;
  const bool is_enabled = std::any_of(drives_.begin(), drives_.end(), [](const Node& node) {
    return with(node, [](const auto& drive) { return drive.powerState(); }) ==
           PowerState::kOperationEnabled;
  });
  if (!is_enabled) return;
  world_.restartTime();
  script_.start(t_ns);
  applyTroubles(t_ns);
}

}  // namespace tactus
