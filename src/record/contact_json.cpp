#include "tactus/record/contact_json.h"

#include <nlohmann/json.hpp>

namespace tactus {

Json contactJson(const ContactFigures& contact, const std::string& link) {
  const ContactSummary& summary = contact.summary;
  const ForceGains& gains = contact.gains.force;
  return {{"start_s", summary.start_s},
          {"end_s", summary.end_s},
          {"tactile_module", link},
          {"position_m", contact.position_m},
          {"peak_force_N", summary.peak_force_N},
          {"time_above_s", contact.time_above_s},
          {"settling_s", summary.settling_s},
          {"rest_force_N", contact.rest_force_N},
          {"swing_N", contact.swing_N},
          {"swing_hz", contact.swing_hz},
          {"stiffness_N_per_m", contact.stiffness_N_per_m},
          {"tcp_error_max_m", contact.tcp_error_max_m},
          {"null_space_share", contact.null_share},
          {"time_constant_s", gains.time_constant_s},
          {"damping", gains.damping},
          {"activation_force_N", gains.activation_force_N},
          {"contact_threshold_N", gains.contact_threshold_N}};
}

}  // namespace tactus
