// SPDX-License-Identifier: Apache-2.0
#include <segue/planner/lifted_action.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <utility>

namespace segue::planner::detail {

using pddl::detail::PddlTask;
using pddl::detail::PddlTerm;

Numbers::Numbers(const PddlTask& task) {
  for (const pddl::DomainPredicate& predicate : task.domain().predicates)
    predicates_.emplace(predicate.name, static_cast<std::uint32_t>(predicates_.size()));
  for (const std::string& object : task.objects())
    objects_.emplace(object, static_cast<std::uint32_t>(objects_.size()));
}

Tuple Numbers::fact(std::string_view text) const {
  const auto open = text.find('(');
  Tuple tuple{predicate(std::string(text.substr(0, open)))};
  text.remove_prefix(open + 1);
  while (text.size() > 1) {
    const auto end = text.find_first_of(",)");
    tuple.push_back(objects_.at(std::string(text.substr(0, end))));
    text.remove_prefix(end + (text[end] == ',' ? 1 : 0));
  }
  return tuple;
}

namespace {

/// Reads one action.
class Lifter {
 public:
  Lifter(const PddlTask& task, const Numbers& numbers) : task_(task), numbers_(numbers) {}

  Result<LiftedAction> lift(const std::string& name, const PddlTask::Action& source) {
    action_ = {};
    action_.name = name;
    for (const pddl::detail::PddlTyped& parameter : source.parameters) {
      action_.variables.emplace(parameter.name, static_cast<std::uint32_t>(action_.objects.size()));
      std::vector<std::uint32_t>& objects = action_.objects.emplace_back();
      for (const std::string& object : task_.objects()) {
        if (task_.network().facts.is_a(object, parameter.types)) objects.push_back(*numbers_.object(object));
      }
      std::ranges::sort(objects);
    }
    if (auto fits = add_effect(source.effect.at_end, nullptr); !fits) return fits.error();
    if (auto fits = add_effect(source.effect.at_start, &source.effect.at_end); !fits) return fits.error();
    add_condition(source.condition.at_start, true, nullptr);
    // The action's own effects at the start may bring about what it needs afterwards.
    add_condition(source.condition.over_all, true, &source.effect.at_start);
    add_condition(source.condition.at_end, true, &source.effect.at_start);
    if (error_) return *error_;
    return std::move(action_);
  }

 private:
  /// `before`: effects that have happened by then.
  void add_condition(const PddlTerm& term, bool positive, const PddlTerm* before) {
    if (term.is_list() && term.list.empty()) return;
    if (term.begins_with("and")) {
      for (std::size_t i = 1; i < term.list.size(); ++i)
        add_condition(term.list[i], positive, before);
      return;
    }
    if (term.begins_with("not")) return add_condition(term.list[1], !positive, before);
    if (term.begins_with("=")) {
      action_.equalities.push_back({argument(term.list[1]), argument(term.list[2]), positive});
      return;
    }
    if (before != nullptr && brings_about(*before, term, positive)) return;
    (positive ? action_.needs : action_.forbids).push_back(atom(term));
  }

  static bool same(const PddlTerm& a, const PddlTerm& b) {
    return a.word == b.word && std::ranges::equal(a.list, b.list, same);
  }

  static bool brings_about(const PddlTerm& effect, const PddlTerm& fact, bool positive) {
    if (effect.begins_with("and"))
      return std::ranges::any_of(effect.list,
                                 [&](const PddlTerm& part) { return brings_about(part, fact, positive); });
    if (effect.begins_with("not")) return !positive && same(effect.list[1], fact);
    return positive && same(effect, fact);
  }

  /// `after`: effects that count where they contradict this one.
  Result<void> add_effect(const PddlTerm& term, const PddlTerm* after) {
    if (!term.is_list() || term.list.empty()) return {};
    if (term.begins_with("and")) {
      for (std::size_t i = 1; i < term.list.size(); ++i) {
        if (auto fits = add_effect(term.list[i], after); !fits) return fits;
      }
      return {};
    }
    if (term.begins_with("when") || term.begins_with("forall"))
      return fail(ErrorCode::InvalidArgument,
                  "the built-in planner does not support '" + term.list.front().word + "' in effects", {},
                  term.where);
    if (pddl::detail::is_numeric_effect(term)) {
      const bool is_cost =
          term.begins_with("increase") && term.list.size() == 3 && term.list[1].begins_with("total-cost");
      if (is_cost) action_.costs.push_back(&term.list[2]);
      return {};
    }
    const bool adds = !term.begins_with("not");
    const PddlTerm& fact = adds ? term : term.list[1];
    if (after != nullptr && brings_about(*after, fact, !adds)) return {};
    (adds ? action_.adds : action_.deletes).push_back(atom(fact));
    return {};
  }

  Argument argument(const PddlTerm& term) {
    const auto variable = action_.variables.find(term.word);
    if (variable != action_.variables.end()) return {true, variable->second};
    const auto object = numbers_.object(term.word);
    if (!object && !error_)
      error_ = fail(ErrorCode::InvalidArgument, "there is no object " + quote(term.word), {}, term.where);
    return {false, object.value_or(0)};
  }

  LiftedAtom atom(const PddlTerm& term) {
    LiftedAtom result{numbers_.predicate(term.list.front().word), {}};
    for (std::size_t i = 1; i < term.list.size(); ++i)
      result.arguments.push_back(argument(term.list[i]));
    return result;
  }

  const PddlTask& task_;
  const Numbers& numbers_;
  LiftedAction action_;
  std::optional<Error> error_;
};

}  // namespace

Result<std::vector<LiftedAction>> lifted_actions(const PddlTask& task, const Numbers& numbers) {
  std::vector<LiftedAction> actions;
  Lifter lifter(task, numbers);
  for (const auto& [name, action] : task.actions()) {
    auto lifted = lifter.lift(name, action);
    if (!lifted) return lifted.error();
    actions.push_back(std::move(*lifted));
  }
  return actions;
}

}  // namespace segue::planner::detail
