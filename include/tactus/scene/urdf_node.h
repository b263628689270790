#pragma once

#include <limits>
#include <string>

#include "tactus/math/types.h"
#include "tactus/scene/urdf_tree.h"

namespace tactus {

/// As the value of a number that is absent: it must not be.
inline constexpr double kRequired = std::numeric_limits<double>::quiet_NaN();

inline constexpr double kMaxUrdfLimit = 1e6;  ///< of a joint; m, rad, m/s or rad/s

/// Reads the numbers of an element of a URDF and of its children. Throws InputError.
struct UrdfNode {
  const UrdfTree& tree;
  pugi::xml_node node;
  std::string key;  ///< of the element, as joint.j1

  [[noreturn]] void fail(const pugi::xml_node& at, const std::string& part,
                         const std::string& problem, const std::string& expectation) const;

  /// The only one of this name; empty if there is none.
  pugi::xml_node child(const char* name) const;

  /// Three numbers from -bound to bound of a child's attribute.
  Vector3 vector(const char* child_name, const char* attribute, double bound,
                 const Vector3& absent) const;

  /// One number from -bound to bound; `absent` if it is not there.
  double number(const char* child_name, const char* attribute, double bound, double absent) const;

  /// Of the child `origin`, in the frame of the parent: m, and rpy about fixed axes.
  Pose origin() const;
};

}  // namespace tactus
