#include "tactus/daemon/number_within.h"

#include <fmt/format.h>

namespace tactus {

CLI::Validator numberWithin(double least, double most) {
  const std::string range = fmt::format("in [{} - {}]", least, most);
  return {[=](std::string& word) {
            double value = 0.0;
            const bool is_within =
                CLI::detail::lexical_cast(word, value) && value >= least && value <= most;
            return is_within ? std::string()
                             : fmt::format("Value {} not {}, expected a number there", word, range);
          },
          "FLOAT " + range};
}

}  // namespace tactus
