#include "tactus/scene/json.h"

#include <nlohmann/json.hpp>

namespace tactus {

std::string jsonText(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace tactus
