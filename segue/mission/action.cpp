// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/base/trimmed.hpp>
#include <segue/mission/action.hpp>

#include <algorithm>

namespace segue::mission {

using type::Value;

namespace {

bool is_argument(std::string_view text) {
  const bool placeholder = text.size() > 2 && text.front() == '{' && text.back() == '}';
  return is_fact_argument(placeholder ? text.substr(1, text.size() - 2) : text);
}

bool parse_arguments(std::string_view text, std::vector<std::string>& arguments) {
  if (trimmed(text).empty()) return true;
  while (true) {
    const auto comma = text.find(',');
    const std::string_view argument = trimmed(text.substr(0, comma));
    if (!is_argument(argument)) return false;
    arguments.emplace_back(argument);
    if (comma == std::string_view::npos) return true;
    text.remove_prefix(comma + 1);
  }
}

}  // namespace

bool is_fact_argument(std::string_view text) {
  return !text.empty() && trimmed(text) == text && std::ranges::none_of(text, [](char c) {
    return static_cast<unsigned char>(c) < 0x20 ||
           std::string_view(",(){}").find(c) != std::string_view::npos;
  });
}

std::string to_string(const Fact& fact) {
  std::string text = fact.predicate;
  for (std::size_t i = 0; i < fact.arguments.size(); ++i)
    text += (i == 0 ? "(" : ",") + fact.arguments[i];
  return fact.arguments.empty() ? text : text + ")";
}

std::optional<Fact> parse_fact(std::string_view text, std::string_view signs) {
  Fact fact;
  text = trimmed(text);
  if (!text.empty() && signs.find(text.front()) != std::string_view::npos) {
    fact.positive = text.front() == '+';
    text = trimmed(text.substr(1));
  }
  const auto open = text.find('(');
  fact.predicate = trimmed(text.substr(0, open));
  if (!is_identifier(fact.predicate)) return std::nullopt;
  if (open == std::string_view::npos) return fact;
  if (text.back() != ')') return std::nullopt;
  if (!parse_arguments(text.substr(open + 1, text.size() - open - 2), fact.arguments)) return std::nullopt;
  return fact;
}

std::vector<std::string> placeholders(std::string_view text) {
  std::vector<std::string> names;
  for (auto open = text.find('{'); open != std::string_view::npos; open = text.find('{', open + 1)) {
    const auto close = text.find('}', open);
    if (close == std::string_view::npos) break;
    names.emplace_back(text.substr(open + 1, close - open - 1));
  }
  return names;
}

std::optional<std::string> parameter_input(const type::Value& parameter) {
  if (!parameter.is_string()) return std::nullopt;
  const std::string& text = parameter.as_string();
  if (text.size() < 3 || text.front() != '{' || text.find('}') != text.size() - 1) return std::nullopt;
  return text.substr(1, text.size() - 2);
}

std::vector<std::string> inputs_named_in(const Value& value) {
  std::vector<std::string> names;
  const auto add_all = [&](const Value& item) {
    for (std::string& name : inputs_named_in(item))
      names.push_back(std::move(name));
  };
  if (auto name = parameter_input(value)) names.push_back(std::move(*name));
  if (value.is_list()) std::ranges::for_each(value.as_list(), add_all);
  if (value.is_map()) {
    for (const auto& [key, item] : value.as_map())
      add_all(item);
  }
  return names;
}

Value filled(const Value& value, const std::function<const Value&(std::string_view port)>& value_of) {
  if (const auto name = parameter_input(value)) return value_of(*name);
  if (value.is_list()) {
    Value::List list;
    for (const Value& item : value.as_list())
      list.push_back(filled(item, value_of));
    return list;
  }
  if (!value.is_map()) return value;
  type::ValueMap map;
  for (const auto& [key, item] : value.as_map())
    map.append(key, filled(item, value_of));
  return map;
}

}  // namespace segue::mission
