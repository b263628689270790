#include "campaign/stage.h"

#include "campaign/plan.h"
#include "support/shipped_scene.h"

namespace tactus::campaign {

Scene campaignScene(const std::string& variant) {
  // joint_space has keys of its own.
  const bool has_scene = variant == "joint_space" || variant == "null_space";
  Scene scene = has_scene ? test::shippedScene("scenario1_" + variant)
                          : test::shippedScene("scenario1_none", {{"controller.variant", variant}});
  scene.hardware->gpio.emplace();
  scene.hardware->gpio->e_stop.emplace();
  scene.hardware->gpio->enable.emplace();
  scene.hardware->gpio->brake.emplace();
  return scene;
}

namespace {

/// Configured, and not enabled.
VirtualRobotCell readyCell(VirtualRobotCell cell) {
  cell.input.lines.enable = false;
  for (int i = 0; i < 5000 && cell.cycle.report().mode != Mode::kReady; ++i) {
    cell.step();
    cell.cycle.prepare();
  }
  return cell;
}

}  // namespace

Stage bootStage(const std::string& variant) {
  Stage stage{campaignScene(variant), {}, {}};
  const HardwareConfig& hardware = *stage.scene.hardware;
  stage.promise.limits = stage.scene.controller.limits;
  stage.promise.period_s = stage.scene.period_s;
  stage.promise.start_tolerance = hardware.start_tolerance;
  stage.promise.brake_ms = static_cast<int>(1e3 * hardware.gpio->brake_switching_s);
  stage.promise.counts_per_unit.resize(static_cast<int>(hardware.drives.size()));
  for (const DriveConfig& drive : hardware.drives)
    stage.promise.counts_per_unit[drive.joint] = drive.counts_per_unit;

  VirtualRobotCell cell(stage.scene);
  const VirtualRobotCell boot = cell;
  stage.promise.quick_stop = stage.promise.counts_per_unit;
  for (int i = 0; i < stage.promise.quick_stop.size(); ++i)
    stage.promise.quick_stop[i] =
        cell.plant.drive(i).objects().get(0x6085) / stage.promise.counts_per_unit[i];
  const auto steps = [&cell](int cycles) {
    for (int i = 0; i < cycles; ++i) {
      cell.step();
      cell.cycle.prepare();
    }
  };
  for (int i = 0; i < 5000 && !cell.cycle.lines().release_brake; ++i) steps(1);
  stage.moments.push_back(cell);
  for (int i = 0; i < 5000 && cell.cycle.report().mode != Mode::kRunning; ++i) steps(1);
  steps(2000);
  stage.moments.push_back(cell);
  for (int i = 0; i < 8000 && cell.record().force_sensor_N[0] < 1.2; ++i) steps(1);
  stage.moments.push_back(cell);
  steps(2500);
  stage.moments.push_back(cell);
  stage.moments.push_back(boot);
  stage.moments.push_back(readyCell(boot));
  return stage;
}

}  // namespace tactus::campaign
