// SPDX-License-Identifier: Apache-2.0
#include <segue/ros2/literal.hpp>

#include <segue/base/text.hpp>
#include <segue/base/trimmed.hpp>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace segue::ros2 {

namespace {

using type::Value;

Error not_a(std::string_view text, const std::string& what) {
  return fail(ErrorCode::InvalidArgument, quote(text) + " is not " + what);
}

/// The magnitude of a number with or without 0x, 0o or 0b in front.
std::optional<std::uint64_t> magnitude(std::string_view text) {
  int base = 10;
  for (const auto& [prefix, its_base] : {std::pair{'x', 16}, std::pair{'o', 8}, std::pair{'b', 2}}) {
    if (text.size() > 2 && text[0] == '0' && std::tolower(static_cast<unsigned char>(text[1])) == prefix) {
      base = its_base;
      text.remove_prefix(2);
      break;
    }
  }
  std::uint64_t number = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), number, base);
  const bool is_whole = problem == std::errc() && end == text.data() + text.size() && !text.empty();
  return is_whole ? std::optional(number) : std::nullopt;
}

template <class T>
Result<Value> integer(std::string_view text) {
  const bool is_negative = text.starts_with('-');
  const std::string_view digits = is_negative || text.starts_with('+') ? text.substr(1) : text;
  const auto most = is_negative ? static_cast<std::uint64_t>(-(std::numeric_limits<T>::min() + 1)) + 1
                                : static_cast<std::uint64_t>(std::numeric_limits<T>::max());
  const auto number = magnitude(digits);
  if (number && (!is_negative || std::is_signed_v<T> || *number == 0) && *number <= most)
    return is_negative ? Value(static_cast<std::int64_t>(0 - *number)) : Value(*number);
  return not_a(text, "an integer from " + std::to_string(std::numeric_limits<T>::min()) + " to " +
                         std::to_string(std::numeric_limits<T>::max()));
}

Result<Value> floating(std::string_view text) {
  const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
  double number = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (problem != std::errc() || end != digits.data() + digits.size() || digits.empty())
    return not_a(text, "a number");
  return Value(number);
}

Result<Value> boolean(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower == "true" || lower == "1") return Value(true);
  if (lower == "false" || lower == "0") return Value(false);
  return not_a(text, "true or false");
}

/// The text within quotes, whose escapes of that quote are resolved. Nothing: an inner quote is not escaped.
std::optional<std::string> unescaped(std::string_view inner, char mark) {
  std::string text;
  for (std::size_t i = 0; i < inner.size(); ++i) {
    if (inner[i] == mark) return std::nullopt;
    const bool is_escape = inner[i] == '\\' && i + 1 < inner.size() && inner[i + 1] == mark;
    text += is_escape ? inner[++i] : inner[i];
  }
  return text;
}

Result<Value> string(std::string_view written, std::uint64_t capacity) {
  std::string text(written);
  const char mark = written.empty() ? ' ' : written.front();
  if ((mark == '"' || mark == '\'') && written.size() > 1 && written.back() == mark) {
    auto inner = unescaped(written.substr(1, written.size() - 2), mark);
    if (!inner) return not_a(written, std::string("text whose inner quotes are escaped as \\") + mark);
    text = std::move(*inner);
  }
  if (capacity > 0 && text.size() > capacity)
    return not_a(written, "text of at most " + std::to_string(capacity) + " characters");
  return Value(std::move(text));
}

Result<Value> single(std::string_view text, const FieldType& type) {
  switch (type.primitive) {
    case Primitive::Bool:
      return boolean(text);
    case Primitive::Byte:
    case Primitive::Uint8:
      return integer<std::uint8_t>(text);
    case Primitive::Int8:
      return integer<std::int8_t>(text);
    case Primitive::Int16:
      return integer<std::int16_t>(text);
    case Primitive::Uint16:
      return integer<std::uint16_t>(text);
    case Primitive::Int32:
      return integer<std::int32_t>(text);
    case Primitive::Uint32:
      return integer<std::uint32_t>(text);
    case Primitive::Int64:
      return integer<std::int64_t>(text);
    case Primitive::Uint64:
      return integer<std::uint64_t>(text);
    case Primitive::Float32:
    case Primitive::Float64:
      return floating(text);
    case Primitive::String:
    case Primitive::WString:
    case Primitive::BoundedString:
    case Primitive::BoundedWString:
      return string(text, type.string_capacity);
    case Primitive::Nested:
      break;
  }
  return fail(ErrorCode::InvalidArgument, "a field of type " + to_string(type) + " can have no default");
}

/// The items of a list, without the brackets; commas within quotes belong to the item.
std::vector<std::string_view> items_of(std::string_view list) {
  std::vector<std::string_view> items;
  std::size_t begin = 0;
  char mark = 0;
  for (std::size_t i = 0; i <= list.size(); ++i) {
    if (i == list.size() || (mark == 0 && list[i] == ',')) {
      items.push_back(trimmed(list.substr(begin, i - begin)));
      begin = i + 1;
    } else if (mark != 0 && list[i] == '\\') {
      ++i;
    } else if (mark == list[i]) {
      mark = 0;
    } else if (mark == 0 && (list[i] == '"' || list[i] == '\'')) {
      mark = list[i];
    }
  }
  if (items.size() == 1 && items.front().empty()) items.clear();
  return items;
}

}  // namespace

Result<Value> parse_default(std::string_view text, const FieldType& type) {
  if (type.multiplicity == Multiplicity::Single) return single(text, type);
  if (!text.starts_with('[') || !text.ends_with(']') || text.size() < 2)
    return not_a(text, "a list such as [1, 2]");
  const auto items = items_of(text.substr(1, text.size() - 2));
  if (type.multiplicity == Multiplicity::Array && items.size() != type.capacity)
    return not_a(text, "a list of " + counted(type.capacity, "item"));
  if (type.multiplicity == Multiplicity::BoundedSequence && items.size() > type.capacity)
    return not_a(text, "a list of at most " + counted(type.capacity, "item"));
  Value::List values;
  for (const std::string_view item : items) {
    auto value = single(item, type);
    if (!value) return value.error();
    values.push_back(std::move(*value));
  }
  return Value(std::move(values));
}

}  // namespace segue::ros2
