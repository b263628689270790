#include "tactus/scene/key_defaults.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>

namespace tactus {
namespace {

/// A short spelling that reads back the same: 1e6, not 1000000.0 or 1e+06.
std::string numberText(double number) {
  std::string text = fmt::format("{:g}", number);
  if (std::strtod(text.c_str(), nullptr) != number) return fmt::format("{}", number);
  for (const char* const padding : {"e+0", "e+"}) {
    if (const std::size_t at = text.find(padding); at != std::string::npos) {
      text.replace(at, std::string_view(padding).size(), "e");
    }
  }
  return text;
}

/// A value in YAML.
struct ValueText {
  ValueType type;

  std::string operator()(const double* value) const { return numberText(*value); }
  std::string operator()(const int* value) const { return fmt::format("{}", *value); }
  std::string operator()(const std::uint32_t* value) const { return fmt::format("{:#x}", *value); }
  std::string operator()(const std::uint64_t* value) const { return fmt::format("{}", *value); }
  std::string operator()(const bool* value) const { return *value ? "true" : "false"; }
  std::string operator()(const std::string* value) const { return *value; }
  std::string operator()(const Vector3* value) const {
    return fmt::format("[{}, {}, {}]", numberText(value->x()), numberText(value->y()),
                       numberText(value->z()));
  }
  std::string operator()(const WordsTarget& words) const {
    const std::string text = fmt::format("{}", fmt::join(words.get(), ", "));
    return type == ValueType::kChoiceList ? "[" + text + "]" : text;
  }
  template <class T>
  std::string operator()(const T*) const {
    return "";  // lists of any length: no row has one as its default
  }
};

}  // namespace

void addDefaults(std::vector<KeySpec>& keys, void* config) {
  for (KeySpec& spec : keys) {
    if (spec.enter) {
      addDefaults(spec.keys, spec.enter(config));
    } else if (spec.presence == Presence::kDefaulted) {
      spec.default_value = std::visit(ValueText{spec.type}, spec.target(config));
    }
  }
}

}  // namespace tactus
