#include "tactus/daemon/request_refusal.h"

#include <fmt/format.h>

#include "tactus/scene/located_error.h"

namespace tactus {

void refuseRequest(const std::string& problem, const std::string& expectation) {
  throw InputError(fmt::format("request: {}, expected {}", problem, expectation));
}

}  // namespace tactus
