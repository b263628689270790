#pragma once

#include <string>
#include <string_view>

namespace tactus {

/// Builds one JSON text, indented by two spaces, in the order of the calls. Numbers keep every bit
/// (shortest decimal that reads back the same); what JSON has no number for becomes null.
///
///   JsonWriter json;
///   json.beginObject();
///   json.key("scene").value("free_motion");
///   json.endObject();
///   json.text();  // {"scene": "free_motion"} and a line break
class JsonWriter {
 public:
  void beginObject() { open('{'); }
  void endObject() { close('}'); }
  void beginArray() { open('['); }
  void endArray() { close(']'); }

  /// The name of the next value of an object: key("a").value(1), key("b").beginArray().
  JsonWriter& key(std::string_view name);
  void value(std::string_view text);
  void value(const char* text) { value(std::string_view(text)); }
  void value(double number);
  void value(long long number);
  void value(int number) { value(static_cast<long long>(number)); }
  void value(bool truth) { scalar(truth ? "true" : "false"); }
  void null() { scalar("null"); }

  /// The finished text with a line break at its end.
  std::string text() const { return text_ + '\n'; }

 private:
  void open(char bracket);
  void close(char bracket);
  void scalar(std::string_view text);
  void startItem();

  std::string text_;
  int depth_ = 0;
  bool is_first_ = true;  ///< in the innermost object or array
  bool follows_key_ = false;
};

/// Quoted and escaped; bytes that are no UTF-8 become U+FFFD.
std::string jsonString(std::string_view text);

}  // namespace tactus
