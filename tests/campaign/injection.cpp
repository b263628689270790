#include "campaign/injection.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace tactus::campaign {

std::vector<const InjectionKind*> injectionKinds() {
  std::vector<const InjectionKind*> all;
  for (const auto& kinds : {lineKinds(), tactileKinds(), feedbackKinds(), driveKinds(), busKinds()})
    for (const InjectionKind& kind : kinds) all.push_back(&kind);
  return all;
}

const InjectionKind& kindOf(const char* name) {
  for (const InjectionKind* kind : injectionKinds())
    if (std::strcmp(kind->name, name) == 0) return *kind;
  throw std::invalid_argument(name);
}

const InjectionKind& hand() {
  static const InjectionKind& kind = kindOf("hand");
  return kind;
}

const InjectionKind& push() {
  static const InjectionKind& kind = kindOf("pushed");
  return kind;
}

}  // namespace tactus::campaign
