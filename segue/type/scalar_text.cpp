// SPDX-License-Identifier: Apache-2.0
#include <segue/type/scalar_text.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <system_error>

namespace segue::type::detail {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

bool all_digits(std::string_view text) {
  return !text.empty() && std::ranges::all_of(text, is_digit);
}

std::size_t leading_digits(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::find_if_not(text, is_digit) - text.begin());
}

template <class Number, class... Base>
std::optional<Number> convert(std::string_view text, Base... base) {
  Number number{};
  const char* const end = text.data() + text.size();
  const auto [stop, status] = std::from_chars(text.data(), end, number, base...);
  if (status != std::errc{} || stop != end) return std::nullopt;
  return number;
}

std::string_view without_sign(std::string_view text) {
  return text.starts_with('+') || text.starts_with('-') ? text.substr(1) : text;
}

std::string_view without_plus(std::string_view text) {
  return text.starts_with('+') ? text.substr(1) : text;
}

// [-+]? ( \.[0-9]+ | [0-9]+(\.[0-9]*)? ) ( [eE][-+]?[0-9]+ )?
bool has_float_form(std::string_view text) {
  text = without_sign(text);
  const std::size_t whole = leading_digits(text);
  text.remove_prefix(whole);
  if (text.starts_with('.')) {
    text.remove_prefix(1);
    const std::size_t fraction = leading_digits(text);
    if (whole + fraction == 0) return false;
    text.remove_prefix(fraction);
  } else if (whole == 0) {
    return false;
  }
  if (text.empty()) return true;
  return (text.front() == 'e' || text.front() == 'E') && all_digits(without_sign(text.substr(1)));
}

std::optional<Value> special_float(std::string_view text) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if (text == ".nan" || text == ".NaN" || text == ".NAN") return std::numeric_limits<double>::quiet_NaN();
  const std::string_view rest = without_sign(text);
  if (rest != ".inf" && rest != ".Inf" && rest != ".INF") return std::nullopt;
  return text.starts_with('-') ? -kInfinity : kInfinity;
}

std::optional<Value> prefixed_integer(std::string_view text) {
  if (text.size() < 3 || text.front() != '0' || text[2] == '-') return std::nullopt;
  const int base = text[1] == 'x' ? 16 : text[1] == 'o' ? 8 : 0;
  if (base == 0) return std::nullopt;
  if (const auto number = convert<std::uint64_t>(text.substr(2), base)) return Value(*number);
  return std::nullopt;
}

// A number that a double cannot hold (1e999) stays text.
std::optional<Value> number(std::string_view text) {
  if (auto integer = prefixed_integer(text)) return integer;
  if (all_digits(without_sign(text))) {
    if (const auto integer = convert<std::int64_t>(without_plus(text))) return Value(*integer);
    if (const auto integer = convert<std::uint64_t>(without_plus(text))) return Value(*integer);
  }
  if (has_float_form(text)) {
    if (const auto real = convert<double>(without_plus(text))) return Value(*real);
    return std::nullopt;
  }
  return special_float(text);
}

std::optional<Value> literal(std::string_view text) {
  if (text.empty() || text == "~" || text == "null" || text == "Null" || text == "NULL") return Value();
  if (text == "true" || text == "True" || text == "TRUE") return Value(true);
  if (text == "false" || text == "False" || text == "FALSE") return Value(false);
  if (is_digit(text.front()) || text.front() == '-' || text.front() == '+' || text.front() == '.') {
    return number(text);
  }
  return std::nullopt;
}

struct Utf8Lead {
  std::size_t length = 0;  // of the whole sequence; 0: no lead byte
  unsigned char low = 0x80;
  unsigned char high = 0xBF;  // range of the second byte
};

// Unicode 15, table 3-7.
Utf8Lead utf8_lead(unsigned char byte) {
  if (byte < 0x80) return {1};
  if (byte < 0xC2 || byte > 0xF4) return {};
  if (byte < 0xE0) return {2};
  if (byte == 0xE0) return {3, 0xA0};
  if (byte == 0xED) return {3, 0x80, 0x9F};
  if (byte < 0xF0) return {3};
  if (byte == 0xF0) return {4, 0x90};
  if (byte == 0xF4) return {4, 0x80, 0x8F};
  return {4};
}

// Bytes of the well-formed sequence at the begin of `text`; 0 where there is none.
std::size_t utf8_sequence(std::string_view text) {
  const Utf8Lead lead = utf8_lead(static_cast<unsigned char>(text.front()));
  if (lead.length > text.size()) return 0;
  for (std::size_t i = 1; i < lead.length; ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const unsigned char low = i == 1 ? lead.low : 0x80;
    const unsigned char high = i == 1 ? lead.high : 0xBF;
    if (byte < low || byte > high) return 0;
  }
  return lead.length;
}

}  // namespace

Value resolve_plain(std::string_view text) {
  auto value = literal(text);
  if (!value) return text;
  if (print_scalar(*value) != text) value->set_source_text(std::string(text));
  return *std::move(value);
}

std::string print_float(double number) {
  if (std::isnan(number)) return ".nan";
  if (std::isinf(number)) return number < 0 ? "-.inf" : ".inf";
  std::array<char, 40> buffer{};
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), number);
  std::string text(buffer.data(), result.ptr);
  if (text.find('.') != std::string::npos) return text;
  // YAML 1.1 readers want the point in 1.0e+20, too.
  text.insert(std::min(text.find('e'), text.size()), ".0");
  return text;
}

std::string print_scalar(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::Bool:
      return value.as_bool() ? "true" : "false";
    case Value::Kind::Int:
      return std::to_string(value.as_int());
    case Value::Kind::UInt:
      return std::to_string(value.as_uint());
    case Value::Kind::Float:
      return print_float(value.as_double());
    default:
      return "null";
  }
}

std::string valid_utf8(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = utf8_sequence(text);
    result += length == 0 ? std::string_view("\xEF\xBF\xBD") : text.substr(0, length);
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

}  // namespace segue::type::detail
