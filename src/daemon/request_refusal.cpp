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

std::string wishOf(const Json& request) {
  const auto found = request.find("do");
  return found != request.end() && found->is_string() ? found->get<std::string>() : "";
}

bool flagOf(const Json& request, const char* name) {
  const Json value = request.value(name, Json(false));
  if (!value.is_boolean())
    refuseRequest(fmt::format("{} is {}", name, value.dump()), "true or false");
  return value.get<bool>();
}

double numberOf(const Json& value, const std::string& name, double least, double most) {
  if (!value.is_number()) refuseRequest(name + " is no number", "one");
  const double number = value.get<double>();
  if (number >= least && number <= most) return number;
  refuseRequest(fmt::format("{} is {}", name, value.dump()),
                fmt::format("{:g} to {:g}", least, most));
}

std::optional<std::array<std::optional<double>, 3>> vectorOf(const Json& request, const char* name,
                                                             double most) {
  const auto found = request.find(name);
  if (found == request.end()) return std::nullopt;
  if (!found->is_array() || found->size() != 3)
    refuseRequest(fmt::format("{} is no vector", name), "three numbers");
  std::array<std::optional<double>, 3> vector;
  for (std::size_t i = 0; i < 3; ++i)
    if (!found->at(i).is_null())
      vector[i] = numberOf(found->at(i), fmt::format("{}[{}]", name, i), -most, most);
  return vector;
}

}  // namespace tactus
