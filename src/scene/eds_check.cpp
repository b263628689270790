#include "tactus/scene/eds_check.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

#include "tactus/canopen/cia402.h"
#include "tactus/canopen/drive_setup.h"
#include "tactus/scene/eds_object.h"

namespace tactus {
namespace {

using StepKind = SetupStep::Kind;

[[noreturn]] void refuseObject(const SourcePosition& at, const EdsObject& object, const char* key,
                               const std::string& problem, const std::string& expectation) {
  failAt(at, object.name + "." + key, problem, "expected " + expectation);
}

EdsObject requireObject(const EdsFile& eds, std::uint16_t index, std::uint8_t subindex,
                        const char* what) {
  const auto object = findEdsObject(eds, index, subindex);
  if (object) return *object;
  const EdsSection* const section = eds.find(fmt::format("{:x}", index));
  failAt(section ? section->at : eds.begin, edsName(index, subindex), "the drive does not have it",
         std::string("expected ") + what);
}

// Device ------------------------------------------------------------------------------------------

/// A number of [DeviceInfo], and where it stands.
struct DeviceNumber {
  std::int64_t value;
  SourcePosition at;
};

DeviceNumber requiredNumber(const EdsFile& eds, const std::string& key, const char* expectation) {
  const EdsSection* const device = eds.find("DeviceInfo");
  if (!device)
    failAt(eds.begin, "DeviceInfo", "the section is missing", "expected an EDS of CiA 306");
  const EdsValue* const value = device->find(key);
  const std::string path = "DeviceInfo." + key;
  if (!value) failAt(device->at, path, "is missing", std::string("expected ") + expectation);
  const auto number = parseEdsNumber(value->text);
  if (!number || number->plus_node_id)
    failAt(value->at, path, inQuotes(value->text) + " is no number",
           std::string("expected ") + expectation);
  return {number->value, value->at};
}

void checkBitRate(const EdsFile& eds, const BusConfig& bus) {
  static constexpr std::array kRates = {10, 20, 50, 125, 250, 500, 800, 1000};
  for (const int rate : kRates) {
    if (std::abs(bus.bit_rate_per_s - 1e3 * rate) > 0.5) continue;
    const std::string key = fmt::format("BaudRate_{}", rate);
    const DeviceNumber can = requiredNumber(eds, key, "0 or 1");
    if (can.value == 1) return;
    failAt(can.at, "DeviceInfo." + key,
           fmt::format("the drive does not have the {} kbit/s of {}", rate, bus.interface),
           "expected 1, or another can.buses bit_rate_per_s");
  }
  failAt(eds.begin, "DeviceInfo",
         fmt::format("no drive has the {} bit/s of {}", bus.bit_rate_per_s, bus.interface),
         "expected 10, 20, 50, 125, 250, 500, 800 or 1000 kbit/s");
}

/// PDOs that a sheet counts and does not describe may be on the bus by default, where nothing has
/// switched them off. Up to the fourth the set-up does so, whether they are described or not.
void checkPdos(const EdsFile& eds, const std::string& key, std::uint16_t first) {
  constexpr int kPredefined = 4;
  const DeviceNumber pdos = requiredNumber(eds, key, "1 or more");
  if (pdos.value < 1)
    failAt(pdos.at, "DeviceInfo." + key, "the drive has no such PDO", "expected 1 or more");
  const int described = edsPdos(eds, first, kPredefined);
  if (pdos.value <= described) return;
  failAt(pdos.at, "DeviceInfo." + key,
         fmt::format("{} PDOs, and none is described beyond {:04X}", pdos.value,
                     first + described - 1),
         fmt::format("expected at most {}, or a file that is whole", described));
}

void checkDeviceInfo(const EdsFile& eds, const BusConfig& bus) {
  constexpr int kSmallestMapped_bits = 16;
  checkBitRate(eds, bus);
  checkPdos(eds, "NrOfRXPDO", 0x1400);
  checkPdos(eds, "NrOfTXPDO", 0x1800);
  const DeviceNumber granularity = requiredNumber(eds, "Granularity", "1 to 16 bits");
  if (granularity.value < 1 || granularity.value > kSmallestMapped_bits)
    failAt(granularity.at, "DeviceInfo.Granularity",
           granularity.value == 0 ? "the drive's PDO mapping cannot be changed"
                                  : "the drive maps no 16 bits",
           "expected 1 to 16 bits");
}

/// Object 6502, bit 8: cyclic synchronous velocity. Many sheets leave its value open.
void checkModes(const EdsFile& eds) {
  constexpr std::int64_t kCyclicVelocity = 1 << 8;
  const auto modes = findEdsObject(eds, 0x6502, 0);
  if (!modes || !modes->initial || (modes->initial->value & kCyclicVelocity) != 0) return;
  if (modes->initial->value == 0) return;
  refuseObject(
      modes->initial_at, *modes, "DefaultValue",
      fmt::format("{:#x} is without cyclic synchronous velocity, mode 9", modes->initial->value),
      "bit 8 set");
}

// Entries -----------------------------------------------------------------------------------------

/// Signed where the sign counts: a mode, a power of ten, positions, velocities and torques.
bool isSigned(const ObjectEntry& entry) {
  return entry.index == 0x6060 || entry.index == 0x6061 || entry.index == 0x6064 ||
         entry.index == 0x60B1 || entry.index == 0x60B2 || entry.index == 0x60FF ||
         (entry.index == 0x60C2 && entry.subindex == 2);
}

void checkEntryType(const EdsObject& object, const ObjectEntry& entry) {
  const bool is_right =
      object.type.bytes == entry.size && (!isSigned(entry) || object.type.is_signed);
  if (is_right) return;
  refuseObject(object.type_at, object, "DataType",
               fmt::format("{} {} bit", object.type.is_signed ? "signed" : "unsigned",
                           8 * object.type.bytes),
               fmt::format("a {}type of {} bit", isSigned(entry) ? "signed " : "", 8 * entry.size));
}

std::int64_t writtenValue(const SetupStep& step) {
  const EdsType type{step.entry.size, isSigned(step.entry)};
  EdsObject as_written;
  as_written.type = type;
  return as_written.inType(step.value);
}

/// What may hold it from the beginning is perhaps never written.
bool mayBeEnsured(const EdsObject& object, const SetupStep& step) {
  return step.kind == StepKind::kEnsure &&
         (!object.initial || object.ofEachNode(object.initial) == writtenValue(step));
}

void checkAccess(const EdsObject& object, const SetupStep& step) {
  const bool has_to_read =
      step.kind == StepKind::kExpect || (step.kind == StepKind::kEnsure && !step.tellsAllBits());
  if (has_to_read && !object.isReadable())
    refuseObject(object.access_at, object, "AccessType", "cannot be read", "ro or rw");
  const bool has_to_write = step.kind != StepKind::kExpect && !mayBeEnsured(object, step) &&
                            step.need < SetupStep::Need::kIfWritable;
  if (has_to_write && !object.isWritable())
    refuseObject(object.access_at, object, "AccessType", "cannot be written", "rw");
}

void checkLimits(const EdsObject& object, std::int64_t needed) {
  if (!object.isWritable()) return;
  const auto lowest = object.ofEachNode(object.lowest);
  const auto highest = object.ofEachNode(object.highest);
  if (lowest && needed < *lowest)
    refuseObject(object.lowest_at, object, "LowLimit",
                 fmt::format("is above the {} needed", needed), fmt::format("at most {}", needed));
  if (highest && needed > *highest)
    refuseObject(object.highest_at, object, "HighLimit",
                 fmt::format("is below the {} needed", needed), fmt::format("at least {}", needed));
}

/// What is constant has to be what the set-up waits for. Sheets say 0 where they say nothing.
void checkConstant(const EdsObject& object, const SetupStep& step) {
  const bool is_constant = step.kind == StepKind::kExpect && step.entry.index < 0x2000;
  if (!is_constant || !object.initial || object.initial->value == 0) return;
  const auto value = static_cast<std::uint32_t>(object.initial->value) & step.mask;
  if (value != step.value)
    refuseObject(object.initial_at, object, "DefaultValue",
                 fmt::format("{} is another device", value), fmt::format("{}", step.value));
}

void checkStep(const EdsFile& eds, const SetupStep& step) {
  using Need = SetupStep::Need;
  const ObjectEntry& entry = step.entry;
  if (step.need == Need::kIfTaken) return;
  if (step.need != Need::kRequired && !findEdsObject(eds, entry.index, entry.subindex)) return;
  const EdsObject object =
      requireObject(eds, entry.index, entry.subindex,
                    entry.index == 0x605A ? "it, or a profile without quick_stop_option"
                                          : "it, which the set-up needs");
  checkEntryType(object, entry);
  checkAccess(object, step);
  if (step.kind != StepKind::kExpect) checkLimits(object, writtenValue(step));
  checkConstant(object, step);
}

/// Access rw is mapped either way.
EdsObject checkMapped(const EdsFile& eds, const ObjectEntry& entry, bool is_received) {
  const EdsObject object =
      requireObject(eds, entry.index, entry.subindex,
                    is_received ? "it, which RPDO1 carries" : "it, which TPDO1 carries");
  checkEntryType(object, entry);
  if (!object.is_mappable)
    refuseObject(object.mapping_at, object, "PDOMapping",
                 is_received ? "cannot be mapped to RPDO1" : "cannot be mapped to TPDO1", "1");
  const bool is_right = is_received
                            ? object.isWritable() && object.access != EdsAccess::kReadInput
                            : object.isReadable() && object.access != EdsAccess::kWriteOutput;
  if (!is_right)
    refuseObject(object.access_at, object, "AccessType",
                 is_received ? "cannot be received by a PDO" : "cannot be sent by a PDO",
                 is_received ? "rw, rww or wo" : "ro, rw or rwr");
  return object;
}

/// With what each cycle may send, whatever the joint: the commands, and a velocity of 0.
void checkReceived(const EdsFile& eds) {
  const EdsObject control = checkMapped(eds, {0x6040, 0, 2}, true);
  checkLimits(control, control_word::kDisableVoltage);
  checkLimits(control, control_word::kFaultReset);
  checkLimits(checkMapped(eds, {0x60FF, 0, 4}, true), 0);
}

}  // namespace

void checkEds(const EdsFile& eds, const DriveConfig& drive, const BusConfig& bus,
              const CanopenConfig& canopen, double period_s) {
  checkDeviceInfo(eds, bus);
  checkModes(eds);
  checkReceived(eds);
  checkMapped(eds, {0x6041, 0, 2}, false);
  checkMapped(eds, {0x6064, 0, 4}, false);
  for (const SetupStep& step : setupSteps(drive, canopen, period_s)) checkStep(eds, step);
}

}  // namespace tactus
