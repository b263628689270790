#include "tactus/scene/capsule_loader.h"

#include <fmt/format.h>

namespace tactus {

std::vector<NamedFrame> capsuleLinks(const YamlNode& root,
                                     const std::vector<CapsuleSection>& capsules) {
  std::vector<NamedFrame> links;
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    const std::string key = fmt::format("collision_capsules[{}].link", i);
    links.push_back({capsules[i].link, key, locate(root, key)});
  }
  return links;
}

NamedCapsules loadCapsules(const LoadedRobot& robot, bool modules_are_read) {
  NamedCapsules named;
  const std::vector<CapsuleSection>& sections = robot.config.collision_capsules;
  for (std::size_t i = 0; i < sections.size(); ++i) {
    const CapsuleSection& section = sections[i];
    named.capsules.push_back(
        {robot.chain.capsule_links[i], section.from_m, section.to_m, section.radius_m});
    named.links.push_back(section.link);
  }
  if (modules_are_read || sections.empty()) return named;
  for (const TactileModuleSection& module : robot.config.tactile_modules) {
    const Vector3 end(module.config.length_m, 0.0, 0.0);
    named.capsules.push_back(
        {module.config.link, Vector3::Zero(), end, module.config.cover_radius_m});
    named.links.push_back(module.link);
  }
  return named;
}

}  // namespace tactus
