#include "tactus/scene/json.h"

#include <cmath>
#include <nlohmann/json.hpp>

namespace tactus {

std::string jsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

Json finiteOrNull(double value) { return std::isfinite(value) ? Json(value) : Json(); }

}  // namespace tactus
