#pragma once

#include <type_traits>
#include <variant>

namespace tactus {

/// Calls a function with what a variant of two kinds of drives holds. As std::visit, which might
/// throw.
template <class Function, class Variant>
decltype(auto) visitKind(Function&& function, Variant& variant) noexcept {
  static_assert(std::variant_size_v<std::remove_const_t<Variant>> == 2);
  if (auto* const first = std::get_if<0>(&variant)) return function(*first);
  return function(*std::get_if<1>(&variant));
}

}  // namespace tactus
