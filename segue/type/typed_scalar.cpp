// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/scalar_text.hpp>
#include <segue/type/typed_scalar.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace segue::type::detail {
namespace {

constexpr int kLongestChain = 64;  // of aliases and opaques; a longer one must be a cycle
constexpr std::size_t kListedSymbols = 12;

Error unexpected(std::string expected, const Value& value) {
  return fail(ErrorCode::TypeMismatch, "expected " + std::move(expected) + ", got " + describe(value));
}

struct Range {
  std::int64_t lowest = 0;
  std::uint64_t highest = 0;

  [[nodiscard]] bool has(const Value& integer) const {
    if (integer.kind() == Value::Kind::Int && integer.as_int() < 0) return integer.as_int() >= lowest;
    return integer.as_uint() <= highest;
  }
  [[nodiscard]] std::string text() const {
    return "an integer from " + std::to_string(lowest) + " to " + std::to_string(highest);
  }
};

Range range_of(const Type& type) {
  const std::size_t bits = 8 * std::clamp<std::size_t>(type.size, 1, 8);
  const std::uint64_t all = ~std::uint64_t{0} >> (64 - bits);
  if (type.category == NumericCategory::Unsigned) return {0, all};
  return {-static_cast<std::int64_t>(all >> 1U) - 1, all >> 1U};
}

// 1e3 and JSON's 10.0 are whole numbers, too.
std::optional<Value> as_whole(const Value& value) {
  if (value.is_integer()) return value;
  if (value.kind() != Value::Kind::Float) return std::nullopt;
  const double number = value.as_double();
  if (number != std::trunc(number)) return std::nullopt;
  if (number >= -0x1p63 && number < 0x1p63) return Value(static_cast<std::int64_t>(number));
  if (number >= 0 && number < 0x1p64) return Value(static_cast<std::uint64_t>(number));
  return std::nullopt;
}

std::string expected_duration(const Type& type) {
  return "a duration such as '100ms', or a number of ticks of " +
         format_duration(Duration(type.nanoseconds_per_tick));
}

// The number of ticks of a duration's text.
Result<Value> ticks_for(const Value& value, const Type& type) {
  const auto duration = parse_duration(value.as_string());
  if (!duration) return unexpected(expected_duration(type), value);
  const std::int64_t count = duration->count();
  if (type.category == NumericCategory::Float) {
    return Value(static_cast<double>(count) / static_cast<double>(type.nanoseconds_per_tick));
  }
  if (count % type.nanoseconds_per_tick != 0) {
    return unexpected("a multiple of " + format_duration(Duration(type.nanoseconds_per_tick)), value);
  }
  return Value(count / type.nanoseconds_per_tick);
}

bool is_duration_text(const Value& value, const Type& type) {
  return value.is_string() && type.nanoseconds_per_tick > 0;
}

std::string known_symbols(const Type& type) {
  std::vector<std::string> names;
  for (const EnumSymbol& symbol : type.symbols) {
    if (names.size() == kListedSymbols) {
      names.emplace_back("others");
      break;
    }
    names.push_back(symbol.name);
  }
  return names.empty() ? std::string("a symbol of " + type.name) : "one of " + listed(names);
}

Error unknown_symbol(const Value& value, std::string_view name, const Type& type) {
  std::vector<std::string> names;
  for (const EnumSymbol& symbol : type.symbols)
    names.push_back(symbol.name);
  Error error = unexpected(known_symbols(type), value);
  error.message += did_you_mean(name, names);
  return error;
}

}  // namespace

const Type* layout_of(const Type& type) {
  const Type* layout = &type;
  for (int step = 0; step < kLongestChain && layout != nullptr; ++step) {
    if (layout->kind == TypeKind::Null || layout->kind == TypeKind::Pointer) return nullptr;
    if (layout->kind != TypeKind::Alias && layout->kind != TypeKind::Opaque) return layout;
    layout = layout->element;
  }
  return nullptr;
}

Result<std::uint64_t> integer_for(const Value& value, const Type& type) {
  if (is_duration_text(value, type)) {
    const auto ticks = ticks_for(value, type);
    if (!ticks) return ticks.error();
    if (!range_of(type).has(*ticks)) return unexpected(range_of(type).text() + " ticks", value);
    return ticks->as_uint();
  }
  if (!value.is_number()) {
    return unexpected(type.nanoseconds_per_tick > 0 ? expected_duration(type) : "a number", value);
  }
  const auto whole = as_whole(value);
  if (!whole || !range_of(type).has(*whole)) return unexpected(range_of(type).text(), value);
  return whole->as_uint();
}

Result<double> float_for(const Value& value, const Type& type) {
  if (is_duration_text(value, type)) {
    const auto ticks = ticks_for(value, type);
    if (!ticks) return ticks.error();
    return ticks->as_double();
  }
  if (!value.is_number()) {
    return unexpected(type.nanoseconds_per_tick > 0 ? expected_duration(type) : "a number", value);
  }
  const double number = value.as_double();
  if (type.size == sizeof(float) && std::isfinite(number) &&
      std::abs(number) > static_cast<double>(std::numeric_limits<float>::max())) {
    return unexpected("a number that a 32-bit float can hold", value);
  }
  return number;
}

Result<bool> boolean_for(const Value& value) {
  if (!value.is_bool()) return unexpected("true or false", value);
  return value.as_bool();
}

Result<std::string> text_for(const Value& value) {
  if (value.is_string()) return value.as_string();
  if (!value.is_number() && !value.is_bool()) return unexpected("text", value);
  const auto source = value.source_text();
  return source.empty() ? print_scalar(value) : std::string(source);
}

Result<std::int64_t> symbol_for(const Value& value, const Type& type) {
  if (value.is_string()) {
    std::string_view name = value.as_string();
    if (name.starts_with(':')) name.remove_prefix(1);
    const auto symbol = std::ranges::find(type.symbols, name, &EnumSymbol::name);
    if (symbol == type.symbols.end()) return unknown_symbol(value, name, type);
    return symbol->value;
  }
  if (value.kind() != Value::Kind::Int) return unexpected(known_symbols(type), value);
  const auto symbol = std::ranges::find(type.symbols, value.as_int(), &EnumSymbol::value);
  if (symbol == type.symbols.end()) return unexpected(known_symbols(type), value);
  return symbol->value;
}

const Value::List* items_for(const Value& value, const Type& element) {
  if (value.is_list()) return &value.as_list();
  if (!value.is_map() || value.as_map().size() != 1) return nullptr;
  const Value* data = value.find("data");
  const Type* layout = layout_of(element);
  const bool of_numbers = layout != nullptr && layout->kind == TypeKind::Numeric;
  return data != nullptr && data->is_list() && of_numbers ? &data->as_list() : nullptr;
}

}  // namespace segue::type::detail
