#pragma once

#include <fmt/format.h>

#include <string>

#include "support/random.h"

namespace tactus::test {

/// The limit of a joint as descriptions have it: whole, of zeros, in part, or not at all.
inline std::string randomLimit(Random& random, bool is_prismatic) {
  const double lower = is_prismatic ? random.uniform(-0.5, 0.0) : random.uniform(-3.0, 0.3);
  const double upper = lower + (is_prismatic ? random.uniform(0.1, 0.8) : random.uniform(0.5, 4.0));
  const double speed = random.logUniform(0.05, 3.0);
  switch (random.index(6)) {
    case 0:
      return "";
    case 1:
      return R"(<limit lower="0" upper="0" effort="0" velocity="0"/>)";
    case 2:
      return fmt::format(R"(<limit velocity="{:.4f}"/>)", speed);
    case 3:
      return fmt::format(R"(<limit upper="{:.4f}" velocity="0.0"/>)", upper);
    default:
      return fmt::format(R"(<limit lower="{:.4f}" upper="{:.4f}" velocity="{:.4f}" effort="50"/>)",
                         lower, upper, speed);
  }
}

inline std::string randomBody(Random& random) {
  if (random.chance(0.5)) return "";
  return fmt::format(
      R"(<inertial><mass value="{:.3f}"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>
    <collision><geometry><cylinder length="{:.3f}" radius="0.04"/></geometry></collision>)",
      random.uniform(0.1, 5.0), random.uniform(0.1, 0.4));
}

/// A chain of `count` moving joints from "base" to "tool", of links of 2 to 40 cm, some with fixed
/// joints in between.
inline std::string randomUrdf(Random& random, int count) {
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"drawn\">\n  <link name=\"base\"/>\n";
  std::string parent = "base";
  const auto add = [&](const std::string& name, const std::string& child, const char* type,
                       const std::string& more) {
    const Vector3 at = random.uniform(0.02, 0.4) * random.unitVector();
    const Vector3 rpy = random.vector<Vector3>(3, -1.6, 1.6);
    text += fmt::format(
        "  <joint name=\"{}\" type=\"{}\"><parent link=\"{}\"/><child link=\"{}\"/>\n"
        "    <origin xyz=\"{} {} {}\" rpy=\"{} {} {}\"/>{}</joint>\n  <link "
        "name=\"{}\">{}</link>\n",
        name, type, parent, child, at.x(), at.y(), at.z(), rpy.x(), rpy.y(), rpy.z(), more, child,
        randomBody(random));
    parent = child;
  };
  for (int i = 0; i < count; ++i) {
    if (random.chance(0.2))
      add(fmt::format("fixed {}", i), fmt::format("between {}", i), "fixed", "");
    const bool is_prismatic = random.chance(0.3), is_continuous = random.chance(0.2);
    const Vector3 axis = random.unitVector();
    const char* type = is_prismatic ? "prismatic" : is_continuous ? "continuous" : "revolute";
    add(fmt::format("j{}", i), fmt::format("link{}", i), type,
        fmt::format("<axis xyz=\"{} {} {}\"/>", axis.x(), axis.y(), axis.z()) +
            randomLimit(random, is_prismatic));
  }
  add("tool fixed", "tool", "fixed", "");
  return text + "</robot>\n";
}

}  // namespace tactus::test
