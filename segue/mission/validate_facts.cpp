// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>
#include <segue/mission/footprint.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <unordered_map>
#include <unordered_set>

namespace segue::mission::detail {
namespace {

bool is_placeholder(std::string_view argument) {
  return argument.starts_with('{');
}

/// Whether both can become the same fact once the inputs are known.
bool meet(const Fact& a, const Fact& b) {
  return a.predicate == b.predicate &&
         std::ranges::equal(a.arguments, b.arguments, [](const std::string& x, const std::string& y) {
           return x == y || is_placeholder(x) || is_placeholder(y);
         });
}

class FactCheck {
 public:
  FactCheck(const Mission& mission, Diagnostics& diagnostics) : mission_(mission), diagnostics_(diagnostics) {
    for (const Fact& fact : mission.world)
      initial_[fact.predicate].push_back(&fact);
    for (const Action& action : mission.actions) {
      for (const Fact& fact : action.effects)
        effects_[fact.predicate].push_back(&fact);
    }
  }

  void run() {
    check_vocabulary(mission_.vocabulary, diagnostics_);
    check_world();
    check_observed();
    for (const Action& action : mission_.actions) {
      const std::string what = "action " + quote(action.name.str());
      check_preconditions(action.preconditions, what);
      check_during(action, what);
      check_shape(action.effects, what);
      check_pairs(action.effects, what, "effect", false);
    }
    for (StateIndex i = 0; i < mission_.states.size(); ++i)
      check_preconditions(mission_.states[i].preconditions, state_text(mission_, i));
  }

 private:
  using ByPredicate = std::unordered_map<std::string_view, std::vector<const Fact*>>;

  void check_preconditions(const std::vector<Fact>& facts, const std::string& what) {
    check_shape(facts, what);
    check_pairs(facts, what, "precondition", true);
    for (const Fact& fact : facts) {
      if (can_become(fact)) continue;
      diagnostics_.warning("never-true",
                           what + ": its precondition " + fact_text(fact) + " never holds: " + why(fact),
                           fact.where);
    }
  }

  /// A fact that is not observed can only change by actions, which wait for each other.
  void check_during(const Action& action, const std::string& what) {
    check_preconditions(action.during, what);
    for (const Fact& fact : action.during) {
      const auto same = [&](const ObservedFact& one) { return meet(one.fact, fact); };
      if (std::ranges::any_of(mission_.observed, same)) continue;
      diagnostics_.warning(
          "not-observed",
          what + ": " + fact_text(fact) +
              " of its 'while' is not observed, so it is looked at only when the action begins",
          fact.where);
    }
    for (const Fact& fact : action.during) {
      const auto contradicts = [&](const Fact& other) {
        return to_string(other) == to_string(fact) && other.positive != fact.positive;
      };
      if (std::ranges::none_of(action.preconditions, contradicts)) continue;
      diagnostics_.error("contradicting-facts",
                         what + ": it needs " + quote(to_string(fact)) +
                             " to be otherwise when it begins ('preconditions') than all along ('while')",
                         fact.where);
    }
  }

  void check_observed() {
    std::unordered_set<std::string> seen;
    for (const ObservedFact& one : mission_.observed) {
      const auto grounded = ground(one.fact);
      if (!grounded || !one.fact.positive) {
        diagnostics_.error(
            "bad-fact", "the mission: 'observe' must name facts without inputs, not " + fact_text(one.fact),
            one.where);
      } else if (!seen.insert(grounded->text).second) {
        diagnostics_.error("duplicate-fact", "the mission: 'observe' has " + fact_text(one.fact) + " twice",
                           one.where);
      }
      check_arguments(one.fact, "the mission: 'observe'", one.where);
    }
  }

  static std::string fact_text(const Fact& fact) {
    return quote((fact.positive ? "" : "!") + to_string(fact));
  }

  static std::string why(const Fact& fact) {
    return fact.positive ? "it does not at the beginning, and no action makes it true"
                         : "the fact holds at the beginning, and no action makes it false";
  }

