// SPDX-License-Identifier: Apache-2.0
#include <segue/web/change.hpp>

#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace segue::web {

namespace {

using type::Value;
using type::ValueMap;

std::string key_of(const Value& item, std::initializer_list<std::string_view> keys) {
  std::string key;
  for (const std::string_view part : keys) {
    const Value* text = item.find(part);
    if (text == nullptr || !text->is_string()) return {};
    key += (key.empty() ? "" : " ") + text->as_string();
  }
  return key;
}

}  // namespace

Value change_between(const Value& from, const Value& to) {
  std::unordered_map<std::string_view, const Value*> before;
  for (const auto& [key, value] : from.as_map())
    before.emplace(key, &value);
  ValueMap set;
  ValueMap inner;
  for (const auto& [key, value] : to.as_map()) {
    const auto known = before.find(key);
    if (known == before.end()) {
      set.append(key, value);
      continue;
    }
    const Value& old = *known->second;
    before.erase(known);
    if (old == value) continue;
    if (old.is_map() && value.is_map()) {
      inner.append(key, change_between(old, value));
    } else {
      set.append(key, value);
    }
  }
  ValueMap change;
  if (!set.empty()) change.set("set", std::move(set));
  if (!before.empty()) {
    Value::List removed;
    for (const auto& [key, value] : before)
      removed.emplace_back(key);
    change.set("remove", std::move(removed));
  }
  if (!inner.empty()) change.set("in", std::move(inner));
  return change;
}

Value keyed(const Value::List& list, std::initializer_list<std::string_view> keys) {
  ValueMap map;
  std::unordered_set<std::string> seen;
  for (const Value& item : list) {
    std::string key = key_of(item, keys);
    if (!key.empty() && seen.insert(key).second) map.append(std::move(key), item);
  }
  return map;
}

}  // namespace segue::web
