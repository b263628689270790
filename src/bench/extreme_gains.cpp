#include <fmt/format.h>

#include "tactus/bench/extreme_case.h"

/// Gains and limits that nobody should choose.
namespace tactus {
namespace {

void addOne(std::vector<ExtremeCase>& cases, const std::string& key, const std::string& value) {
  cases.push_back({"gains",
                   fmt::format("{} = {}", key, value),
                   {obstaclesAre({bandText(60.0), profileText(17000.0)}), {key, value}}});
}

/// The drives hardly can do what the law asks for.
void addWeakDrives(std::vector<ExtremeCase>& cases) {
  for (const double acceleration : {0.5, 5.0, 50.0}) {
    for (const double stiffness : {60.0, 17000.0}) {
      cases.push_back({"weak drives",
                       fmt::format("{:g} rad/s^2 or m/s^2, {:g} N/m", acceleration, stiffness),
                       {obstaclesAre({profileText(stiffness)})},
                       [=](Scene& scene) {
                         scene.controller.limits.max_acceleration.setConstant(acceleration);
                       }});
    }
  }
  for (const double speed : {0.01, 0.1}) {
    cases.push_back(
        {"weak drives",
         fmt::format("{:g} rad/s or m/s, 17000 N/m", speed),
         {obstaclesAre({profileText(17000.0)})},
         [=](Scene& scene) { scene.controller.limits.max_velocity.setConstant(speed); }});
  }
  for (const double lag_s : {0.0, 0.02, 0.1}) {
    cases.push_back({"weak drives",
                     fmt::format("lag of {:g} ms, 17000 N/m", 1e3 * lag_s),
                     {obstaclesAre({profileText(17000.0)})},
                     [=](Scene& scene) { scene.plant.drive_lag_s = lag_s; }});
  }
}

}  // namespace

void addGainCases(std::vector<ExtremeCase>& cases) {
  for (const char* value : {"0.001", "0.01", "0.05", "1", "100"})
    addOne(cases, "controller.time_constant_s", value);
  for (const char* value : {"0.01", "0.1", "3", "10"}) addOne(cases, "controller.damping", value);
  addOne(cases, "controller.order", "1");
  for (const char* value : {"1e-3", "10", "300", "1e6", "1e9"})
    addOne(cases, "stiffness.assumed_N_per_m", value);
  for (const char* value : {"0", "100", "1000", "1001"})
    addOne(cases, "task.drift_gain_per_s", value);
  for (const char* value : {"1e-6", "1000"})
    addOne(cases, "controller.max_null_speed_rad_per_s", value);
  for (const char* value : {"1e-9", "100"}) addOne(cases, "controller.activation_force_N", value);
  for (const char* value : {"0", "20"}) addOne(cases, "controller.contact_threshold_N", value);
  for (const char* value : {"1e-9", "10"}) addOne(cases, "controller.transition.distance_m", value);
  for (const char* value : {"1e-9", "100"})
    addOne(cases, "controller.transition.max_time_constant_s", value);
  for (const char* value : {"0", "50"})
    addOne(cases, "redundancy.joint_limit_avoidance.gain", value);
  addWeakDrives(cases);
}

}  // namespace tactus
