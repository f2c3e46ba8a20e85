// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/value.hpp>

#include <optional>
#include <string>
#include <unordered_set>

namespace segue::type::detail {

/// A list or map under construction by a reader of text: keeps the order, and finds duplicate keys in linear
/// time.
class Collection {
 public:
  Collection(bool is_map, Mark mark) : is_map_(is_map), mark_(mark) {}

  [[nodiscard]] bool expects_key() const { return is_map_ && !key_; }
  /// Sets the key of the next value; false, without effect, where the map has that key already.
  bool take_key(const std::string& key);
  /// Adds the next item, or the value of the key. Requires !expects_key().
  void add(Value value);
  /// The finished list or map, with its mark. Leaves the collection empty.
  Value finish();

 private:
  bool is_map_;
  Mark mark_;
  Value::List items_;
  ValueMap entries_;
  std::optional<std::string> key_;
  std::unordered_set<std::string> keys_;  // for large maps only
};

}  // namespace segue::type::detail
