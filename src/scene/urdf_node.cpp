#include "tactus/scene/urdf_node.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <charconv>
#include <cmath>

#include "tactus/scene/number_text.h"

namespace tactus {
namespace {

constexpr double kMaxLength_m = 1e3;  // keeps products of transforms finite and meaningful
constexpr double kMaxAngle_rad = 1e3;
constexpr const char* kWhitespace = " \t\r\n";

/// Numbers between white space; false if there is anything else.
bool parseNumbers(std::string_view text, std::vector<double>& numbers) {
  while (true) {
    text.remove_prefix(std::min(text.find_first_not_of(kWhitespace), text.size()));
    if (text.empty()) return true;
    const std::string_view word = text.substr(0, text.find_first_of(kWhitespace));
    const std::string_view number = withoutPlus(word);
    const char* const end = number.data() + number.size();
    double value = 0.0;
    const auto [stop, error] = std::from_chars(number.data(), end, value);
    if (error != std::errc() || stop != end || !std::isfinite(value)) {
      return false;
    }
    numbers.push_back(value);
    text.remove_prefix(word.size());
  }
}

/// Rotations about the fixed axes x, y, z in this order, as the URDF defines rpy.
Matrix3 rotationOf(const Vector3& rpy) {
  return (Eigen::AngleAxisd(rpy.z(), Vector3::UnitZ()) *
          Eigen::AngleAxisd(rpy.y(), Vector3::UnitY()) *
          Eigen::AngleAxisd(rpy.x(), Vector3::UnitX()))
      .toRotationMatrix();
}

/// What is wrong with `count` numbers from -bound to bound; empty if nothing is.
std::string problemOf(const char* text, std::size_t count, double bound,
                      std::vector<double>& numbers) {
  if (!parseNumbers(text, numbers) || numbers.size() != count)
    return inQuotes(text) + (count == 1 ? " is no number" : " is no vector");
  const bool is_within =
      std::ranges::all_of(numbers, [bound](double x) { return std::abs(x) <= bound; });
  return is_within ? "" : inQuotes(text) + " is out of range";
}

}  // namespace

void UrdfNode::fail(const pugi::xml_node& at, const std::string& part, const std::string& problem,
                    const std::string& expectation) const {
  failAt(tree.position(at), key + "." + part, problem, "expected " + expectation);
}

pugi::xml_node UrdfNode::child(const char* name) const { return onlyChild(tree, node, name, key); }

Vector3 UrdfNode::vector(const char* child_name, const char* attribute, double bound,
                         const Vector3& absent) const {
  const pugi::xml_node at = child(child_name);
  const pugi::xml_attribute given = onlyAttribute(tree, at, attribute, key + "." + child_name);
  if (!given) return absent;
  std::vector<double> numbers;
  const std::string problem = problemOf(given.value(), 3, bound, numbers);
  if (!problem.empty())
    fail(at, std::string(child_name) + "." + attribute, problem,
         fmt::format("three numbers from {} to {}", -bound, bound));
  return {numbers[0], numbers[1], numbers[2]};
}

double UrdfNode::number(const char* child_name, const char* attribute, double bound,
                        double absent) const {
  const pugi::xml_node at = child(child_name);
  const std::string part = std::string(child_name) + "." + attribute;
  const pugi::xml_attribute given = onlyAttribute(tree, at, attribute, key + "." + child_name);
  if (!given) {
    if (!std::isnan(absent)) return absent;
    fail(at ? at : node, part, "is missing", "a number");
  }
  std::vector<double> numbers;
  const std::string problem = problemOf(given.value(), 1, bound, numbers);
  if (!problem.empty())
    fail(at, part, problem, fmt::format("a number from {} to {}", -bound, bound));
  return numbers[0];
}

Pose UrdfNode::origin() const {
  return {rotationOf(vector("origin", "rpy", kMaxAngle_rad, Vector3::Zero())),
          vector("origin", "xyz", kMaxLength_m, Vector3::Zero())};
}

}  // namespace tactus
