#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "tactus/scene/config_draft.h"

/// What may stand in a scene and in a robot.yaml, as plain data. The one source of truth: the
/// readers, the defaults and every description of the format follow from these tables.
namespace tactus {

enum class ValueType {
  kNumber,
  kInteger,
  kBoolean,
  kText,
  kChoice,       ///< one of `choices`
  kChoiceList,   ///< list of distinct `choices`
  kNumberList,   ///< list of numbers, each within `range`
  kNumberTable,  ///< list of `count.min` lists of `columns` numbers
  kSection,
  kSectionList,
};

/// Allowed values of a number.
struct Range {
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  bool lower_open = false;  ///< lower itself is not allowed
};

/// Allowed length of a list.
struct Count {
  int min = 1;
  int max = 1;
  bool one_a_joint = false;  ///< exactly one entry a moving joint, checked when the robot is known
};

/// What an absent key means.
enum class Presence {
  kRequired,
  kOptional,   ///< what it describes does not exist or has no limit
  kDefaulted,  ///< the same as `default_value`, or as an empty section
};

/// Where a value goes.
using Target = std::variant<
    std::monostate, double& (*)(ConfigDraft&), int& (*)(ConfigDraft&),
    std::uint64_t& (*)(ConfigDraft&), bool& (*)(ConfigDraft&), std::string& (*)(ConfigDraft&),
    Vector3& (*)(ConfigDraft&), std::vector<double>& (*)(ConfigDraft&),
    std::vector<std::string>& (*)(ConfigDraft&), Eigen::Matrix<double, 4, 8>& (*)(ConfigDraft&)>;

struct KeySpec {
  std::string key;
  ValueType type = ValueType::kNumber;
  std::string unit;  ///< empty without one
  Range range;
  Count count;
  int columns = 0;
  std::vector<std::string> choices;
  Presence presence = Presence::kRequired;
  std::string default_value;  ///< in YAML
  std::string doc;            ///< one line
  Target target;
  std::vector<KeySpec> keys;              ///< of a section
  void (*begin)(ConfigDraft&) = nullptr;  ///< called before a section that is present is read

  const char* numberNoun() const {
    return type == ValueType::kInteger ? "a whole number" : "a number";
  }
};

/// The keys of a scene file and of a robot.yaml, top level first, in the order they are documented.
const std::vector<KeySpec>& sceneKeys();
const std::vector<KeySpec>& robotKeys();

/// Spellings of `controller.variant`, of `task.components` in the order of TaskConfig, and of the
/// kinds of troubles in the order of Trouble::Kind.
const std::vector<std::string>& variantNames();
const std::vector<std::string>& componentNames();
const std::vector<std::string>& troubleNames();

KeySpec simulationSection();  ///< of a scene

/// Rows of robot.yaml that make up HardwareConfig.
KeySpec canSection();
KeySpec drivesSection();
std::vector<KeySpec> moduleOnBusKeys();
KeySpec gpioSection();
KeySpec realTimeSection();

/// "a number > 0 in s", "a list of 3 numbers in m": what an error says it expected.
std::string describeExpectation(const KeySpec& spec);

}  // namespace tactus
