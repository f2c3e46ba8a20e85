// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <optional>
#include <string>
#include <unordered_set>

namespace segue::type::detail {

/// A list or map while a reader of text builds it: entries in order, duplicate keys found in linear time.
class Collection {
 public:
  Collection(bool is_map, Mark mark) : is_map_(is_map), mark_(mark) {}

  [[nodiscard]] bool expects_key() const { return is_map_ && !key_; }
  /// The key of the value to come; false, and nothing taken, where the map has it already.
  bool take_key(const std::string& key);
  /// The next item, or the value of the key. Requires !expects_key().
  void add(Value value);
  /// The whole, with its mark. The collection is empty afterwards.
  Value finish();

 private:
  bool is_map_;
  Mark mark_;
  Value::List items_;
  ValueMap entries_;
  std::optional<std::string> key_;
  std::unordered_set<std::string> keys_;  // only of large maps
};

}  // namespace segue::type::detail
