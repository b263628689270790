#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tactus/scene/key_table.h"

/// Rows of key tables that know the struct they are of, and what can be done to them.
namespace tactus::keys {

/// A row of the table of the struct S.
template <class S>
struct Row {
  KeySpec spec;
};

template <class S>
using Table = std::vector<Row<S>>;

/// What stands in a member: of T and of std::optional<T> T.
template <class T>
struct Content {
  using type = T;
  static constexpr bool kIsOptional = false;
};
template <class T>
struct Content<std::optional<T>> {
  using type = T;
  static constexpr bool kIsOptional = true;
};
template <class T>
using ContentOf = typename Content<T>::type;

/// The place of a member's value, which is made if it is optional.
template <class T>
T& make(T& member) {
  return member;
}
template <class T>
T& make(std::optional<T>& member) {
  return member.emplace();
}

template <class S>
std::vector<KeySpec> specsOf(Table<S> table) {
  std::vector<KeySpec> specs;
  for (Row<S>& row : table) specs.push_back(std::move(row.spec));
  return specs;
}

template <class S, class... More>
Table<S> join(Table<S> table, const More&... more) {
  (table.insert(table.end(), more.begin(), more.end()), ...);
  return table;
}

template <class S>
Row<S> required(Row<S> row) {
  row.spec.presence = Presence::kRequired;
  return row;
}
/// Of a member whose initialiser means that there is none.
template <class S>
Row<S> optional(Row<S> row) {
  row.spec.presence = Presence::kOptional;
  return row;
}
template <class S>
Row<S> withSymbol(const std::string& symbol, Row<S> row) {
  row.spec.symbol = symbol;
  return row;
}
template <class S>
Row<S> onlyWith(const Needs& needs, Row<S> row) {
  row.spec.needs = needs;
  return row;
}

template <class S>
Row<S> whenFree(Row<S> row) {
  row.spec.context = KeyContext::kFree;
  return row;
}
/// All values but those that have another context already.
template <class S>
Table<S> live(Table<S> rows) {
  for (Row<S>& row : rows)
    if (row.spec.target && row.spec.context == KeyContext::kRestart)
      row.spec.context = KeyContext::kLive;
  return rows;
}

/// Rows of a struct inside S, as rows of S.
template <class S, class T>
Table<S> inside(T S::*member, Table<ContentOf<T>> rows) {
  Table<S> result;
  for (auto& [spec] : rows) {
    const auto inner = [member](void* owner) -> void* {
      T& place = static_cast<S*>(owner)->*member;
      if constexpr (Content<T>::kIsOptional) {
        return &*place;
      } else {
        return &place;
      }
    };
    if (spec.target) {
      spec.target = [inner, target = spec.target](void* owner) { return target(inner(owner)); };
    }
    if (spec.enter) {
      spec.enter = [inner, enter = spec.enter](void* owner) { return enter(inner(owner)); };
    }
    result.push_back({std::move(spec)});
  }
  return result;
}

}  // namespace tactus::keys
