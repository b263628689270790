#include "tactus/record/log_size.h"

#include <fmt/format.h>

#include "tactus/record/ulog_writer.h"
#include "tactus/scene/yaml_tree.h"

namespace tactus {

void checkLogSize(const Scene& scene) {
  constexpr std::size_t kMinCycles = 1000;
  if (scene.log.max_bytes == 0.0) return;
  const LogDescription description = describeLog(scene);
  const std::size_t smallest = logDefinitions(description).size() + logBytesOfSides(description) +
                               kMinCycles * logBytesACycle(description.shape);
  if (scene.log.max_bytes >= static_cast<double>(smallest)) return;
  failAt(locate(*scene.tree, "log.max_bytes"), "log.max_bytes",
         fmt::format("{} is too small", scene.log.max_bytes),
         fmt::format("expected at least {}, for the scene itself and {} cycles", smallest,
                     kMinCycles));
}

}  // namespace tactus
