#include "tactus/scene/json.h"

#include <fmt/format.h>

#include <cmath>

#include "tactus/scene/located_error.h"

namespace tactus {

std::string jsonString(std::string_view text) {
  std::string result = "\"";
  while (!text.empty()) {
    const std::size_t length = utf8CharacterLength(text);
    const auto first = static_cast<unsigned char>(text[0]);
    if (length == 0) {
      result += "\\ufffd";
    } else if (first == '"' || first == '\\') {
      result += {'\\', text[0]};
    } else if (first < 0x20) {
      result += fmt::format("\\u{:04x}", first);
    } else {
      result += text.substr(0, length);
    }
    text.remove_prefix(length == 0 ? 1 : length);
  }
  return result + '"';
}

JsonWriter& JsonWriter::key(std::string_view name) {
  startItem();
  text_ += jsonString(name) + ": ";
  follows_key_ = true;
  return *this;
}

void JsonWriter::value(std::string_view text) { scalar(jsonString(text)); }

void JsonWriter::value(double number) {
  scalar(std::isfinite(number) ? fmt::format("{}", number) : "null");
}

void JsonWriter::value(long long number) { scalar(fmt::format("{}", number)); }

void JsonWriter::open(char bracket) {
  startItem();
  text_ += bracket;
  ++depth_;
  is_first_ = true;
}

void JsonWriter::close(char bracket) {
  --depth_;
  if (!is_first_) text_ += '\n' + std::string(2 * depth_, ' ');
  text_ += bracket;
  is_first_ = false;
}

void JsonWriter::scalar(std::string_view text) {
  startItem();
  text_ += text;
}

void JsonWriter::startItem() {
  if (follows_key_) {
    follows_key_ = false;
    return;
  }
  if (!is_first_) text_ += ',';
  if (depth_ > 0) text_ += '\n' + std::string(2 * depth_, ' ');
  is_first_ = false;
}

}  // namespace tactus
