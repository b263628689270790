#include "tactus/record/contact_json.h"

#include <nlohmann/json.hpp>

namespace tactus {

std::string linkOfModule(const std::vector<std::string>& links, int module) {
  const auto index = static_cast<std::size_t>(module);
  return index < links.size() ? links[index] : "-";
}

Json contactJson(const ContactFigures& contact, const std::vector<std::string>& links) {
  const ForceGains& gains = contact.gains.force;
  Json json = {{"start_s", contact.start_s},
               {"end_s", contact.end_s},
               {"peak_force_N", contact.peak_force_N},
               {"settling_s", contact.settling_s},
               {"tactile_module", linkOfModule(links, contact.module)},
               {"position_m", contact.position_m},
               {"time_above_s", contact.time_above_s},
               {"rest_force_N", finiteOrNull(contact.rest_force_N)},
               {"swing_N", finiteOrNull(contact.swing_N)},
               {"swing_hz", contact.swing_hz},
               {"stiffness_N_per_m", finiteOrNull(contact.stiffness_N_per_m)},
               {"contact_stiffness_N_per_m", nullptr},
               {"tcp_error_max_m", contact.tcp_error_max_m},
               {"null_space_share", contact.null_share},
               {"task_space_share", finiteOrNull(contact.task_share)},
               {"time_constant_s", gains.time_constant_s},
               {"damping", gains.damping},
               {"activation_force_N", gains.activation_force_N},
               {"contact_threshold_N", gains.contact_threshold_N}};
  const TouchFit& touch = contact.touch;
  if (!touch.is_known) return json;
  json["contact_stiffness_N_per_m"] = {
      {"value", touch.stiffness_N_per_m}, {"low", touch.low_N_per_m}, {"high", touch.high_N_per_m}};
  return json;
}

}  // namespace tactus
