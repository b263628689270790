#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>

#include "tactus/scene/hardware_checks.h"
#include "tactus/scene/key_words.h"

namespace tactus {
namespace {

using TroubleKind = Trouble::Kind;

/// One trouble while it is checked.
struct Loading {
  const YamlNode& root;
  const HardwareConfig& hardware;
  const TroubleSection& given;
  std::string path;

  [[noreturn]] void fail(const char* key, const std::string& problem,
                         const std::string& expectation) const {
    const std::string full = path + "." + key;
    failAt(locate(root, full), full, problem, "expected " + expectation);
  }
  template <class T>
  void refuse(const std::optional<T>& value, const char* key) const {
    if (!value) return;
    fail(key, "says nothing with " + wordOf(kTroubleWords, given.trouble.kind), "no such key");
  }
};

/// Of one drive, or of all drives of a bus.
bool isOfDrive(TroubleKind kind) {
  constexpr std::array kKinds = {TroubleKind::kDriveFault,     TroubleKind::kIgnoreCommands,
                                 TroubleKind::kFreezeFeedback, TroubleKind::kNonsenseStatus,
                                 TroubleKind::kBootUp,         TroubleKind::kHeartbeatOnly};
  return std::ranges::count(kKinds, kind) > 0;
}

bool hasId(TroubleKind kind) {
  constexpr std::array kKinds = {TroubleKind::kDrop, TroubleKind::kDelay, TroubleKind::kCorrupt,
                                 TroubleKind::kDuplicate};
  return isOfDrive(kind) || std::ranges::count(kKinds, kind) > 0;
}

int findBus(const Loading& l) {
  std::vector<std::string> names;
  for (const BusConfig& bus : l.hardware.buses) names.push_back(bus.interface);
  const std::string expectation = fmt::format("one of {}", fmt::join(names, ", "));
  if (!l.given.interface) l.fail("interface", "is missing", expectation);
  const auto name = std::ranges::find(names, *l.given.interface);
  if (name == names.end()) {
    l.fail("interface", inQuotes(*l.given.interface) + " is no bus of this scene", expectation);
  }
  return static_cast<int>(name - names.begin());
}

void checkNodeId(const Loading& l, const Trouble& trouble) {
  const auto is_it = [&](const DriveConfig& drive) {
    return drive.bus == trouble.bus && drive.node_id == static_cast<int>(trouble.id);
  };
  if (trouble.id == 0 || std::ranges::any_of(l.hardware.drives, is_it)) return;
  l.fail("id", fmt::format("{} is no drive of {}", trouble.id, inQuotes(*l.given.interface)),
         "the node id of a drive, or 0 for all");
}

/// A moteus sends no boot-up message, and has one watchdog alone.
void checkDriveKind(const Loading& l, const Trouble& trouble) {
  if (trouble.kind != TroubleKind::kBootUp && trouble.kind != TroubleKind::kHeartbeatOnly) return;
  bool has_moteus = false;
  for (const DriveConfig& drive : l.hardware.drives) {
    const bool is_meant = trouble.id == 0 || drive.node_id == static_cast<int>(trouble.id);
    if (drive.bus != trouble.bus || !is_meant) continue;
    if (drive.kind != DriveKind::kMoteus) return;
    has_moteus = true;
  }
  if (!has_moteus) return;
  l.fail("kind", wordOf(kTroubleWords, trouble.kind) + " says nothing to a moteus",
         "another trouble, or another drive");
}

Trouble loadTrouble(const Loading& l) {
  Trouble trouble = l.given.trouble;
  trouble.id = l.given.id.value_or(trouble.id);
  trouble.delay_s = l.given.delay_s.value_or(trouble.delay_s);
  if (trouble.until_s <= trouble.from_s) {
    l.fail("until_s", fmt::format("{} s is too early", trouble.until_s),
           fmt::format("more than from_s = {}", trouble.from_s));
  }
  if (!hasId(trouble.kind)) l.refuse(l.given.id, "id");
  if (trouble.kind != TroubleKind::kDelay) {
    l.refuse(l.given.delay_s, "delay_s");
  } else if (!l.given.delay_s) {
    l.fail("delay_s", "is missing", "a number > 0 in s with delay");
  }
  if (trouble.kind == TroubleKind::kEmergencyStop) {
    l.refuse(l.given.interface, "interface");
    if (!l.hardware.gpio || !l.hardware.gpio->e_stop) {
      l.fail("kind", "the robot has no gpio.e_stop", "another trouble, or such a robot");
    }
    return trouble;
  }
  trouble.bus = findBus(l);
  if (isOfDrive(trouble.kind)) checkNodeId(l, trouble);
  checkDriveKind(l, trouble);
  return trouble;
}

}  // namespace

std::vector<Trouble> loadTroubles(const YamlNode& root, const std::vector<TroubleSection>& given,
                                  const std::optional<HardwareConfig>& hardware) {
  const std::string section = "simulation.troubles";
  if (!given.empty() && !hardware) {
    failAt(locate(root, section), section, "the robot has no can section",
           "expected no troubles, or such a robot");
  }
  std::vector<Trouble> troubles;
  for (std::size_t i = 0; i < given.size(); ++i) {
    troubles.push_back(loadTrouble({root, *hardware, given[i], fmt::format("{}[{}]", section, i)}));
  }
  return troubles;
}

}  // namespace tactus
