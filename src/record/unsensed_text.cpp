#include "tactus/record/unsensed_text.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace tactus {

Json unsensedJson(const UnsensedContact& contact, const Scene& scene) {
  const bool is_any = contact.force_N > 0.0;
  return {{"force_N", contact.force_N},
          {"link", is_any ? Json(scene.capsule_links[contact.capsule]) : Json()},
          {"obstacle", is_any ? Json(contact.obstacle) : Json()},
          {"t_s", is_any ? Json(contact.t_s) : Json()}};
}

std::string unsensedText(const UnsensedContact& contact, const Scene& scene) {
  return fmt::format("{} met obstacle {} with up to {:.3g} N at {:.3g} s: no module feels it",
                     scene.capsule_links[contact.capsule], contact.obstacle, contact.force_N,
                     contact.t_s);
}

}  // namespace tactus
