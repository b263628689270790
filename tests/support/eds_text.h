#pragma once

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

/// The data sheet of a drive that Tactus can use, to be broken in one place at a time.
namespace tactus::test {

inline std::string edsText() {
  std::ostringstream text;
  text << std::ifstream(std::string(TACTUS_SOURCE_DIR) + "/tests/fuzz/sheets/drive.eds").rdbuf();
  return text.str();
}

/// The section without its name: `[name]` up to the next one.
inline std::pair<std::size_t, std::size_t> edsSectionSpan(const std::string& eds,
                                                          std::string_view name) {
  const std::string head = "[" + std::string(name) + "]\n";
  const std::size_t begin = eds.find(head);
  if (begin == std::string::npos) throw std::out_of_range(head);
  const std::size_t end = eds.find("\n[", begin);
  return {begin, (end == std::string::npos ? eds.size() : end + 1) - begin};
}

inline bool hasEdsLine(const std::string& eds, std::string_view section, std::string_view key) {
  const auto [begin, size] = edsSectionSpan(eds, section);
  return eds.substr(begin, size).find("\n" + std::string(key) + "=") != std::string::npos;
}

/// With a line of a section replaced; `line` with its key alone stands for the whole line.
inline std::string withEdsLine(std::string eds, std::string_view section, std::string_view key,
                               std::string_view line) {
  const auto [begin, size] = edsSectionSpan(eds, section);
  const std::size_t at = eds.find("\n" + std::string(key) + "=", begin) + 1;
  if (at == 0 || at > begin + size) throw std::out_of_range(std::string(key));
  return eds.replace(at, eds.find('\n', at) - at, line);
}

inline std::string withoutEdsSection(std::string eds, std::string_view section) {
  const auto [begin, size] = edsSectionSpan(eds, section);
  return eds.erase(begin, size);
}

/// Without the object in the list that has it, either.
inline std::string withoutEdsObject(std::string eds, const std::string& index) {
  std::size_t at = eds.find("=0x" + index + "\n");
  if (at == std::string::npos) throw std::out_of_range(index);
  at = eds.rfind('\n', at) + 1;
  eds.erase(at, eds.find('\n', at) + 1 - at);
  constexpr std::string_view kCount = "SupportedObjects=";
  at = eds.rfind(kCount, at) + kCount.size();
  const std::size_t digits = eds.find('\n', at) - at;
  eds.replace(at, digits, std::to_string(std::stoi(eds.substr(at, digits)) - 1));
  return withoutEdsSection(std::move(eds), index);
}

/// The line, from 1, of a key in a section, or of the section's name for an empty key.
inline int edsLineOf(const std::string& eds, std::string_view section, std::string_view key) {
  const auto [begin, size] = edsSectionSpan(eds, section);
  std::size_t at = begin;
  if (!key.empty()) at = eds.find("\n" + std::string(key) + "=", begin) + 1;
  return 1 + static_cast<int>(std::count(eds.begin(), eds.begin() + static_cast<long>(at), '\n'));
}

}  // namespace tactus::test
