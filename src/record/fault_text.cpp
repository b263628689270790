#include "tactus/record/fault_text.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "tactus/canopen/moteus_faults.h"
#include "tactus/canopen/sdo_abort.h"

namespace tactus {
namespace {

/// Whether `drive` of the report tells of this fault.
bool isOfDrive(Fault fault) {
  return fault >= Fault::kDriveSilent && fault <= Fault::kDriveSetupRefused;
}

/// As the drive's manual has it.
std::string describeCode(const DriveConfig& drive, int code) {
  if (drive.kind != DriveKind::kMoteus) return fmt::format(", emergency code 0x{:04X}", code);
  const char* const name = moteusFaultName(code);
  return fmt::format(", fault code {}", code) + (name ? fmt::format(" ({})", name) : "");
}

std::string describeDrive(const FaultReport& report, const Scene& scene) {
  const DriveConfig& drive = scene.hardware->drives[report.joint];
  std::string text =
      fmt::format("drive {} on {} (joint {})", drive.node_id,
                  scene.hardware->buses[drive.bus].interface, scene.joint_names[report.joint]);
  if (report.drive.emergency_code != 0)
    text += describeCode(drive, report.drive.emergency_code);
  else if (report.fault == Fault::kDriveFault && drive.kind == DriveKind::kMoteus &&
           report.drive.state != DriveState::kFault)
    text += ", its position or velocity is NaN";
  if (report.fault == Fault::kDriveSetupRefused) text += ", " + refusalText(drive, report.drive);
  return text + fmt::format(", {}", driveStateName(report.drive.state));
}

std::string describePlace(const FaultReport& report, const Scene& scene) {
  const char* const unit = unitOf(scene.controller.chain.type(report.joint));
  return fmt::format("joint {} is at {:.6g} {}, expected within {:g} of {:.6g}",
                     scene.joint_names[report.joint], report.q_measured, unit,
                     scene.hardware->start_tolerance, report.q_expected);
}

std::string describeCulprit(const FaultReport& report, const Scene& scene) {
  if (report.joint >= 0 && report.fault == Fault::kNotAtStart)
    return ", " + describePlace(report, scene);
  if (report.joint >= 0 && isOfDrive(report.fault)) return ", " + describeDrive(report, scene);
  if (report.joint >= 0) return ", joint " + scene.joint_names[report.joint];
  if (report.detail.module >= 0 && scene.module_links.size() > 1)
    return ", tactile module " + scene.module_links[report.detail.module];
  if (report.bus >= 0) return ", " + scene.hardware->buses[report.bus].interface;
  return "";
}

std::string describeValue(const FaultReport& report) {
  const FaultDetail& detail = report.detail;
  const bool is_said = report.fault == Fault::kNotAtStart || report.fault == Fault::kDriveFault;
  if (is_said || *detail.unit == '\0') return "";  // with the place
  const std::string text = fmt::format(", {:.6g} {}", detail.value, detail.unit);
  if (std::isnan(detail.limit)) return text;
  const bool is_long = report.fault == Fault::kDriveSilent;  // "cycles without feedback"
  return text + fmt::format(", at most {:.6g}", detail.limit) +
         (is_long ? "" : fmt::format(" {}", detail.unit));
}

/// Drives that hear nothing for a while stop by themselves, and each by another name. Of an overrun
/// the value says it.
std::string describePause(const FaultReport& report) {
  const int missed = report.missed_cycles;
  if (missed == 0 || report.fault == Fault::kOverrun) return "";
  return fmt::format(", after {} missed cycle{}", missed, missed == 1 ? "" : "s");
}

/// Of a drive's fault that of the drive.
Json busName(const FaultReport& report, const Scene& scene) {
  int bus = report.bus;
  if (report.joint >= 0 && isOfDrive(report.fault)) bus = scene.hardware->drives[report.joint].bus;
  return bus < 0 ? Json() : Json(scene.hardware->buses[bus].interface);
}

}  // namespace

std::string refusalText(const DriveConfig& drive, const DriveReport& report) {
  const SetupFailure& failure = report.setup_failure;
  const bool is_moteus = drive.kind == DriveKind::kMoteus;
  std::string text = is_moteus
                         ? fmt::format("register 0x{:03X}: ", failure.index)
                         : fmt::format("object {:04X}:{:02X}: ", failure.index, failure.subindex);
  if (failure.is_other_value)
    return text + fmt::format("is {:#x}, expected {:#x}", failure.value, failure.expected);
  if (failure.abort_code != 0) return text + sdoAbortName(failure.abort_code);
  return text + (is_moteus && report.has_state ? "is NaN" : "no answer");
}

std::string faultEvent(const FaultReport& report, const Scene& scene) {
  std::string text = faultName(report.fault) + describeCulprit(report, scene);
  if (std::isfinite(report.time_s)) text += fmt::format(", at {:.9g} s", report.time_s);
  return text + describeValue(report) + describePause(report);
}

std::string describeFault(const FaultReport& report, const Scene& scene) {
  const FaultRow& row = faultRow(report.fault);
  return fmt::format("{}: {}; reaction: {}", faultEvent(report, scene), row.detection,
                     reactionName(row.reaction));
}

std::string describeMode(const ModeReport& report, const Scene& scene) {
  const std::string mode = modeName(report.mode);
  return report.fault == Fault::kNone ? mode : mode + ": " + describeFault(report, scene);
}

std::string wayOnText(const WayOn& way_on, Fault fault) {
  const std::string place =
      fault == Fault::kNotAtStart ? "the arm to be back where it is expected, and " : "";
  switch (way_on.waits_for) {
    case WaitsFor::kFaultGone:
      if (way_on.fault == Fault::kForbiddenSystemCall) return "a new start of the daemon";
      return fmt::format("{} to be gone", faultName(way_on.fault));
    case WaitsFor::kDrivesOff:
      return "the drives to be off; an enable line that is switched before counts for nothing";
    case WaitsFor::kEnableOff:
      return place + "the enable line to be switched off, then on";
    case WaitsFor::kEnableOn:
      return place + "the enable line to be switched on";
    case WaitsFor::kNothing:
      break;
  }
  return "";
}

Json faultJson(const FaultReport& report, const Scene& scene) {
  if (report.fault == Fault::kNone) return nullptr;
  const std::string unit = report.detail.unit;
  const int module = report.detail.module;
  return {{"name", faultName(report.fault)},
          {"time_s", report.time_s},
          {"joint", report.joint < 0 ? Json() : Json(scene.joint_names[report.joint])},
          {"bus", busName(report, scene)},
          {"tactile_module", module < 0 ? Json() : Json(scene.module_links[module])},
          {"value", report.detail.value},
          {"limit", report.detail.limit},
          {"unit", unit.empty() ? Json() : Json(unit)},
          {"missed_cycles", report.missed_cycles},
          {"description", describeFault(report, scene)}};
}

}  // namespace tactus
