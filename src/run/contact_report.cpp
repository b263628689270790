#include "tactus/run/contact_report.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "tactus/scene/located_error.h"

namespace tactus {
namespace {

std::string pointText(const Vector3& p) {
  return fmt::format("({:.4f}, {:.4f}, {:.4f})", p.x(), p.y(), p.z());
}

Json pointJson(const Vector3& p) { return {p.x(), p.y(), p.z()}; }

std::string touchText(const Scene& scene, const TouchReport& report) {
  const bool is_named = scene.module_links.size() > 1;
  std::string text =
      fmt::format("obstacle {}{} at {:.3g} s with {:.3g} m/s: about {:.3g} N", report.obstacle,
                  is_named ? " on " + scene.module_links[report.touch.module] : "",
                  report.touch.t_s, report.touch.speed_m_per_s, report.peak_N);
  if (!report.softer) return text;
  text += fmt::format("; for {:.3g} N: {:.2g} m/s", report.softer->force_N,
                      report.softer->speed_m_per_s);
  if (!report.softer->cutoff_hz) return text;
  return text + fmt::format(", or a filter of {:.2g} Hz", *report.softer->cutoff_hz);
}

std::string peakText(const Scene& scene, const PeakReport& peak) {
  const bool is_named = scene.module_links.size() > 1;
  const std::string whose =
      is_named ? "the most for the sensor of " + scene.module_links[peak.fastest.module]
               : "the fastest of the covers";
  std::string text =
      fmt::format("{:g} N/m met with {:.3g} m/s, {}: about {:.3g} N", peak.stiffness_N_per_m,
                  peak.fastest.speed_m_per_s, whose, peak.peak_N());
  text += fmt::format(" ({:.3g} N by a delay of {:.3g} ms", peak.delay_peak_N, 1e3 * peak.delay_s);
  if (peak.blow_peak_N)
    text += fmt::format(", {:.3g} N by a mass of {:.3g} kg", *peak.blow_peak_N, *peak.mass_kg);
  return text + fmt::format("); sensor up to {:.4g} N; up to {:.4g} N: {:.2g} m/s", peak.sensor_N,
                            peak.target_N, peak.target_speed_m_per_s);
}

std::string movingText(const MovingObstacle& moving) {
  return fmt::format("obstacles that come or go by {:.2g} mm/s rest at {:.3g} N where m = {:g} N/m",
                     1e3 * moving.speed_m_per_s, moving.force_N, moving.stiffness_N_per_m);
}

Json touchJson(const Scene& scene, const TouchReport& report) {
  Json json = {{"obstacle", report.obstacle},
               {"tactile_module", scene.module_links[report.touch.module]},
               {"t_s", report.touch.t_s},
               {"speed_m_per_s", report.touch.speed_m_per_s},
               {"peak_force_N", report.peak_N}};
  if (!report.softer) return json;
  json["softer"] = {{"force_N", report.softer->force_N},
                    {"speed_m_per_s", report.softer->speed_m_per_s}};
  if (report.softer->cutoff_hz) json["softer"]["filter_cutoff_hz"] = *report.softer->cutoff_hz;
  return json;
}

Json peakJson(const Scene& scene, const PeakReport& peak) {
  const TactileModuleConfig& module = scene.controller.tactile_modules[peak.fastest.module];
  Json json = {{"tactile_module", scene.module_links[peak.fastest.module]},
               {"stiffness_N_per_m", peak.stiffness_N_per_m},
               {"speed_m_per_s", peak.fastest.speed_m_per_s},
               {"delay_s", peak.delay_s},
               {"delay_peak_N", peak.delay_peak_N},
               {"peak_force_N", peak.peak_N()},
               {"max_force_N", module.max_force_N},
               {"sensor_N", peak.sensor_N},
               {"target_force_N", peak.target_N},
               {"target_speed_m_per_s", peak.target_speed_m_per_s}};
  if (!peak.blow_peak_N) return json;
  json["effective_mass_kg"] = *peak.mass_kg;
  json["blow_peak_N"] = *peak.blow_peak_N;
  return json;
}

}  // namespace

std::string textLine(const std::string& name, const std::string& value) {
  return fmt::format("{:<9}{}\n", name, escaped(value));
}

std::string coversText(const std::vector<CoverReport>& covers) {
  std::string text;
  for (const CoverReport& cover : covers) {
    text += textLine(
        "cover", fmt::format("{} from {} to {} m", cover.link, pointText(cover.ends.p_BaseStart),
                             pointText(cover.ends.p_BaseEnd)));
  }
  return text;
}

std::string contactText(const Scene& scene, const ExpectedContact& report) {
  std::string text;
  for (const TouchReport& touch : report.touches)
    text += textLine("touch", touchText(scene, touch));
  if (report.peak) text += textLine("peak", peakText(scene, *report.peak));
  if (report.moving) text += textLine("moving", movingText(*report.moving));
  return text;
}

Json coversJson(const std::vector<CoverReport>& covers) {
  Json json = Json::array();
  for (const CoverReport& cover : covers) {
    json.push_back({{"link", cover.link},
                    {"start_m", pointJson(cover.ends.p_BaseStart)},
                    {"end_m", pointJson(cover.ends.p_BaseEnd)}});
  }
  return json;
}

void addContact(const Scene& scene, const ExpectedContact& report, Json& json) {
  Json touches = Json::array();
  for (const TouchReport& touch : report.touches) touches.push_back(touchJson(scene, touch));
  json["touches"] = touches;
  if (report.peak) json["expected_peak"] = peakJson(scene, *report.peak);
  if (report.moving) {
    json["moving_obstacle"] = {{"stiffness_N_per_m", report.moving->stiffness_N_per_m},
                               {"speed_m_per_s", report.moving->speed_m_per_s},
                               {"rest_force_N", report.moving->force_N}};
  }
}

}  // namespace tactus
