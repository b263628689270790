#pragma once

#include <string>
#include <vector>

namespace tactus {

/// A program beside this one takes over, with these arguments: it links what nobody else should
/// need. Throws RunError where it is not there.
[[noreturn]] void becomeSibling(const std::string& name, const std::vector<std::string>& arguments);

}  // namespace tactus
