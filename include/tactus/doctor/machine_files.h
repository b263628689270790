#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

/// What the kernel tells of itself in files. `root` stands for "/" everywhere, so that tests can
/// show a machine of their own.
namespace tactus {

using MachineRoot = std::filesystem::path;

/// A whole file without white space at its ends; nullopt if it cannot be read.
std::optional<std::string> readText(const std::filesystem::path& file);

/// A text that is a decimal number and no more.
std::optional<long long> numberIn(std::string_view text);

/// A file that holds one decimal number.
std::optional<long long> readNumber(const std::filesystem::path& file);

/// Parts between separators, without empty ones.
std::vector<std::string_view> split(std::string_view text, std::string_view separators = " \t");
std::vector<std::string_view> split(std::string&&, std::string_view = {}) = delete;  // would dangle

/// "0-2,5" as the kernel writes sets of CPUs; parts that are no numbers are left out.
std::set<int> cpuSet(std::string_view text);

/// "0, 1, 5".
std::string listOf(const std::set<int>& numbers);

}  // namespace tactus
