#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "tactus/control/tactile_channels.h"
#include "tactus/math/types.h"

/// What may stand in a scene and in a robot.yaml, bound to the configs that it fills. The one
/// source of truth: the reader and every description of the format follow from these tables, and
/// the defaults are those of the configs.
namespace tactus {

enum class ValueType {
  kNumber,
  kInteger,
  kBoolean,
  kText,
  kChoice,       ///< one of `choices`
  kChoiceList,   ///< list of distinct `choices`
  kNumberList,   ///< list of numbers, each within `range`
  kNumberTable,  ///< list of `count` lists of `columns` numbers
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

/// When a running daemon takes a new value.
enum class KeyContext {
  kRestart,  ///< at its next start
  kFree,     ///< once nothing was touched for half a second
  kLive,     ///< at once; all that are not kRestart are gains, and go there on a ramp
};
const char* contextName(KeyContext context) noexcept;

/// A section of the top level without which a key says nothing.
struct Needs {
  std::string section;  ///< empty: none
  std::string problem, expectation;
};

/// Words that stand for something else: enumerators, numbers of axes.
struct WordsTarget {
  std::function<void(const std::vector<std::string>&)> set;
  std::function<std::vector<std::string>()> get;
};

/// Where a value goes. CAN identifiers alone are std::uint32_t, and a calibration is of its
/// channels.
using Target = std::variant<double*, int*, std::uint32_t*, std::uint64_t*, bool*, std::string*,
                            Vector3*, std::vector<double>*, TactileChannels*, WordsTarget>;

/// A row of the table of a config struct. `owner` points to an object of that struct; Row<S> of
/// key_builders.h keeps the types right.
struct KeySpec {
  std::string key;
  ValueType type = ValueType::kNumber;
  std::string unit;  ///< empty without one
  Range range;
  Count count;
  int columns = 0;
  std::vector<std::string> choices;
  Presence presence = Presence::kRequired;
  std::string default_value;  ///< in YAML, as a new config has it
  std::string symbol;         ///< of the paper, as T_t,max; empty without one
  std::string doc;            ///< one line
  Needs needs;
  KeyContext context = KeyContext::kRestart;
  std::function<Target(void* owner)> target;  ///< of a value; makes it if it is optional
  std::function<void*(void* owner)> enter;    ///< of a section: makes it or a new entry of its list
  std::vector<KeySpec> keys;                  ///< of a section: rows of what `enter` returns
  std::string same_as;  ///< of a section: the list that has its rows in its documents, too

  const char* numberNoun() const {
    return type == ValueType::kInteger ? "a whole number" : "a number";
  }
};

/// The keys of a scene file (rows of SceneConfig) and of a robot.yaml (rows of RobotConfig), top
/// level first, in the order they are documented.
const std::vector<KeySpec>& sceneKeys();
const std::vector<KeySpec>& robotKeys();

/// "a number > 0 in s", "a list of 3 numbers in m": what an error says it expected.
std::string describeExpectation(const KeySpec& spec);

/// "controller.damping": the first key of this name within the sections of these; empty if there is
/// none.
std::string keyWithin(const std::vector<KeySpec>& keys, const std::string& name);

}  // namespace tactus
