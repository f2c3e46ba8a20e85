// SPDX-License-Identifier: Apache-2.0
#include <segue/planner/ground_task.hpp>

#include <segue/planner/lifted_action.hpp>

#include <algorithm>
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace segue::planner::detail {

using pddl::detail::PddlTask;
using pddl::detail::PddlTerm;

namespace {

struct TupleHash {
  std::size_t operator()(const Tuple& tuple) const {
    std::uint64_t hash = 1469598103934665603ULL;
    for (const std::uint32_t number : tuple)
      hash = (hash ^ number) * 1099511628211ULL;
    return hash;
  }
};

/// Facts by number.
class Facts {
 public:
  /// The fact's number, and whether it is new.
  std::pair<FactNumber, bool> add(Tuple fact) {
    const auto [at, fresh] = numbers_.try_emplace(std::move(fact), static_cast<FactNumber>(all_.size()));
    if (fresh) all_.push_back(&at->first);
    return {at->second, fresh};
  }
  [[nodiscard]] std::optional<FactNumber> find(const Tuple& fact) const {
    const auto found = numbers_.find(fact);
    return found == numbers_.end() ? std::nullopt : std::optional(found->second);
  }
  [[nodiscard]] const Tuple& operator[](FactNumber fact) const { return *all_[fact]; }
  [[nodiscard]] FactNumber size() const { return static_cast<FactNumber>(all_.size()); }

 private:
  std::unordered_map<Tuple, FactNumber, TupleHash> numbers_;
  std::vector<const Tuple*> all_;
};

constexpr std::uint32_t kUnbound = ~std::uint32_t{0};

/// An action with its objects.
struct Instance {
  std::uint32_t action = 0;
  std::vector<std::uint32_t> objects;
};

/// Finds all facts and instances of actions that can be reached if nothing is deleted: each fact, once it is
/// known, is joined with those before it, so that an instance is found when the last fact that it needs is.
class Reachability {
 public:
  Reachability(const std::vector<LiftedAction>& actions, std::uint32_t predicates, const Limits& limits)
      : actions_(actions), limits_(limits), by_predicate_(predicates), users_(predicates) {
    for (std::uint32_t i = 0; i < actions_.size(); ++i) {
      for (std::uint32_t k = 0; k < actions_[i].needs.size(); ++k)
        users_[actions_[i].needs[k].predicate].push_back({i, k});
    }
  }

  Result<void> run(const std::vector<Tuple>& initial) {
    for (const Tuple& fact : initial)
      facts.add(fact);
    for (std::uint32_t i = 0; i < actions_.size(); ++i) {
      if (actions_[i].needs.empty()) begin(i, {});
    }
    for (FactNumber fact = 0; fact < facts.size(); ++fact) {
      index(fact);
      const Tuple tuple = facts[fact];
      for (const auto& [action, need] : users_[tuple[0]])
        begin(action, std::pair(need, fact));
      if (instances.size() > kMostInstances)
        return fail(ErrorCode::ResourceExhausted,
                    "the problem is too large for the built-in planner: more than a million actions");
      if (limits_.are_reached()) return fail(ErrorCode::DeadlineExceeded, "no plan was found in time");
    }
    return {};
  }

  Facts facts;
  std::vector<Instance> instances;

 private:
  static constexpr std::size_t kMostInstances = 1'000'000;

  static std::uint64_t key(std::uint32_t predicate, std::size_t place, std::uint32_t object) {
    return (std::uint64_t{predicate} << 40U) | (std::uint64_t{place} << 32U) | object;
  }

  void index(FactNumber fact) {
    const Tuple& tuple = facts[fact];
    by_predicate_[tuple[0]].push_back(fact);
    for (std::size_t i = 1; i < tuple.size(); ++i)
      by_object_[key(tuple[0], i, tuple[i])].push_back(fact);
  }

  void begin(std::uint32_t action, std::optional<std::pair<std::uint32_t, FactNumber>> first) {
    current_ = {action, std::vector(actions_[action].objects.size(), kUnbound)};
    is_joined_.assign(actions_[action].needs.size(), false);
    if (!first) return join();
    is_joined_[first->first] = true;
    bind_and_join(actions_[action].needs[first->first], first->second);
  }

  [[nodiscard]] std::uint32_t value(const Argument& argument) const {
    return argument.is_variable ? current_.objects[argument.number] : argument.number;
  }

  /// Joins on if the fact fits the atom, and unbinds again.
  void bind_and_join(const LiftedAtom& atom, FactNumber fact) {
    std::vector<std::uint32_t> bound;
    const Tuple tuple = facts[fact];  // facts may move meanwhile
    bool fits = true;
    for (std::size_t i = 0; fits && i < atom.arguments.size(); ++i) {
      const Argument& argument = atom.arguments[i];
      const std::uint32_t object = tuple[i + 1];
      if (value(argument) == kUnbound) {
        const auto& objects = actions_[current_.action].objects[argument.number];
        fits = std::ranges::binary_search(objects, object);
        if (!fits) break;
        current_.objects[argument.number] = object;
        bound.push_back(argument.number);
      } else {
        fits = value(argument) == object;
      }
    }
    if (fits) join();
    for (const std::uint32_t variable : bound)
      current_.objects[variable] = kUnbound;
  }

  /// The known facts that may fit the atom.
  [[nodiscard]] std::span<const FactNumber> candidates(const LiftedAtom& atom) const {
    std::span<const FactNumber> best = by_predicate_[atom.predicate];
    for (std::size_t i = 0; i < atom.arguments.size(); ++i) {
      const std::uint32_t object = value(atom.arguments[i]);
      if (object == kUnbound) continue;
      const auto found = by_object_.find(key(atom.predicate, i + 1, object));
      if (found == by_object_.end()) return {};
      if (found->second.size() < best.size()) best = found->second;
    }
    return best;
  }

  /// Joins the need with the fewest candidates.
  void join() {
    const LiftedAction& action = actions_[current_.action];
    std::size_t next = action.needs.size();
    std::span<const FactNumber> fewest;
    for (std::size_t i = 0; i < action.needs.size(); ++i) {
      if (is_joined_[i]) continue;
      const auto some = candidates(action.needs[i]);
      if (next < action.needs.size() && some.size() >= fewest.size()) continue;
      next = i;
      fewest = some;
    }
    if (next == action.needs.size()) return bind_rest(0);
    is_joined_[next] = true;
    for (const FactNumber fact : fewest)
      bind_and_join(action.needs[next], fact);
    is_joined_[next] = false;
  }

  void bind_rest(std::size_t variable) {
    while (variable < current_.objects.size() && current_.objects[variable] != kUnbound)
      ++variable;
    if (variable == current_.objects.size()) return emit();
    for (const std::uint32_t object : actions_[current_.action].objects[variable]) {
      if (instances.size() > kMostInstances) break;
      current_.objects[variable] = object;
      bind_rest(variable + 1);
    }
    current_.objects[variable] = kUnbound;
  }

  void emit() {
    const LiftedAction& action = actions_[current_.action];
    for (const Equality& equality : action.equalities) {
      if ((value(equality.left) == value(equality.right)) != equality.holds) return;
    }
    Tuple name{current_.action};
    name.insert(name.end(), current_.objects.begin(), current_.objects.end());
    if (!known_.insert(std::move(name)).second) return;
    instances.push_back(current_);
    for (const LiftedAtom& atom : action.adds) {
      Tuple fact{atom.predicate};
      for (const Argument& argument : atom.arguments)
        fact.push_back(value(argument));
      facts.add(std::move(fact));
    }
  }

  const std::vector<LiftedAction>& actions_;
  const Limits& limits_;
  std::vector<std::vector<FactNumber>> by_predicate_;  ///< facts that have had their turn
  std::unordered_map<std::uint64_t, std::vector<FactNumber>> by_object_;
  std::vector<std::vector<std::pair<std::uint32_t, std::uint32_t>>> users_;  ///< by predicate: action, need
  std::unordered_set<Tuple, TupleHash> known_;
  Instance current_;
  std::vector<bool> is_joined_;
};

/// Makes a GroundTask of what can be reached.
class Compiler {
 public:
  Compiler(const PddlTask& task, const Numbers& numbers, const std::vector<LiftedAction>& actions,
           const Reachability& reached, std::size_t initial)
      : task_(task), numbers_(numbers), actions_(actions), reached_(reached) {
    holds_at_first_.assign(reached.facts.size(), false);
    std::fill_n(holds_at_first_.begin(), initial, true);
    changes_.assign(reached.facts.size(), false);
    number_.assign(reached.facts.size(), kUnbound);
    negation_.assign(reached.facts.size(), kUnbound);
  }

  GroundTask compile() {
    find_changing();
    for (const task_network::Literal& literal : task_.network().goal)
      add_goal(literal);
    for (const Instance& instance : reached_.instances)
      add_operator(instance);
    complete_negations();
    for (FactNumber fact = 0; fact < reached_.facts.size(); ++fact) {
      if (number_[fact] != kUnbound && holds_at_first_[fact]) result_.initial.push_back(number_[fact]);
      if (negation_[fact] != kUnbound && !holds_at_first_[fact]) result_.initial.push_back(negation_[fact]);
    }
    return std::move(result_);
  }

 private:
  [[nodiscard]] Tuple tuple(const LiftedAtom& atom, const Instance& instance) const {
    Tuple fact{atom.predicate};
    for (const Argument& argument : atom.arguments)
      fact.push_back(argument.is_variable ? instance.objects[argument.number] : argument.number);
    return fact;
  }

  /// A fact changes if it does not hold at first, or if something deletes it.
  void find_changing() {
    for (FactNumber fact = 0; fact < reached_.facts.size(); ++fact)
      changes_[fact] = !holds_at_first_[fact];
    for (const Instance& instance : reached_.instances) {
      for (const LiftedAtom& atom : actions_[instance.action].deletes) {
        if (const auto fact = reached_.facts.find(tuple(atom, instance))) changes_[*fact] = true;
      }
    }
  }

  FactNumber numbered(FactNumber& number) {
    if (number == kUnbound) number = result_.facts++;
    return number;
  }

  void add_goal(const task_network::Literal& literal) {
    const auto fact = reached_.facts.find(numbers_.fact(task_.network().facts.text(literal.fact)));
    if (fact && changes_[*fact])
      result_.goal.push_back(numbered(literal.value ? number_[*fact] : negation_[*fact]));
    else if (fact.has_value() != literal.value)
      result_.goal_can_be_reached = false;
  }

  void add_operator(const Instance& instance) {
    const LiftedAction& action = actions_[instance.action];
    Operator result;
    for (const LiftedAtom& atom : action.forbids) {
      const auto fact = reached_.facts.find(tuple(atom, instance));
      if (!fact) continue;
      if (!changes_[*fact]) return;
      result.needs.push_back(numbered(negation_[*fact]));
    }
    for (const LiftedAtom& atom : action.needs)
      add_changing(result.needs, tuple(atom, instance));
    for (const LiftedAtom& atom : action.adds)
      add_changing(result.adds, tuple(atom, instance));
    for (const LiftedAtom& atom : action.deletes)
      add_changing(result.deletes, tuple(atom, instance));
    for (auto* facts : {&result.needs, &result.adds, &result.deletes}) {
      std::ranges::sort(*facts);
      facts->erase(std::unique(facts->begin(), facts->end()), facts->end());
    }
    std::erase_if(result.deletes,
                  [&](FactNumber fact) { return std::ranges::binary_search(result.adds, fact); });
    result.step = "(" + action.name;
    for (const std::uint32_t object : instance.objects)
      result.step += " " + task_.objects()[object];
    result.step += ")";
    add_costs(result, action, instance);
    result_.operators.push_back(std::move(result));
  }

  void add_changing(std::vector<FactNumber>& facts, const Tuple& tuple) {
    const auto fact = reached_.facts.find(tuple);
    if (fact && changes_[*fact]) facts.push_back(numbered(number_[*fact]));
  }

  void add_costs(Operator& result, const LiftedAction& action, const Instance& instance) {
    if (action.costs.empty()) return;
    result_.has_costs = true;
    result.cost = 0;
    for (const PddlTerm* cost : action.costs) {
      if (!cost->is_list()) {
        result.cost += pddl::detail::number_in(cost->word).value_or(0);
        continue;
      }
      std::string name;
      for (const PddlTerm& word : cost->list) {
        const auto variable = action.variables.find(word.word);
        name += (name.empty() ? "" : " ") + (variable == action.variables.end()
                                                 ? word.word
                                                 : task_.objects()[instance.objects[variable->second]]);
      }
      const auto value = task_.values().find(name);
      if (value != task_.values().end()) result.cost += value->second;
    }
  }

  /// An operator that adds a fact deletes its negation, and the other way round.
  void complete_negations() {
    std::vector<FactNumber> negation(result_.facts, kUnbound);
    for (FactNumber fact = 0; fact < reached_.facts.size(); ++fact) {
      if (number_[fact] != kUnbound) negation[number_[fact]] = negation_[fact];
    }
    for (Operator& each : result_.operators) {
      const auto adds = each.adds;
      const auto deletes = each.deletes;
      for (const FactNumber fact : adds) {
        if (negation[fact] != kUnbound) each.deletes.push_back(negation[fact]);
      }
      for (const FactNumber fact : deletes) {
        if (negation[fact] != kUnbound) each.adds.push_back(negation[fact]);
      }
    }
  }

  const PddlTask& task_;
  const Numbers& numbers_;
  const std::vector<LiftedAction>& actions_;
  const Reachability& reached_;
  GroundTask result_;
  std::vector<bool> holds_at_first_;
  std::vector<bool> changes_;
  std::vector<FactNumber> number_;    ///< in the result
  std::vector<FactNumber> negation_;  ///< in the result
};

}  // namespace

Result<GroundTask> ground(const PddlTask& task, const Limits& limits) {
  const Numbers numbers(task);
  const auto actions = lifted_actions(task, numbers);
  if (!actions) return actions.error();
  std::vector<Tuple> initial;
  for (const task_network::FactId fact : task.network().initial_world.facts())
    initial.push_back(numbers.fact(task.network().facts.text(fact)));
  Reachability reached(*actions, numbers.predicate_count(), limits);
  if (auto done = reached.run(initial); !done) return done.error();
  return Compiler(task, numbers, *actions, reached, initial.size()).compile();
}

}  // namespace segue::planner::detail