  void check_world() {
    std::unordered_set<std::string> seen;
    for (const Fact& fact : mission_.world) {
      const auto grounded = ground(fact);
      if (!grounded || !fact.positive) {
        diagnostics_.error(
            "bad-fact",
            "the mission: 'world' must be facts that hold, without inputs, not " + fact_text(fact),
            fact.where);
      } else if (!seen.insert(grounded->text).second) {
        diagnostics_.warning("duplicate-fact", "the mission: 'world' has " + fact_text(fact) + " twice",
                             fact.where);
      }
      check_arguments(fact, "the mission: 'world'", fact.where);
    }
  }

  void check_arguments(const Fact& fact, const std::string& what, const SourcePlace& where) {
    if (const auto problem = mission_.vocabulary.problem(fact.predicate, fact.arguments))
      diagnostics_.error("bad-fact", what + ": " + fact_text(fact) + " " + *problem, where);
  }

  /// Facts from a reader are always well-formed; those that a program has built may not be.
  void check_shape(const std::vector<Fact>& facts, const std::string& what) {
    for (const Fact& fact : facts) {
      const bool fits =
          is_identifier(fact.predicate) && std::ranges::all_of(fact.arguments, [](std::string_view argument) {
            const bool input = argument.size() > 2 && is_placeholder(argument) && argument.back() == '}';
            return is_fact_argument(input ? argument.substr(1, argument.size() - 2) : argument);
          });
      if (fits)
        check_arguments(fact, what, fact.where);
      else
        diagnostics_.error("bad-fact",
                           what + ": " + fact_text(fact) + " is not a fact such as 'at(robot,{place})'",
                           fact.where);
    }
  }

  /// A fact that is listed with both signs.
  void report_contradiction(const Fact& fact, const std::string& subject, bool is_error) {
    const std::string name = quote(to_string(fact));
    if (is_error)
      diagnostics_.error("contradicting-facts", subject + "s ask for " + name + " to hold and not to",
                         fact.where);
    else
      diagnostics_.warning("contradicting-facts",
                           subject + "s make " + name + " true and false; it will be true", fact.where);
  }

  void report_duplicate(const Fact& fact, const std::string& what, const std::string& role) {
    diagnostics_.warning("duplicate-fact",
                         what + " has the " + role + " " + quote(to_string(fact)) + " twice", fact.where);
  }

  /// Reports facts that are listed twice, or with both signs.
  void check_pairs(const std::vector<Fact>& facts, const std::string& what, const std::string& role,
                   bool contradiction_is_error) {
    const std::string subject = what + ": its " + role;
    std::unordered_map<std::string, const Fact*> seen;
    for (const Fact& fact : facts) {
      const auto [known, fresh] = seen.try_emplace(to_string(fact), &fact);
      if (fresh) continue;
      if (known->second->positive == fact.positive)
        report_duplicate(fact, what, role);
      else
        report_contradiction(fact, subject, contradiction_is_error);
    }
  }

  [[nodiscard]] bool can_become(const Fact& needed) const {
    if (std::ranges::any_of(mission_.observed,
                            [&](const ObservedFact& one) { return meet(one.fact, needed); }))
      return true;
    const auto same = [&](const Fact* fact) { return meet(*fact, needed); };
    if (const auto made = effects_.find(needed.predicate); made != effects_.end()) {
      const auto fits = [&](const Fact* fact) { return fact->positive == needed.positive && same(fact); };
      if (std::ranges::any_of(made->second, fits)) return true;
    }
    const auto there = initial_.find(needed.predicate);
    const bool known = there != initial_.end() && std::ranges::any_of(there->second, same);
    if (needed.positive) return known;
    // An input may select a fact other than those that hold.
    return !known || std::ranges::any_of(needed.arguments, is_placeholder);
  }

  const Mission& mission_;
  Diagnostics& diagnostics_;
  ByPredicate initial_;
  ByPredicate effects_;
};

}  // namespace

void check_facts(const Mission& mission, Diagnostics& diagnostics) {
  FactCheck(mission, diagnostics).run();
}

}  // namespace segue::mission::detail
