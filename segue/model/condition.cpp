// SPDX-License-Identifier: Apache-2.0
#include <segue/model/condition.hpp>

#include <segue/base/text.hpp>
#include <segue/base/trimmed.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <charconv>
#include <optional>

namespace segue::model {

using type::Value;

namespace {

constexpr std::string_view kAnd = " and ";
constexpr std::string_view kWholeSample = "value";

Error malformed(std::string_view text) {
  return fail(ErrorCode::ParseError,
              quote(text) +
                  " is not a valid condition: expected comparisons of fields of a sample such as "
                  "'code == 3 and path[0].x < 1.5', or of 'value', the sample itself");
}

/// Names of fields do not begin with digits.
bool is_index(std::string_view part) {
  return !part.empty() && std::ranges::all_of(part, [](char c) { return c >= '0' && c <= '9'; });
}

/// "markers[1]" as "markers" and "1". False: it is not a field with elements of lists.
bool append_part(std::string_view text, std::vector<std::string>& parts) {
  const auto bracket = std::min(text.find('['), text.size());
  parts.emplace_back(text.substr(0, bracket));
  if (!is_identifier(parts.back())) return false;
  text.remove_prefix(bracket);
  while (!text.empty()) {
    const auto end = text.find(']');
    if (!text.starts_with('[') || end == std::string_view::npos) return false;
    parts.emplace_back(text.substr(1, end - 1));
    if (!is_index(parts.back())) return false;
    text.remove_prefix(end + 1);
  }
  return true;
}

/// Null where the value is no list or has no such element.
const Value* element(const Value& list, std::string_view index) {
  std::size_t place = 0;
  const auto [end, problem] = std::from_chars(index.data(), index.data() + index.size(), place);
  const bool exists = problem == std::errc() && list.is_list() && place < list.as_list().size();
  return exists ? &list.as_list()[place] : nullptr;
}

std::optional<Comparison> parse_comparison(std::string_view text) {
  const auto place = text.find_first_of("=!<>");
  if (place == std::string_view::npos) return std::nullopt;
  for (std::size_t i = 0; i < kComparatorSigns.size(); ++i) {
    if (!text.substr(place).starts_with(kComparatorSigns[i])) continue;
    auto field = parse_field(trimmed(text.substr(0, place)));
    const auto constant = trimmed(text.substr(place + kComparatorSigns[i].size()));
    auto value = type::parse_yaml(constant);
    const bool is_quoted = constant.starts_with('"') || constant.starts_with('\'');
    const bool is_word = !constant.empty() && constant.find(' ') == std::string_view::npos;
    const bool is_constant = (is_quoted || is_word) && value && !value->is_list() && !value->is_map();
    if (!field || !is_constant) return std::nullopt;
    return Comparison{std::move(*field), static_cast<Comparator>(i), std::move(*value)};
  }
  return std::nullopt;
}

bool compares(Comparator comparator, const Value& a, const Value& b) {
  if (comparator == Comparator::Equal) return a == b;
  if (comparator == Comparator::NotEqual) return !(a == b);
  if (!a.is_number() || !b.is_number()) return false;
  const double left = a.as_double();
  const double right = b.as_double();
  switch (comparator) {
    case Comparator::AtMost:
      return left <= right;
    case Comparator::AtLeast:
      return left >= right;
    case Comparator::Less:
      return left < right;
    default:
      return left > right;
  }
}

bool holds(const Comparison& comparison, const Value& sample) {
  const Value* value = find_field(sample, comparison.field);
  return value != nullptr && compares(comparison.comparator, *value, comparison.value);
}

}  // namespace

std::optional<std::vector<std::string>> parse_field(std::string_view text) {
  std::vector<std::string> parts;
  if (text == kWholeSample) return parts;
  while (true) {
    const auto dot = std::min(text.find('.'), text.size());
    if (!append_part(text.substr(0, dot), parts)) return std::nullopt;
    if (dot == text.size()) return parts;
    text.remove_prefix(dot + 1);
  }
}

std::string field_text(const std::vector<std::string>& field) {
  std::string text;
  for (const std::string& part : field) {
    if (is_index(part)) {
      text += "[" + part + "]";
    } else {
      text += (text.empty() ? "" : ".") + part;
    }
  }
  return text.empty() ? std::string(kWholeSample) : text;
}

const Value* find_field(const Value& sample, const std::vector<std::string>& field) {
  const Value* value = &sample;
  for (const std::string& part : field) {
    value = is_index(part) ? element(*value, part) : value->find(part);
    if (value == nullptr) break;
  }
  return value;
}

Result<Condition> parse_condition(std::string_view text) {
  Condition condition{std::string(text), {}};
  std::string_view left = text;
  while (true) {
    const auto end = std::min(left.find(kAnd), left.size());
    auto comparison = parse_comparison(left.substr(0, end));
    if (!comparison) return malformed(text);
    condition.all.push_back(std::move(*comparison));
    if (end == left.size()) return condition;
    left.remove_prefix(end + kAnd.size());
  }
}

bool holds(const Condition& condition, const Value& sample) {
  return std::ranges::all_of(condition.all,
                             [&](const Comparison& comparison) { return holds(comparison, sample); });
}

}  // namespace segue::model
