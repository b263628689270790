#include "tactus/cli/commission_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tactus/scene/located_error.h"
#include "tactus/scene/number_text.h"

namespace tactus {
namespace {

using Kind = Answer::Kind;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMillimetre = 1e-3;

bool slides(const Scene& scene, int joint) {
  return scene.controller.chain.type(joint) == JointType::kPrismatic;
}

/// m or rad of one that the engineer says.
double unitSaid(const Scene& scene, int joint) {
  return slides(scene, joint) ? kMillimetre : kDegree;
}

/// "roughly along the base's +z"; a direction between axes has no such name.
std::string nearestAxis(const Vector3& direction) {
  constexpr double kNear = 0.9;
  int axis = 0;
  if (direction.cwiseAbs().maxCoeff(&axis) < kNear) return "between the axes of the base";
  return fmt::format("along the base's {}{}", direction[axis] > 0.0 ? '+' : '-', "xyz"[axis]);
}

std::string numbersOf(Vector3 v) {
  for (double& x : v) x = std::abs(x) < 5e-4 ? 0.0 : x;  // no -0
  return fmt::format("({:.3g}, {:.3g}, {:.3g})", v.x(), v.y(), v.z());
}

std::optional<Answer> number(const Scene& scene, int joint, const std::string& word) {
  const std::optional<double> value = finiteNumber(word);
  if (!value) return std::nullopt;
  return Answer{Kind::kNumber, *value * unitSaid(scene, joint)};
}

std::string otherJointsText(const Scene& scene, int joint) {
  std::string text;
  for (int other = 0; other < scene.controller.chain.size(); ++other)
    if (other != joint) text += (text.empty() ? "" : ", ") + jointText(scene, other);
  return text;
}

}  // namespace

std::string jointText(const Scene& scene, int joint) {
  return escaped(scene.joint_names[static_cast<std::size_t>(joint)]);
}

std::string trimmedLine(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return {};
  return std::string(line.substr(first, line.find_last_not_of(" \t\r\n") + 1 - first));
}

std::string placeText(const Scene& scene, int bus, int node_id) {
  return fmt::format("node {} on {}", node_id,
                     escaped(scene.hardware->buses[static_cast<std::size_t>(bus)].interface));
}

std::string lengthText(const Scene& scene, int joint, double value) {
  return fmt::format("{:.4g} {}", value / unitSaid(scene, joint),
                     slides(scene, joint) ? "mm" : "deg");
}

std::string axisText(const Scene& scene, int joint) {
  ChainPose pose;
  scene.controller.chain.computePose(scene.controller.q_start, pose);
  const Vector3 axis_Base = pose.axis_Base[joint];
  const Vector3 axis_Joint = pose.R_BaseJoint[joint].transpose() * axis_Base;
  const std::string place =
      fmt::format("its axis {}, which at the scene's start points {}, {}", numbersOf(axis_Joint),
                  nearestAxis(axis_Base), numbersOf(axis_Base));
  if (slides(scene, joint))
    return fmt::format("+ slides {} along {}", jointText(scene, joint), place);
  return fmt::format(
      "+ turns {} about {}: right hand, thumb along the axis, the fingers go the way of +",
      jointText(scene, joint), place);
}

std::string questionText(const Scene& scene, const CommissionConfig& config,
                         const Question& question) {
  const int joint = question.joint;
  const MotionBounds& bounds = config.bounds(joint);
  const std::string here =
      question.position
          ? fmt::format(" ({} by what is known)", lengthText(scene, joint, *question.position))
          : std::string();
  switch (question.asked) {
    case Asked::kReady:
      return fmt::format(
          "{}, perhaps {}: put it far from its ends. It will move at most {} at a time, at most "
          "{}/s, "
          "and has no power while a question is open. May it?",
          jointText(scene, joint), placeText(scene, question.bus, question.node_id),
          lengthText(scene, joint, bounds.max_travel), lengthText(scene, joint, bounds.max_speed));
    case Asked::kDirection:
      return fmt::format(
          "{}.\nWhich way did {} go? If it moved less than {}, say none; if another "
          "joint moved, its name. Step back before you type.",
          axisText(scene, joint), jointText(scene, joint), lengthText(scene, joint, bounds.unseen));
    case Asked::kPlace:
      return fmt::format(
          "Measure {} as it is now{}. Where is it, in {}, by the URDF's zero and +? Step back "
          "before you type: it may move then.",
          jointText(scene, joint), here, slides(scene, joint) ? "mm" : "deg");
    case Asked::kJog:
      return fmt::format(
          "{}{}{}: + or - to move it by {}, upper or lower if it may go no further, "
          "done when both are told, or without.",
          question.is_refused ? "An end that was told is there, or too near. " : "",
          jointText(scene, joint), here, lengthText(scene, joint, bounds.max_travel));
    case Asked::kEndPlace:
      return fmt::format(
          "{}Where is {} at its {} end{}, in {}? Measured here, counts get more exact; "
          "none to go on without.",
          question.is_refused ? "That does not fit the places measured before. " : "",
          jointText(scene, joint), question.is_upper ? "upper" : "lower", here,
          slides(scene, joint) ? "mm" : "deg");
  }
  return {};
}

std::optional<Answer> parseAnswer(const Scene& scene, const Question& question,
                                  std::string_view line) {
  const std::string word = trimmedLine(line);
  if (word.empty()) return std::nullopt;
  const auto is = [&word](std::string_view one, std::string_view other) {
    return word == one || word == other;
  };
  switch (question.asked) {
    case Asked::kReady:
      if (is("yes", "y")) return Answer{Kind::kYes};
      if (is("no", "n")) return Answer{Kind::kNo};
      return std::nullopt;
    case Asked::kDirection: {
      if (is("+", "plus")) return Answer{Kind::kPlus};
      if (is("-", "minus")) return Answer{Kind::kMinus};
      const auto& names = scene.joint_names;
      const auto named = std::ranges::find(names, word);
      if (named != names.end())
        return Answer{Kind::kOtherJoint, 0.0, static_cast<int>(named - names.begin())};
      if (is("none", "?")) return Answer{Kind::kNothing};
      return std::nullopt;
    }
    case Asked::kPlace:
      return number(scene, question.joint, word);
    case Asked::kJog:
      if (is("+", "plus")) return Answer{Kind::kPlus};
      if (is("-", "minus")) return Answer{Kind::kMinus};
      if (word == "upper") return Answer{Kind::kUpper};
      if (word == "lower") return Answer{Kind::kLower};
      if (word == "done") return Answer{Kind::kDone};
      return std::nullopt;
    case Asked::kEndPlace:
      if (is("none", "?")) return Answer{Kind::kUnknown};
      return number(scene, question.joint, word);
  }
  return std::nullopt;
}

std::string expectedText(const Scene& scene, const Question& question) {
  const char* const unit = slides(scene, question.joint) ? "mm" : "deg";
  switch (question.asked) {
    case Asked::kReady:
      return "yes or no";
    case Asked::kDirection:
      return fmt::format(
          "+, -, none, or of the joints that are not finished another one's name: {}",
          otherJointsText(scene, question.joint));
    case Asked::kPlace:
      return fmt::format("a number, {}", unit);
    case Asked::kJog:
      return "+, -, upper, lower or done";
    case Asked::kEndPlace:
      return fmt::format("a number, {}, or none", unit);
  }
  return {};
}

}  // namespace tactus
