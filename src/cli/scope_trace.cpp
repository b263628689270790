#include "tactus/cli/scope_trace.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "tactus/record/contact_json.h"
#include "tactus/record/contact_list.h"
#include "tactus/scene/stability_check.h"

namespace tactus {
namespace {

constexpr double kLeastSpeed_m_per_s = 1e-4;
constexpr double kSlowTouch_s = 10.0;  ///< until a soft contact passes F_th

/// The module that feels most from the trigger on.
int loudestModule(const Capture& capture, int modules) {
  int loudest = 0;
  double most_N = -kNoLimit;
  for (const CycleRecord& record : capture.records) {
    const double from_s = capture.is_triggered ? capture.trigger_s : capture.from_s;
    if (record.t_s < from_s) continue;
    for (int i = 0; i < modules; ++i) {
      if (!(record.force_sensor_N[i] > most_N)) continue;
      most_N = record.force_sensor_N[i];
      loudest = i;
    }
  }
  return loudest;
}

bool isFelt(const CycleRecord& record, int module) {
  return record.force_sensor_N[module] > record.gains.force.contact_threshold_N;
}

/// The first cycle that is shown in which F_sen passes F_th on its way up; null: it does not.
const CycleRecord* feltCycle(const Capture& capture, int module) {
  for (std::size_t i = 1; i < capture.records.size(); ++i)
    if (capture.records[i].t_s >= capture.from_s && isFelt(capture.records[i], module) &&
        !isFelt(capture.records[i - 1], module))
      return &capture.records[i];
  return nullptr;
}

/// Why there is no feltCycle().
const char* whyNotFelt(const Capture& capture, int module) {
  const auto first = std::ranges::find_if(
      capture.records, [&](const CycleRecord& record) { return record.t_s >= capture.from_s; });
  const bool was_felt = first != capture.records.end() && isFelt(*first, module);
  return was_felt ? "F_sen was above F_th before what is shown (--pre)"
                  : "F_sen does not pass F_th";
}

const CycleRecord& triggerCycle(const Capture& capture) {
  const auto found = std::ranges::find_if(
      capture.records, [&](const CycleRecord& record) { return record.t_s >= capture.trigger_s; });
  return found == capture.records.end() ? capture.records.back() : *found;
}

/// Behind the contact's end the way says nothing of it any more.
TouchFit fitOf(const Scene& scene, const Capture& capture, int module, double felt_s) {
  std::deque<TouchSample> samples;
  ContactList contact = contactList(scene.controller, 0, module);
  for (const CycleRecord& record : capture.records) {
    samples.push_back(touchSample(record, module));
    if (record.t_s >= felt_s && contact.add(record)) break;
  }
  return fitTouch(scene.controller, module, samples, felt_s);
}

/// Moved so that it passes F_th where F_sen does, felt_s after the trigger.
ScopeCurve aligned(const std::vector<PredictedForce>& forces, double threshold_N, double felt_s,
                   double from_s, double to_s) {
  ScopeCurve curve;
  const auto felt = std::ranges::find_if(
      forces, [threshold_N](const PredictedForce& force) { return force.force_N > threshold_N; });
  if (felt == forces.end()) return curve;
  for (const PredictedForce& force : forces) {
    const double t_s = force.t_s - felt->t_s + felt_s;
    if (t_s < from_s || t_s > to_s) continue;
    curve.t_s.push_back(t_s);
    curve.value.push_back(force.force_N);
  }
  return curve;
}

void predict(const Scene& scene, const Capture& capture, int module, const CycleRecord* felt,
             ScopeTrace& trace) {
  const std::optional<PredictedTouch> known =
      predictedTouch(scene.controller, scene.plant, scene.period_s, module,
                     felt ? felt->gains : scene.controller.gains);
  if (!known) {
    trace.why_not_predicted = "the scene's law or its rates have no such loop";
  } else if (!felt) {
    trace.why_not_predicted = whyNotFelt(capture, module);
  } else if (!trace.touch.is_known) {
    trace.why_not_predicted = "force and way do not tell c_e";
  } else if (trace.touch.speed_m_per_s < kLeastSpeed_m_per_s) {
    trace.why_not_predicted = "the contact point did not approach";
  }
  if (!trace.why_not_predicted.empty()) return;
  PredictedTouch touch = *known;
  touch.stiffness_N_per_m = trace.touch.stiffness_N_per_m;
  touch.law_stiffness_N_per_m = trace.law_stiffness_N_per_m;
  touch.speed_m_per_s = trace.touch.speed_m_per_s;
  const double to_s = trace.force.t_s.back();
  const std::vector<PredictedForce> forces = predictForce(touch, to_s + kSlowTouch_s);
  trace.predicted = aligned(forces, touch.gains.force.contact_threshold_N,
                            felt->t_s - trace.trigger_s, trace.force.t_s.front(), to_s);
  if (trace.predicted.t_s.empty()) trace.why_not_predicted = "the loop alone does not come to F_th";
}

double restForce_N(const Scene& scene, const ForceGains& gains) {
  if (!scene.controller.force_control) return std::numeric_limits<double>::quiet_NaN();
  const bool is_above = hasActivationForce(scene.controller.force_control->variant);
  return gains.contact_threshold_N + (is_above ? gains.activation_force_N : 0.0);
}

Json curveJson(const ScopeCurve& curve, const char* name) {
  return {{"t_s", curve.t_s}, {name, curve.value}};
}

}  // namespace

ScopeTrace scopeTrace(const Scene& scene, const TriggerCondition& condition,
                      const Capture& capture) {
  const int modules = std::max(1, static_cast<int>(scene.controller.tactile_modules.size()));
  const int module = loudestModule(capture, modules);
  const CycleRecord& trigger = triggerCycle(capture);
  const CycleRecord* const felt =
      scene.controller.tactile_modules.empty() ? nullptr : feltCycle(capture, module);
  ScopeTrace trace;
  trace.trigger_s = capture.trigger_s;
  trace.is_triggered = capture.is_triggered;
  trace.link = linkOfModule(scene.module_links, module);
  trace.variant = scene.variant;
  trace.gains = trigger.gains.force;
  trace.law_stiffness_N_per_m = (felt ? *felt : trigger).stiffness_N_per_m;
  trace.rest_N = restForce_N(scene, trace.gains);
  for (const CycleRecord& record : capture.records) {
    if (record.t_s < capture.from_s) continue;
    const double t_s = record.t_s - capture.trigger_s;
    trace.force.t_s.push_back(t_s);
    trace.force.value.push_back(record.force_sensor_N[module]);
    trace.signal.t_s.push_back(t_s);
    trace.signal.value.push_back(signalOf(condition, record));
    trace.peak_N = std::max(trace.peak_N, record.force_sensor_N[module]);
  }
  if (felt) trace.touch = fitOf(scene, capture, module, felt->t_s);
  predict(scene, capture, module, felt, trace);
  return trace;
}

std::string gainsText(const ScopeTrace& trace) {
  return fmt::format("T {:g} s, d {:g}, F_act {:g} N, F_th {:g} N, c {:.0f} N/m",
                     trace.gains.time_constant_s, trace.gains.damping,
                     trace.gains.activation_force_N, trace.gains.contact_threshold_N,
                     trace.law_stiffness_N_per_m);
}

std::string touchText(const ScopeTrace& trace) {
  const TouchFit& touch = trace.touch;
  if (!touch.is_known) return "c_e not known";
  return fmt::format("c_e {:.0f} ({:.0f}..{:.0f}) N/m met with {:.2g} m/s", touch.stiffness_N_per_m,
                     touch.low_N_per_m, touch.high_N_per_m, touch.speed_m_per_s);
}

std::string restText(const ScopeTrace& trace) {
  if (std::isnan(trace.rest_N)) return "Without force control it shall rest nowhere.";
  return fmt::format("Dashed: {:g} N, where it shall rest, and 5 % to each side.", trace.rest_N);
}

Json scopeJson(const ScopeTrace& trace) {
  const TouchFit& touch = trace.touch;
  Json json = {{"trigger_s", trace.trigger_s},
               {"is_triggered", trace.is_triggered},
               {"tactile_module", trace.link},
               {"variant", trace.variant},
               {"time_constant_s", trace.gains.time_constant_s},
               {"damping", trace.gains.damping},
               {"activation_force_N", trace.gains.activation_force_N},
               {"contact_threshold_N", trace.gains.contact_threshold_N},
               {"stiffness_N_per_m", trace.law_stiffness_N_per_m},
               {"contact_stiffness_N_per_m", nullptr},
               {"speed_m_per_s", nullptr},
               {"rest_target_N", finiteOrNull(trace.rest_N)},
               {"peak_force_N", trace.peak_N},
               {"force", curveJson(trace.force, "force_N")},
               {"signal", curveJson(trace.signal, "value")},
               {"predicted", nullptr},
               {"why_not_predicted", trace.why_not_predicted}};
  if (touch.is_known) {
    json["contact_stiffness_N_per_m"] = {{"value", touch.stiffness_N_per_m},
                                         {"low", touch.low_N_per_m},
                                         {"high", touch.high_N_per_m}};
    json["speed_m_per_s"] = touch.speed_m_per_s;
  }
  if (!trace.predicted.t_s.empty()) json["predicted"] = curveJson(trace.predicted, "force_N");
  return json;
}

ScopeCurve thinned(const ScopeCurve& curve, std::size_t most) {
  const std::size_t count = curve.t_s.size();
  if (count <= most) return curve;
  const std::size_t stretch = 2 * ((count + most - 1) / most);
  ScopeCurve thin;
  for (std::size_t from = 0; from < count; from += stretch) {
    const auto begin = curve.value.begin() + static_cast<std::ptrdiff_t>(from);
    const auto end =
        curve.value.begin() + static_cast<std::ptrdiff_t>(std::min(from + stretch, count));
    const auto [low, high] = std::minmax_element(begin, end);
    for (const auto& extreme : {std::min(low, high), std::max(low, high)}) {
      const auto i = static_cast<std::size_t>(extreme - curve.value.begin());
      if (!thin.t_s.empty() && thin.t_s.back() == curve.t_s[i]) continue;
      thin.t_s.push_back(curve.t_s[i]);
      thin.value.push_back(curve.value[i]);
    }
  }
  return thin;
}

}  // namespace tactus
