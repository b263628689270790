#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "tactus/scene/key_row.h"
#include "tactus/scene/key_words.h"

/// Short spellings for the rows of the key tables.
namespace tactus::keys {

inline constexpr double kMaxTime_s = 86400.0;
inline constexpr double kMaxStiffness_N_per_m = 1e9;

inline Range above(double lower, double upper) { return {lower, upper, true}; }
inline Range within(double lower, double upper) { return {lower, upper, false}; }

/// A value of a std::optional may be absent; any other has its initialiser as default.
template <class S, class T>
Row<S> value(ValueType type, const std::string& key, const std::string& unit,
             const std::string& doc, T S::*member) {
  Row<S> row;
  row.spec.key = key;
  row.spec.type = type;
  row.spec.unit = unit;
  row.spec.doc = doc;
  row.spec.presence = Content<T>::kIsOptional ? Presence::kOptional : Presence::kDefaulted;
  row.spec.target = [member](void* owner) -> Target {
    return &make(static_cast<S*>(owner)->*member);
  };
  return row;
}

template <class S, class T>
Row<S> number(const std::string& key, const std::string& unit, const Range& range,
              const std::string& doc, T S::*member) {
  Row<S> row = value(ValueType::kNumber, key, unit, doc, member);
  row.spec.range = range;
  return row;
}

template <class S, class T>
Row<S> integer(const std::string& key, const Range& range, const std::string& doc, T S::*member) {
  Row<S> row = value(ValueType::kInteger, key, "", doc, member);
  row.spec.range = range;
  return row;
}

template <class S>
Row<S> boolean(const std::string& key, const std::string& doc, bool S::*member) {
  return value(ValueType::kBoolean, key, "", doc, member);
}

/// Required, unless it is a std::optional.
template <class S, class T>
Row<S> text(const std::string& key, const std::string& doc, T S::*member) {
  Row<S> row = value(ValueType::kText, key, "", doc, member);
  return Content<T>::kIsOptional ? row : required(row);
}

/// One of `words`, which last for ever.
template <class S, class E, std::size_t kSize>
Row<S> choice(const std::string& key, const std::string& doc, E S::*member,
              const std::array<Word<E>, kSize>& words) {
  Row<S> row;
  row.spec.key = key;
  row.spec.type = ValueType::kChoice;
  row.spec.presence = Presence::kDefaulted;
  row.spec.doc = doc;
  for (const Word<E>& word : words) row.spec.choices.push_back(word.text);
  row.spec.target = [member, &words](void* owner) -> Target {
    E& place = static_cast<S*>(owner)->*member;
    return WordsTarget{[&place, &words](const std::vector<std::string>& chosen) {
                         place = valueOf(words, chosen.front());
                       },
                       [&place, &words] { return std::vector<std::string>{wordOf(words, place)}; }};
  };
  return row;
}

template <class S>
Row<S> vector3(const std::string& key, const std::string& unit, const Range& range,
               const std::string& doc, Vector3 S::*member) {
  Row<S> row = value(ValueType::kNumberList, key, unit, doc, member);
  row.spec.range = range;
  row.spec.count = {3, 3};
  return row;
}

/// Required, unless it is a std::optional.
template <class S, class T>
Row<S> oneAJoint(const std::string& key, const std::string& unit, const Range& range,
                 const std::string& doc, T S::*member) {
  Row<S> row = value(ValueType::kNumberList, key, unit, doc, member);
  row.spec.range = range;
  row.spec.count = {2, kMaxJoints, true};
  return Content<T>::kIsOptional ? row : required(row);
}

/// Keys of the same struct S under a name of their own. `begin` is called if they are present.
template <class S>
Row<S> group(const std::string& key, const std::string& doc, Table<S> rows,
             void (*begin)(S&) = nullptr) {
  Row<S> row;
  row.spec.key = key;
  row.spec.type = ValueType::kSection;
  row.spec.doc = doc;
  row.spec.presence = Presence::kDefaulted;
  row.spec.keys = specsOf(std::move(rows));
  row.spec.enter = [begin](void* owner) {
    if (begin) begin(*static_cast<S*>(owner));
    return owner;
  };
  return row;
}

/// A struct inside S. That of a std::optional may be absent; any other is the same as empty then.
template <class S, class T>
Row<S> section(const std::string& key, const std::string& doc, T S::*member,
               Table<ContentOf<T>> rows) {
  Row<S> row = group<S>(key, doc, {});
  row.spec.presence = Content<T>::kIsOptional ? Presence::kOptional : Presence::kDefaulted;
  row.spec.keys = specsOf(std::move(rows));
  row.spec.enter = [member](void* owner) -> void* {
    return &make(static_cast<S*>(owner)->*member);
  };
  return row;
}

/// An entry a section; absent, the list is empty.
template <class S, class T>
Row<S> sectionList(const std::string& key, Count count, const std::string& doc,
                   std::vector<T> S::*member, Table<T> rows) {
  Row<S> row = optional(group<S>(key, doc, {}));
  row.spec.type = ValueType::kSectionList;
  row.spec.count = count;
  row.spec.keys = specsOf(std::move(rows));
  row.spec.enter = [member](void* owner) -> void* {
    return &(static_cast<S*>(owner)->*member).emplace_back();
  };
  return row;
}

/// A section in place of `list`, for its only entry.
template <class S, class T>
Row<S> onlyEntryOf(const std::string& list, const std::string& key, const std::string& doc,
                   std::vector<T> S::*member, Table<T> rows) {
  Row<S> row = sectionList(key, {1, 1}, doc, member, std::move(rows));
  row.spec.type = ValueType::kSection;
  row.spec.same_as = list;
  return row;
}

}  // namespace tactus::keys
