// SPDX-License-Identifier: Apache-2.0
#include <segue/model/condition.hpp>

#include <segue/base/text.hpp>
#include <segue/base/trimmed.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
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
                  "'code == 3 and pose.x < 1.5', or of 'value', the sample itself");
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
    const std::string part(text.substr(0, dot));
    if (!is_identifier(part)) return std::nullopt;
    parts.push_back(part);
    if (dot == text.size()) return parts;
    text.remove_prefix(dot + 1);
  }
}

const Value* find_field(const Value& sample, const std::vector<std::string>& field) {
  const Value* value = &sample;
  for (const std::string& part : field) {
    value = value->find(part);
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
