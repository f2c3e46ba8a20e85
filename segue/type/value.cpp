// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/type/value.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>

namespace segue::type {
namespace {

constexpr std::size_t kLinearSearch = 16;  // maps up to this size are compared without an index

bool equal_numbers(const Value& a, const Value& b) {
  if (a.is_integer() && b.is_integer()) {
    return a.kind() == b.kind() &&
           (a.kind() == Value::Kind::Int ? a.as_int() == b.as_int() : a.as_uint() == b.as_uint());
  }
  const double x = a.as_double();
  const double y = b.as_double();
  return x == y || (std::isnan(x) && std::isnan(y));
}

}  // namespace

Value::Value() = default;
Value::Value(bool boolean) : storage_(boolean) {}
Value::Value(int integer) : storage_(static_cast<std::int64_t>(integer)) {}
Value::Value(std::int64_t integer) : storage_(integer) {}
Value::Value(std::uint64_t integer) {
  if (integer <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max())) {
    storage_ = static_cast<std::int64_t>(integer);
  } else {
    storage_ = integer;
  }
}
Value::Value(double number) : storage_(number) {}
Value::Value(std::string text) : storage_(std::move(text)) {}
Value::Value(std::string_view text) : storage_(std::string(text)) {}
Value::Value(const char* text) : storage_(std::string(text)) {}
Value::Value(List list) : storage_(std::move(list)) {}
Value::Value(ValueMap map) : storage_(std::make_unique<ValueMap>(std::move(map))) {}
Value::Value(Value&& other) noexcept = default;
Value& Value::operator=(Value&& other) noexcept = default;
Value::~Value() = default;

Value::Value(const Value& other) : mark_(other.mark_) {
  if (other.source_text_) source_text_ = std::make_unique<std::string>(*other.source_text_);
  std::visit(
      [this](const auto& content) {
        if constexpr (requires {
                        *content;
                        content.get();
                      }) {
          storage_ = std::make_unique<ValueMap>(*content);
        } else {
          storage_ = content;
        }
      },
      other.storage_);
}

Value& Value::operator=(const Value& other) {
  if (this != &other) *this = Value(other);
  return *this;
}

Value Value::map(std::initializer_list<std::pair<std::string, Value>> entries) {
  ValueMap map;
  for (const auto& [key, value] : entries)
    map.set(key, value);
  return map;
}

Value Value::list(std::initializer_list<Value> items) {
  return List(items);
}

Value::Kind Value::kind() const {
  return static_cast<Kind>(storage_.index());
}

bool Value::as_bool() const {
  assert(is_bool());
  return std::get<bool>(storage_);
}

std::int64_t Value::as_int() const {
  assert(kind() == Kind::Int);
  return std::get<std::int64_t>(storage_);
}

std::uint64_t Value::as_uint() const {
  assert(is_integer());
  return kind() == Kind::Int ? static_cast<std::uint64_t>(as_int()) : std::get<std::uint64_t>(storage_);
}

double Value::as_double() const {
  assert(is_number());
  if (kind() == Kind::Int) return static_cast<double>(as_int());
  return kind() == Kind::UInt ? static_cast<double>(as_uint()) : std::get<double>(storage_);
}

const std::string& Value::as_string() const {
  return std::get<std::string>(storage_);
}
const Value::List& Value::as_list() const {
  return std::get<List>(storage_);
}
Value::List& Value::as_list() {
  return std::get<List>(storage_);
}
const ValueMap& Value::as_map() const {
  return *std::get<std::unique_ptr<ValueMap>>(storage_);
}
ValueMap& Value::as_map() {
  return *std::get<std::unique_ptr<ValueMap>>(storage_);
}

const Value* Value::find(std::string_view key) const {
  return is_map() ? as_map().find(key) : nullptr;
}

bool operator==(const Value& a, const Value& b) {
  if (a.is_number() && b.is_number()) return equal_numbers(a, b);
  if (a.kind() != b.kind()) return false;
  if (a.is_map()) return a.as_map() == b.as_map();
  if (a.is_list()) return a.as_list() == b.as_list();
  if (a.is_string()) return a.as_string() == b.as_string();
  return a.is_null() || a.as_bool() == b.as_bool();
}

std::string_view Value::source_text() const {
  return source_text_ ? std::string_view(*source_text_) : std::string_view();
}

void Value::set_source_text(std::string text) {
  source_text_ = text.empty() ? nullptr : std::make_unique<std::string>(std::move(text));
}

Value& ValueMap::append(std::string key, Value value) {
  return entries_.emplace_back(std::move(key), std::move(value)).second;
}

Value& ValueMap::set(std::string key, Value value) {
  if (Value* existing = find(key)) return *existing = std::move(value);
  return append(std::move(key), std::move(value));
}

Value& ValueMap::operator[](std::string_view key) {
  if (Value* existing = find(key)) return *existing;
  return append(std::string(key), Value());
}

const Value* ValueMap::find(std::string_view key) const {
  const auto entry = std::ranges::find(entries_, key, &Entry::first);
  return entry == entries_.end() ? nullptr : &entry->second;
}

Value* ValueMap::find(std::string_view key) {
  const auto entry = std::ranges::find(entries_, key, &Entry::first);
  return entry == entries_.end() ? nullptr : &entry->second;
}

bool ValueMap::erase(std::string_view key) {
  return std::erase_if(entries_, [&](const Entry& entry) { return entry.first == key; }) > 0;
}

bool operator==(const ValueMap& a, const ValueMap& b) {
  if (a.size() != b.size()) return false;
  if (a.size() <= kLinearSearch) {
    return std::ranges::all_of(a, [&](const ValueMap::Entry& entry) {
      const Value* other = b.find(entry.first);
      return other != nullptr && *other == entry.second;
    });
  }
  std::unordered_map<std::string_view, const Value*> index;
  for (const auto& [key, value] : b)
    index.emplace(key, &value);
  return std::ranges::all_of(a, [&](const ValueMap::Entry& entry) {
    const auto other = index.find(entry.first);
    return other != index.end() && *other->second == entry.second;
  });
}

std::string_view describe(Value::Kind kind) {
  static constexpr std::array<std::string_view, 8> kNames = {"nothing",  "a boolean", "a number", "a number",
                                                             "a number", "text",      "a list",   "a map"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::string describe(const Value& value) {
  switch (value.kind()) {
    case Value::Kind::Null:
      return "nothing";
    case Value::Kind::Bool:
      return value.as_bool() ? "true" : "false";
    case Value::Kind::Int:
      return std::to_string(value.as_int());
    case Value::Kind::UInt:
      return std::to_string(value.as_uint());
    case Value::Kind::String:
      return quote(value.as_string());
    case Value::Kind::List:
      return "a list of " + std::to_string(value.as_list().size());
    case Value::Kind::Map:
      return "a map";
    case Value::Kind::Float:
      break;
  }
  std::array<char, 40> buffer{};
  const auto [end, status] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value.as_double());
  return status == std::errc{} ? std::string(buffer.data(), end) : "a number";
}

void merge(Value& base, const Value& over) {
  if (!base.is_map() || !over.is_map()) {
    base = over;
    return;
  }
  for (const auto& [key, value] : over.as_map())
    merge(base.as_map()[key], value);
}

}  // namespace segue::type
