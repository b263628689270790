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

Promise promiseOf(const Scene& scene, const VirtualRobotCell& cell) {
  Promise promise;
  const HardwareConfig& hardware = *scene.hardware;
  promise.limits = scene.controller.limits;
  promise.period_s = scene.period_s;
  promise.start_tolerance = hardware.start_tolerance;
  promise.brake_ms = static_cast<int>(1e3 * hardware.gpio->brake_switching_s);
  promise.counts_per_unit.resize(static_cast<int>(hardware.drives.size()));
  for (const DriveConfig& drive : hardware.drives)
    promise.counts_per_unit[drive.joint] = drive.counts_per_unit;
  promise.quick_stop = promise.counts_per_unit;
  for (int i = 0; i < promise.quick_stop.size(); ++i)
    promise.quick_stop[i] = cell.plant.drive(i).objects().get(0x6085) / promise.counts_per_unit[i];
  return promise;
}

Stage bootStage(const std::string& variant) {
  Stage stage{campaignScene(variant), {}, {}};
  VirtualRobotCell cell(stage.scene);
  const VirtualRobotCell boot = cell;
  stage.promise = promiseOf(stage.scene, cell);
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
