// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl_durative.hpp>

#include <segue/base/text.hpp>
#include <segue/pddl/pddl_forms.hpp>

#include <algorithm>
#include <cmath>

namespace segue::pddl::detail {

namespace {

/// Deals out the parts of a condition or of an effect.
class TimeReader {
 public:
  TimeReader(bool is_effect, Diagnostics& diagnostics) : is_effect_(is_effect), diagnostics_(diagnostics) {}

  PddlTimed read(const PddlTerm& term) {
    for (PddlTerm* part : {&timed_.at_start, &timed_.over_all, &timed_.at_end})
      *part = {{}, {PddlTerm{"and", {}, term.where}}, term.where};
    deal_out(term);
    return std::move(timed_);
  }

 private:
  void deal_out(const PddlTerm& term) {
    if (term.is_list() && term.list.empty()) return;
    if (term.begins_with("and")) {
      for (std::size_t i = 1; i < term.list.size(); ++i)
        deal_out(term.list[i]);
      return;
    }
    if (is_effect_ && is_numeric_effect(term)) return;
    PddlTerm* const part = part_named(term);
    if (part == nullptr) {
      return diagnostics_.error("bad-time",
                                is_effect_
                                    ? "an effect of a durative action is (at start ...) or (at end ...)"
                                    : "a condition of a durative action is (at start ...), (over all "
                                      "...) or (at end ...)",
                                term.where);
    }
    if (is_effect_ && has_conditional(term.list[2])) {
      return diagnostics_.error("unsupported", "'when' in a durative action is not supported", term.where);
    }
    part->list.push_back(term.list[2]);
  }

  PddlTerm* part_named(const PddlTerm& term) {
    if (!term.is_list() || term.list.size() != 3) return nullptr;
    if (!is_effect_ && term.list[0].word == "over" && term.list[1].word == "all") return &timed_.over_all;
    if (term.list[0].word != "at") return nullptr;
    if (term.list[1].word == "start") return &timed_.at_start;
    return term.list[1].word == "end" ? &timed_.at_end : nullptr;
  }

  static bool has_conditional(const PddlTerm& term) {
    return term.begins_with("when") || std::ranges::any_of(term.list, has_conditional);
  }

  bool is_effect_;
  Diagnostics& diagnostics_;
  PddlTimed timed_;
};

class DurationReader {
 public:
  DurationReader(const PddlValueOf& value_of, Diagnostics& diagnostics)
      : value_of_(value_of), diagnostics_(diagnostics) {}

  std::optional<PddlDuration> read(const PddlTerm& constraint) {
    PddlDuration duration;
    return add(constraint, duration) ? std::optional(duration) : std::nullopt;
  }

 private:
  bool add(const PddlTerm& constraint, PddlDuration& duration) {
    if (constraint.is_list() && constraint.list.empty()) return true;
    if (constraint.begins_with("and")) {
      return std::all_of(constraint.list.begin() + 1, constraint.list.end(),
                         [&](const PddlTerm& part) { return add(part, duration); });
    }
    const std::string& comparison = constraint.is_list() ? constraint.list.front().word : constraint.word;
    const bool known = comparison == "=" || comparison == "<=" || comparison == ">=";
    if (!known || constraint.list.size() != 3 || constraint.list[1].word != "?duration")
      return refuse("a duration is such as (= ?duration 5) or (<= ?duration 5)", constraint.where);
    const auto value = number_of(constraint.list[2]);
    if (!value) return false;
    if (*value < 0 || !std::isfinite(*value))
      return refuse("a duration is at least 0 s and not infinite", constraint.list[2].where);
    if (comparison != "<=") duration.least = std::max(duration.least, *value);
    if (comparison != ">=") duration.most = std::min(duration.most, *value);
    return true;
  }

  std::optional<double> number_of(const PddlTerm& term) {
    if (!term.is_list()) {
      const auto number = number_in(term.word);
      if (!number) refuse(quote(term.word) + " is not a number", term.where);
      return number;
    }
    const bool computed = term.list.size() == 3 && term.list[0].word.size() == 1 &&
                          std::string_view("+-*/").find(term.list[0].word) != std::string_view::npos;
    if (!computed) return value_of_(term);
    const auto left = number_of(term.list[1]);
    const auto right = number_of(term.list[2]);
    if (!left || !right) return std::nullopt;
    switch (term.list[0].word.front()) {
      case '+':
        return *left + *right;
      case '-':
        return *left - *right;
      case '*':
        return *left * *right;
      default:
        return *left / *right;
    }
  }

  bool refuse(std::string message, const SourceLocation& where) {
    diagnostics_.error("bad-duration", std::move(message), where);
    return false;
  }

  const PddlValueOf& value_of_;
  Diagnostics& diagnostics_;
};

}  // namespace

PddlTimed timed_condition(const PddlTerm& term, Diagnostics& diagnostics) {
  return TimeReader(false, diagnostics).read(term);
}

PddlTimed timed_effect(const PddlTerm& term, Diagnostics& diagnostics) {
  return TimeReader(true, diagnostics).read(term);
}

std::optional<PddlDuration> duration_of(const PddlTerm& constraint, const PddlValueOf& value_of,
                                        Diagnostics& diagnostics) {
  return DurationReader(value_of, diagnostics).read(constraint);
}

}  // namespace segue::pddl::detail
