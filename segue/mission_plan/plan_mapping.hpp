// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/mission/mission.hpp>
#include <segue/pddl/pddl.hpp>
#include <segue/pddl/pddl_problem.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// PDDL plans as missions: a mapping binds the actions, objects and facts of a domain to those of missions.
namespace segue::mission {

/// The mission action that carries out an action of the domain.
struct BoundAction {
  std::string name;               ///< of the domain's action
  Action action;                  ///< its inputs include all of `inputs`
  std::vector<PortValue> inputs;  ///< "{parameter}", at any depth, stands for the value of that object
  SourcePlace where;
};

/// The values of the objects of a type.
struct ObjectValues {
  std::string type;
  std::vector<PortValue> values;  ///< by object
  SourcePlace where;
};

/// The fact of missions that a predicate is; "{parameter}" in an argument stands for the object.
struct BoundPredicate {
  std::string name;
  Fact fact;  ///< not positive: it holds while the predicate does not
};

/// A mapping file (docs/plans.md). Other objects stand for their names, other predicates for the facts of the
/// same name.
struct PlanMapping {
  std::string name;
  std::string file;
  std::filesystem::path domain_file;
  std::string domain_text;
  pddl::PddlDomain domain;
  std::vector<BoundAction> actions;
  std::vector<ObjectValues> objects;
  std::vector<BoundPredicate> predicates;
  Mission library;  ///< whose resources, world data, global variables and observed facts missions have

  [[nodiscard]] const BoundAction* find_action(std::string_view name) const;
  [[nodiscard]] const BoundPredicate* find_predicate(std::string_view name) const;
};

/// Reads and checks a mapping file, its domain and its library. Warns of actions that it does not bind.
/// Nothing if there are errors. Blocks on files.
std::optional<PlanMapping> load_mapping(const std::filesystem::path& file, Diagnostics& diagnostics);

/// The fact of the domain that an observed fact of the mapping is; nothing where the domain has none.
std::optional<pddl::GroundAtom> observed_atom(const PlanMapping& mapping, const Fact& fact, bool holds);

}  // namespace segue::mission
