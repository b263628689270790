#include "tactus/daemon/request_refusal.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tactus/scene/located_error.h"

namespace tactus {

void refuseRequest(const std::string& problem, const std::string& expectation) {
  throw InputError(fmt::format("request: {}, expected {}", problem, expectation));
}

void refuseUnknown(const Json& request, std::initializer_list<const char*> known) {
  for (const auto& [name, value] : request.items()) {
    if (std::ranges::find(known, name) == known.end())
      refuseRequest(fmt::format("{} is not known here", inQuotes(name)),
                    fmt::format("{}", fmt::join(known, ", ")));
  }
}

bool flagOf(const Json& request, const char* name) {
  const Json value = request.value(name, Json(false));
  if (!value.is_boolean())
    refuseRequest(fmt::format("{} is {}", name, value.dump()), "true or false");
  return value.get<bool>();
}

}  // namespace tactus
