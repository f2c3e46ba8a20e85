// SPDX-License-Identifier: Apache-2.0
#include <segue/base/names_of.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/fact_vocabulary.hpp>

#include <algorithm>
#include <charconv>
#include <system_error>

namespace segue::mission {

namespace {

bool is_number(std::string_view text) {
  double number = 0;
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  return status == std::errc{} && end == text.data() + text.size();
}

}  // namespace

bool FactVocabulary::is_a(std::string_view inner, std::string_view outer) const {
  // A type that is its own ancestor, which is an error, ends the search too.
  for (std::size_t steps = 0; steps <= types.size(); ++steps) {
    if (inner == outer) return true;
    const auto type = std::ranges::find(types, inner, &Type::name);
    if (type == types.end()) return false;
    inner = type->parent;
  }
  return false;
}

std::optional<std::string> FactVocabulary::problem(std::string_view predicate,
                                                   std::span<const std::string> arguments) const {
  if (predicates.empty()) return std::nullopt;
  const auto known = std::ranges::find(predicates, predicate, &Predicate::name);
  if (known == predicates.end()) {
    return "has a predicate that 'predicates' does not list" + did_you_mean(predicate, names_of(predicates));
  }
  if (arguments.size() != known->arguments.size()) {
    return "has " + counted(arguments.size(), "argument") + " where " + known->name + " takes " +
           std::to_string(known->arguments.size());
  }
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (auto wrong = argument_problem(arguments[i], known->arguments[i])) return wrong;
  }
  return std::nullopt;
}

std::optional<std::string> FactVocabulary::argument_problem(const std::string& argument,
                                                            const std::string& type) const {
  if (argument.starts_with('{') || type == "text") return std::nullopt;
  const auto is_no = [&](const std::string& kind) {
    return "has the argument " + quote(argument) + ", which is no " + kind;
  };
  if (type == "number") return is_number(argument) ? std::nullopt : std::optional(is_no(type));
  if (type == "boolean")
    return argument == "true" || argument == "false" ? std::nullopt : std::optional(is_no(type));
  const auto object = std::ranges::find(objects, argument, &Object::name);
  if (object == objects.end())
    return is_no("object that 'objects' lists") + did_you_mean(argument, names_of(objects));
  if (is_a(object->type, type)) return std::nullopt;
  return is_no(type) + ", but of type " + object->type;
}

}  // namespace segue::mission
