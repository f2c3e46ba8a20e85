// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/base/unknown_key.hpp>
#include <segue/model/reader.hpp>
#include <segue/type/json.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <utility>

namespace segue::model::detail {

using type::Value;

SourceLocation Source::at(const Value& value) const {
  return {file_, static_cast<int>(value.mark().line), static_cast<int>(value.mark().column)};
}

void Source::error(std::string code, std::string message, const Value& value) const {
  diagnostics_.error(std::move(code), std::move(message), at(value));
}

void Source::warning(std::string code, std::string message, const Value& value) const {
  diagnostics_.warning(std::move(code), std::move(message), at(value));
}

std::optional<Value> Source::parse(std::string_view text) const {
  auto parsed = type::parse_yaml(text, file_);
  if (parsed) return std::move(*parsed);
  // JSON is not quite a subset of YAML; the JSON output of our tools must be readable whatever its strings.
  const auto first = text.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && text[first] == '{') {
    if (auto json = type::parse_json(text, file_)) return std::move(*json);
  }
  const Error& error = parsed.error();
  SourceLocation where = error.where;
  if (where.file.empty()) where.file = file_;
  diagnostics_.error("parse-error", error.message, std::move(where));
  return std::nullopt;
}

std::optional<std::string> read_text(const std::filesystem::path& file, Diagnostics& diagnostics) {
  auto text = read_input_file(file);
  if (text) return std::move(*text);
  diagnostics.error("unreadable-file", text.error().message, {file.string(), 0, 0});
  return std::nullopt;
}

std::optional<std::string> scalar_text(const Value& value) {
  if (!value.source_text().empty()) return std::string(value.source_text());
  if (value.is_string()) return value.as_string();
  if (value.is_bool() || value.is_number()) return type::describe(value);
  return std::nullopt;
}

Fields::Fields(const Value& value, std::string what, const Source& source)
    : value_(value), what_(std::move(what)), source_(source) {
  if (value.is_map()) {
    map_ = &value.as_map();
  } else if (!value.is_null()) {
    source_.error("wrong-kind", what_ + ": expected a map, got " + type::describe(value), value);
  }
}

const Value* Fields::find(std::string_view key) {
  known_.push_back(key);
  const Value* value = map_ == nullptr ? nullptr : map_->find(key);
  return value == nullptr || value->is_null() ? nullptr : value;
}

const Value* Fields::require(std::string_view key, std::string_view hint) {
  const Value* value = find(key);
  if (value == nullptr && (is_map() || value_.is_null())) {
    source_.error("missing-key",
                  what_ + " lacks " + quote(key) + (hint.empty() ? "" : ": " + std::string(hint)), value_);
  }
  return value;
}

void Fields::wrong_kind(std::string_view key, std::string_view wanted, const Value& value) {
  source_.error(
      "wrong-kind",
      what_ + ": " + quote(key) + " must be " + std::string(wanted) + ", got " + type::describe(value),
      value);
}

const Value* Fields::find(std::string_view key, Value::Kind kind) {
  const Value* value = find(key);
  if (value == nullptr || value->kind() == kind) return value;
  wrong_kind(key, type::describe(kind), *value);
  return nullptr;
}

const Value::List& Fields::entries(std::string_view key) {
  static const Value::List none;
  const Value* list = find(key, Value::Kind::List);
  return list == nullptr ? none : list->as_list();
}

std::string Fields::text(std::string_view key) {
  const Value* value = find(key);
  if (value == nullptr) return {};
  if (auto text = scalar_text(*value)) return *text;
  wrong_kind(key, "text", *value);
  return {};
}

std::string Fields::name(std::string_view key) {
  const Value* value = find(key);
  if (value == nullptr) return {};
  if (!value->is_string() && !value->is_integer()) {
    wrong_kind(key, "a name", *value);
    return {};
  }
  std::string name = scalar_text(*value).value_or("");
  return check_name(name, what_ + ": " + quote(key), *value, source_) ? name : std::string{};
}

std::string Fields::required_name(std::string_view key, std::string_view hint) {
  return require(key, hint) == nullptr ? std::string{} : name(key);
}

