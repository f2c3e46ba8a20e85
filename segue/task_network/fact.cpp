// SPDX-License-Identifier: Apache-2.0
#include "fact.hpp"

#include <segue/base/text.hpp>
#include <segue/base/trimmed.hpp>

#include <algorithm>

namespace segue::task_network {

namespace {

constexpr std::string_view kBlanks = " \t\r\n";

std::string_view without_blanks(std::string_view text) {
  return trimmed(text, kBlanks);
}

bool is_word(std::string_view text) {
  return !text.empty() && text.find_first_of("(),!") == std::string_view::npos &&
         text.find_first_of(kBlanks) == std::string_view::npos;
}

/// Names of things may consist of several words.
bool is_argument(std::string_view text) {
  return !text.empty() && without_blanks(text) == text &&
         text.find_first_of("(),\r\n") == std::string_view::npos;
}

std::string fact_text(std::string_view predicate, std::span<const std::string> arguments) {
  std::string text(predicate);
  text += '(';
  for (const std::string& argument : arguments) {
    if (text.back() != '(') text += ',';
    text += argument;
  }
  return text + ')';
}

struct ParsedFact {
  std::string predicate;
  std::vector<std::string> arguments;
};

Error malformed(std::string_view text) {
  return fail(ErrorCode::ParseError, quote(text) + " is not a fact; expected text like on(box1,table)");
}

Result<ParsedFact> parse(std::string_view text, bool (*fits)(std::string_view) = is_word) {
  const std::string_view whole = without_blanks(text);
  const auto open = whole.find('(');
  ParsedFact fact{std::string(without_blanks(whole.substr(0, open))), {}};
  if (!is_word(fact.predicate)) return malformed(text);
  if (open == std::string_view::npos) return fact;
  if (whole.back() != ')') return malformed(text);
  std::string_view rest = without_blanks(whole.substr(open + 1, whole.size() - open - 2));
  if (rest.empty()) return fact;
  for (;;) {
    const auto comma = rest.find(',');
    const std::string_view argument = without_blanks(rest.substr(0, comma));
    if (!fits(argument)) return malformed(text);
    fact.arguments.emplace_back(argument);
    if (comma == std::string_view::npos) return fact;
    rest.remove_prefix(comma + 1);
  }
}

}  // namespace

FactTable::FactTable() {
  types_.intern(kObject);
  parents_.push_back(0);
}

bool FactTable::below(std::uint32_t type, std::uint32_t above) const {
  while (type != above && type != parents_[type])
    type = parents_[type];
  return type == above;
}

Result<void> FactTable::declare_type(std::string_view name, std::string_view parent) {
  const std::uint32_t above = types_.intern(parent);
  if (above == parents_.size()) parents_.push_back(0);
  const std::uint32_t type = types_.intern(name);
  if (type == parents_.size()) {
    parents_.push_back(above);
    return {};
  }
  if (parents_[type] == above) return {};
  if (below(above, type)) {
    return fail(ErrorCode::InvalidArgument, "type " + quote(name) + " would be above itself");
  }
  if (parents_[type] != 0)
    return fail(ErrorCode::AlreadyExists, "type " + quote(name) + " has another parent");
  parents_[type] = above;
  return {};
}

Result<void> FactTable::declare_constant(std::string_view name, std::span<const std::string> types) {
  std::vector<std::uint32_t> numbers;
  for (const std::string& type : types) {
    const auto number = types_.find(type);
    if (!number) return fail(ErrorCode::NotFound, "no type " + quote(type) + " for constant " + quote(name));
    numbers.push_back(*number);
  }
  if (constants_.find(name)) return fail(ErrorCode::AlreadyExists, "a second constant " + quote(name));
  constants_.intern(name);
  constant_types_.push_back(std::move(numbers));
  return {};
}

Result<void> FactTable::declare_predicate(std::string_view name,
                                          std::vector<std::vector<std::string>> parameters) {
  for (const auto& types : parameters) {
    for (const std::string& type : types) {
      if (!types_.find(type)) {
        return fail(ErrorCode::NotFound, "no type " + quote(type) + " for predicate " + quote(name));
      }
    }
  }
  const std::uint32_t number = predicate_names_.intern(name);
  if (number == predicates_.size()) predicates_.emplace_back();
  Predicate& predicate = predicates_[number];
  if (predicate.declared) return fail(ErrorCode::AlreadyExists, "a second predicate " + quote(name));
  predicate = {true, std::move(parameters)};
  return {};
}

bool FactTable::has_predicate(std::string_view name) const {
  const auto number = predicate_names_.find(name);
  return number && predicates_[*number].declared;
}

bool FactTable::is_a(std::string_view constant, std::span<const std::string> types) const {
  const auto number = constants_.find(constant);
  if (!number) return false;
  return std::ranges::any_of(constant_types_[*number], [&](std::uint32_t type) {
    return std::ranges::any_of(types, [&](const std::string& wanted) {
      const auto above = types_.find(wanted);
      return above && below(type, *above);
    });
  });
}

Result<void> FactTable::check(std::string_view predicate, std::span<const std::string> arguments) const {
  const auto number = predicate_names_.find(predicate);
  if (!number || !predicates_[*number].declared) return {};
  const auto& parameters = predicates_[*number].parameters;
  const std::string text = fact_text(predicate, arguments);
  if (parameters.size() != arguments.size()) {
    return fail(ErrorCode::TypeMismatch, quote(text) + " has " + std::to_string(arguments.size()) +
                                             " arguments; the predicate takes " +
                                             std::to_string(parameters.size()));
  }
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (!constants_.find(arguments[i])) {
      return fail(ErrorCode::NotFound, quote(text) + ": no constant " + quote(arguments[i]));
    }
    if (!is_a(arguments[i], parameters[i])) {
      return fail(ErrorCode::TypeMismatch,
                  quote(text) + ": " + quote(arguments[i]) + " is not of type " + listed(parameters[i]));
    }
  }
  return {};
}

