// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::model {

enum class Comparator : std::uint8_t { Equal, NotEqual, AtMost, AtLeast, Less, More };
/// Longer signs before those that they begin with.
inline constexpr std::array<std::string_view, 6> kComparatorSigns = {"==", "!=", "<=", ">=", "<", ">"};

/// Compares a field of a sample with a constant.
struct Comparison {
  std::vector<std::string> field;  ///< its parts (parse_field); empty: the sample itself
  Comparator comparator = Comparator::Equal;
  type::Value value;
  friend bool operator==(const Comparison&, const Comparison&) = default;
};

/// A condition on a sample: all comparisons hold. "code == 3 and pose.x < 1.5"; `value` is the sample itself
/// where it has no fields.
struct Condition {
  std::string text;  ///< as it was written
  std::vector<Comparison> all;
  friend bool operator==(const Condition&, const Condition&) = default;
};

/// ParseError says what is expected. Constants are written as in YAML.
Result<Condition> parse_condition(std::string_view text);

/// "path[0].x" as its parts "path", "0" and "x", of which numbers are places in lists; none for "value", the
/// sample itself; nothing where it is neither.
std::optional<std::vector<std::string>> parse_field(std::string_view text);
/// A field as parse_field() reads it.
std::string field_text(const std::vector<std::string>& field);
/// The field of the sample; null where it has none of that name or place.
const type::Value* find_field(const type::Value& sample, const std::vector<std::string>& field);

/// False too where the sample has no such field, or an order is asked of what has none.
bool holds(const Condition& condition, const type::Value& sample);

}  // namespace segue::model
