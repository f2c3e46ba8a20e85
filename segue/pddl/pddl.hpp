// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/task_network/task_network.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::pddl {

/// A text and the file name for messages.
struct PddlText {
  std::string_view text;
  std::string file;
};

enum class PddlPart { Domain, Problem, Plan };
/// The kind of a text; nothing, and diagnostics, where it cannot be parsed.
std::optional<PddlPart> part_of(const PddlText& text, Diagnostics& diagnostics);

/// A variable of an action or a predicate, without its '?'.
struct DomainParameter {
  std::string name;
  std::vector<std::string> types;  ///< its objects are of any of them
};
/// A predicate of a domain.
struct DomainPredicate {
  std::string name;
  std::vector<DomainParameter> parameters;
};
/// An action of a domain.
struct DomainAction {
  std::string name;
  std::vector<DomainParameter> parameters;
  bool durative = false;
};
/// The declarations of a domain, sorted by name.
struct PddlDomain {
  std::string name;
  std::vector<DomainAction> actions;
  std::vector<DomainPredicate> predicates;
  task_network::FactTable facts;  ///< with its types, constants and predicates
};
/// Reads a domain. If there are errors, nothing is returned.
std::optional<PddlDomain> read_domain(const PddlText& text, Diagnostics& diagnostics);

/// A step of a plan, which is a node of its network.
struct PlannedStep {
  std::string action;
  std::vector<std::string> objects;
  std::vector<task_network::Literal> during;    ///< hold until it has ended ("over all")
  std::vector<task_network::FactId> meanwhile;  ///< it changes them at its start, and back at its end
};

/// A plan as a task network. `steps` are its nodes, in their order.
struct PddlPlan {
  task_network::TaskNetwork network;
  std::vector<PlannedStep> steps;
};

/// A domain, a problem and a sequential or time-stamped plan, as planners write it, as a network: each step
/// is an irreversible node; the goal is that of the problem. Supports STRIPS with typing (including
/// `either`), negative preconditions, equality, constants, conditional and `forall` effects, and durative
/// actions; numeric costs are ignored. Everything else that PDDL has (constraints, numeric conditions,
/// processes, ...) is refused by name. Names are case-insensitive. A conditional effect becomes the effect
/// that it has at its place in the plan, with the facts that decide it as preconditions.
///
/// A step takes as long as the plan says if its action is durative, otherwise 1 s. It requires all conditions
/// of its action when it begins, and has all effects when it ends; who touches a fact that others change only
/// meanwhile blocks a resource of the fact's name ("task:free(arm)"). Steps are in the order in which they
/// begin, and the plan is simulated in that order, one after the other: a precondition or a goal that does
/// not hold is an error with its place, so plans are refused in which steps must overlap. If there are
/// errors, nothing is returned.
std::optional<PddlPlan> read_pddl(const PddlText& domain, const PddlText& problem, const PddlText& plan,
                                  Diagnostics& diagnostics);
/// Reads a domain, a problem and a plan from files. Blocks.
std::optional<PddlPlan> load_pddl(const std::filesystem::path& domain, const std::filesystem::path& problem,
                                  const std::filesystem::path& plan, Diagnostics& diagnostics);

}  // namespace segue::pddl
