#include "tactus/doctor/machine_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <fstream>
#include <iterator>

namespace tactus {
namespace {

constexpr std::string_view kWhiteSpace = " \t\n\r";
constexpr long long kMaxCpus = 1 << 16;  ///< what is more is no CPU, and is not counted up to

}  // namespace

std::optional<std::string> readText(const std::filesystem::path& file) {
  std::error_code none;
  std::ifstream in(file, std::ios::binary);
  if (!in || std::filesystem::is_directory(file, none)) return std::nullopt;
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) return std::nullopt;
  text.erase(text.find_last_not_of(kWhiteSpace) + 1);
  text.erase(0, text.find_first_not_of(kWhiteSpace));
  return text;
}

std::optional<long long> numberIn(std::string_view text) {
  long long number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::optional<long long> readNumber(const std::filesystem::path& file) {
  const std::optional<std::string> text = readText(file);
  return text ? numberIn(*text) : std::nullopt;
}

std::vector<std::string_view> split(std::string_view text, std::string_view separators) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; (begin = text.find_first_not_of(separators, begin)) != text.npos;) {
    const std::size_t end = std::min(text.find_first_of(separators, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end;
  }
  return parts;
}

std::set<int> cpuSet(std::string_view text) {
  std::set<int> cpus;
  for (const std::string_view part : split(text, ",")) {
    const std::size_t dash = part.find('-');
    const auto first = numberIn(part.substr(0, dash));
    const auto last = dash == part.npos ? first : numberIn(part.substr(dash + 1));
    if (!first || !last || *first < 0 || *last >= kMaxCpus) continue;
    for (long long cpu = *first; cpu <= *last; ++cpu) cpus.insert(static_cast<int>(cpu));
  }
  return cpus;
}

std::string listOf(const std::set<int>& numbers) {
  return fmt::format("{}", fmt::join(numbers, ", "));
}

}  // namespace tactus