bool Fields::boolean(std::string_view key, bool fallback) {
  const Value* value = find(key, Value::Kind::Bool);
  return value == nullptr ? fallback : value->as_bool();
}

std::optional<std::int64_t> Fields::integer(std::string_view key, std::int64_t least, std::int64_t most,
                                            std::string_view code) {
  const Value* value = find(key);
  if (value == nullptr) return std::nullopt;
  if (value->kind() == Value::Kind::Int && value->as_int() >= least && value->as_int() <= most) {
    return value->as_int();
  }
  source_.error(std::string(code),
                what_ + ": " + quote(key) + " must be an integer from " + std::to_string(least) + " to " +
                    std::to_string(most) + ", got " + type::describe(*value),
                *value);
  return std::nullopt;
}

std::optional<Duration> Fields::duration(std::string_view key) {
  const Value* value = find(key);
  if (value == nullptr) return std::nullopt;
  auto parsed = parse_duration(scalar_text(*value).value_or(""));
  if (parsed) return *parsed;
  source_.error("bad-duration",
                what_ + ": " + quote(key) + " must be a duration with a unit such as '100ms', got " +
                    type::describe(*value),
                *value);
  return std::nullopt;
}

std::optional<std::uint64_t> Fields::size(std::string_view key, std::string_view code) {
  const Value* value = find(key);
  if (value == nullptr) return std::nullopt;
  auto parsed = parse_size(scalar_text(*value).value_or(""));
  if (parsed) return *parsed;
  source_.error(std::string(code),
                what_ + ": " + quote(key) + " must be a size with a unit such as '512MB', got " +
                    type::describe(*value),
                *value);
  return std::nullopt;
}

std::vector<std::string> Fields::texts(std::string_view key) {
  const Value* value = find(key);
  std::vector<std::string> result;
  if (value == nullptr) return result;
  if (auto single = scalar_text(*value)) return {*single};
  if (!value->is_list()) {
    wrong_kind(key, "a list of texts", *value);
    return result;
  }
  for (const Value& item : value->as_list()) {
    auto text = scalar_text(item);
    if (text) {
      result.push_back(std::move(*text));
    } else {
      wrong_kind(key, "a list of texts", item);
    }
  }
  return result;
}

std::vector<int> Fields::integers(std::string_view key, int least, int most) {
  const Value* value = find(key);
  std::vector<int> result;
  if (value == nullptr) return result;
  const Value::List single = {*value};
  for (const Value& item : value->is_list() ? value->as_list() : single) {
    if (item.kind() == Value::Kind::Int && item.as_int() >= least && item.as_int() <= most) {
      result.push_back(static_cast<int>(item.as_int()));
    } else {
      wrong_kind(key, "whole numbers from " + std::to_string(least) + " to " + std::to_string(most), item);
    }
  }
  return result;
}

std::optional<std::size_t> Fields::choose(const Value& value, std::string_view key,
                                          const std::vector<std::string>& names, std::string_view code) {
  const std::string text = scalar_text(value).value_or("");
  const auto found = std::ranges::find(names, text);
  if (found != names.end()) return static_cast<std::size_t>(found - names.begin());
  source_.error(std::string(code),
                what_ + ": " + quote(key) + " must be one of " + listed(names) + ", got " +
                    type::describe(value) + did_you_mean(text, names),
                value);
  return std::nullopt;
}

void Fields::finish() {
  if (map_ == nullptr) return;
  for (const auto& [key, value] : *map_) {
    if (std::ranges::find(known_, key) != known_.end()) continue;  // nearly all: without a copy of the names
    const auto problem = problem_of_key(key, std::vector<std::string>(known_.begin(), known_.end()));
    if (!problem) continue;
    if (source_.unknown_keys() == UnknownKeys::Refuse) {
      source_.error("unknown-key", what_ + ": " + *problem, value);
    } else {
      source_.warning("unknown-key", what_ + ": the key " + quote(key) + " is not known and ignored", value);
    }
  }
}

bool check_name(std::string_view name, std::string_view what, const Value& at, const Source& source) {
  if (is_identifier(name)) return true;
  source.error("bad-name",
               std::string(what) + ": " + quote(name) + " is not a name: " + std::string(kIdentifierRule),
               at);
  return false;
}

}  // namespace segue::model::detail
