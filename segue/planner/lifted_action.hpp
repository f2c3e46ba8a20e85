// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/pddl/pddl_task.hpp>

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace segue::planner::detail {

/// A predicate and its arguments, by their numbers.
using Tuple = std::vector<std::uint32_t>;

/// The numbers of predicates and objects.
class Numbers {
 public:
  explicit Numbers(const pddl::detail::PddlTask& task);
  [[nodiscard]] std::uint32_t predicate(const std::string& name) const { return predicates_.at(name); }
  /// Nothing for what is not an object of the problem.
  [[nodiscard]] std::optional<std::uint32_t> object(const std::string& name) const {
    const auto found = objects_.find(name);
    return found == objects_.end() ? std::nullopt : std::optional(found->second);
  }
  [[nodiscard]] std::uint32_t predicate_count() const {
    return static_cast<std::uint32_t>(predicates_.size());
  }
  /// The numbers of "at(a,b)".
  [[nodiscard]] Tuple fact(std::string_view text) const;

 private:
  std::map<std::string, std::uint32_t> predicates_;
  std::map<std::string, std::uint32_t> objects_;
};

/// An argument: a variable of the action, or an object.
struct Argument {
  bool is_variable = false;
  std::uint32_t number = 0;
};
struct LiftedAtom {
  std::uint32_t predicate = 0;
  std::vector<Argument> arguments;
};
struct Equality {
  Argument left;
  Argument right;
  bool holds = true;
};

/// An action with variables: conditions as they must be at its begin, effects as they are after its end.
struct LiftedAction {
  std::string name;
  std::vector<std::vector<std::uint32_t>> objects;  ///< by variable: those of its types, ascending
  std::vector<LiftedAtom> needs;
  std::vector<LiftedAtom> forbids;
  std::vector<Equality> equalities;
  std::vector<LiftedAtom> adds;
  std::vector<LiftedAtom> deletes;
  std::vector<const pddl::detail::PddlTerm*> costs;  ///< numbers and functions that it adds to `total-cost`
  std::map<std::string, std::uint32_t> variables;    ///< with their '?'
};

/// All actions of the task. InvalidArgument, with the place, for conditional effects, effects for all
/// objects, and objects that do not exist.
Result<std::vector<LiftedAction>> lifted_actions(const pddl::detail::PddlTask& task, const Numbers& numbers);

}  // namespace segue::planner::detail