Result<FactId> FactTable::intern(std::string_view predicate, std::span<const std::string> arguments) {
  const std::string text = fact_text(predicate, arguments);
  if (const auto known = facts_.find(text)) return FactId{*known};
  if (const auto checked = check(predicate, arguments); !checked) return checked.error();
  return FactId{facts_.intern(text)};
}

Result<FactId> FactTable::intern(std::string_view text) {
  if (const auto known = facts_.find(text)) return FactId{*known};
  const auto fact = parse(text);
  if (!fact) return fact.error();
  return intern(fact->predicate, fact->arguments);
}

Result<FactId> FactTable::intern_named(std::string_view text) {
  if (const auto known = facts_.find(text)) return FactId{*known};
  const auto fact = parse(text, is_argument);
  if (!fact) return fact.error();
  return intern(fact->predicate, fact->arguments);
}

Result<Literal> FactTable::intern_literal(std::string_view text) {
  const std::string_view whole = without_blanks(text);
  const bool value = !whole.starts_with('!');
  const auto fact = intern(value ? whole : whole.substr(1));
  if (!fact) return fact.error();
  return Literal{*fact, value};
}

void FactTable::mark_observed(FactId fact) {
  if (observed_.size() <= index(fact)) observed_.resize(index(fact) + 1);
  observed_[index(fact)] = true;
}

std::optional<FactId> FactTable::find(std::string_view text) const {
  const auto fact = parse(text);
  if (!fact) return std::nullopt;
  const auto number = facts_.find(fact_text(fact->predicate, fact->arguments));
  if (!number) return std::nullopt;
  return FactId{*number};
}

std::string FactTable::text(const Literal& literal) const {
  return (literal.value ? "" : "!") + text(literal.fact);
}

}  // namespace segue::task_network
