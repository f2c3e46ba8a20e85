// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/error.hpp>
#include <segue/mission/action.hpp>

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace segue::mission {

/// The predicates, objects and their types that facts may consist of: what Brunner et al. 2019 take from an
/// ontology, in the words of PDDL. Without predicates every fact is permitted.
struct FactVocabulary {
  /// Types of arguments that need no declaration: any object, a number, true or false, any text.
  static constexpr std::array<std::string_view, 4> kBuiltIn = {"object", "number", "boolean", "text"};

  /// A type of objects.
  struct Type {
    std::string name;
    std::string parent;  ///< a declared type, or "object"
    SourcePlace where;
    friend bool operator==(const Type&, const Type&) = default;
  };
  /// An object that facts may name.
  struct Object {
    std::string name;
    std::string type;
    SourcePlace where;
    friend bool operator==(const Object&, const Object&) = default;
  };
  /// A predicate with the types of its arguments.
  struct Predicate {
    std::string name;
    std::vector<std::string> arguments;  ///< types
    SourcePlace where;
    friend bool operator==(const Predicate&, const Predicate&) = default;
  };
  std::vector<Type> types;
  std::vector<Object> objects;
  std::vector<Predicate> predicates;
  friend bool operator==(const FactVocabulary&, const FactVocabulary&) = default;

  /// Whether a value of type `inner` is one of type `outer`.
  [[nodiscard]] bool is_a(std::string_view inner, std::string_view outer) const;
  /// Why the fact does not fit the vocabulary, as the end of a sentence that begins with the fact; nothing if
  /// it fits. Arguments that are inputs ("{place}") fit.
  [[nodiscard]] std::optional<std::string> problem(std::string_view predicate,
                                                   std::span<const std::string> arguments) const;

 private:
  [[nodiscard]] std::optional<std::string> argument_problem(const std::string& argument,
                                                            const std::string& type) const;
};

}  // namespace segue::mission
