// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl_plan.hpp>

#include <segue/base/text.hpp>

#include <algorithm>
#include <span>
#include <utility>

namespace segue::pddl::detail {

namespace {

/// The line that FF prints before the steps of its plan.
constexpr std::string_view kFfBegin = "found legal plan as follows";

/// Whether a line of FF's output has a step: "step    0: MOVE A B", "        1: MOVE B C".
bool is_step_of_ff(std::string_view line) {
  const auto first = line.find_first_not_of(" \t\rstep");
  if (first == std::string_view::npos) return false;
  const auto end = line.find_first_not_of("0123456789", first);
  return end != first && end != std::string_view::npos && line[end] == ':';
}

/// The output of FF with everything beside the steps replaced by blanks, so that places stay what they are;
/// other text as it is.
std::string only_steps_of_ff(std::string_view text) {
  std::string result(text);
  const auto begin = text.find(kFfBegin);
  if (begin == std::string_view::npos) return result;
  bool any = false;
  bool ended = false;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    const bool step = at > begin && !ended && is_step_of_ff(line);
    ended = ended || (any && !step);
    any = any || step;
    if (!step) std::fill_n(result.begin() + static_cast<std::ptrdiff_t>(at), line.size(), ' ');
    at = end + 1;
  }
  return result;
}

class PlanParser {
 public:
  explicit PlanParser(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

  std::optional<std::vector<PddlStep>> parse(const std::vector<PddlTerm>& terms) {
    for (std::size_t begin = 0; begin < terms.size();) {
      std::size_t end = begin + 1;
      while (end < terms.size() && terms[end].where.line == terms[begin].where.line)
        ++end;
      if (!read_line(std::span(terms).subspan(begin, end - begin))) return std::nullopt;
      begin = end;
    }
    const auto timed = [](const PddlStep& step) { return step.begin.has_value(); };
    const auto untimed = std::ranges::find_if_not(steps_, timed);
    if (untimed != steps_.end() && std::ranges::any_of(steps_, timed)) {
      refuse("this step has no time, but others have", untimed->action.where);
      return std::nullopt;
    }
    std::ranges::stable_sort(steps_, {}, [](const PddlStep& step) { return step.begin.value_or(0); });
    return std::move(steps_);
  }

 private:
  using Line = std::span<const PddlTerm>;

  bool refuse(std::string message, const SourceLocation& where) {
    diagnostics_.error("bad-plan", std::move(message), where);
    return false;
  }

  bool read_line(Line line) {
    const PddlTerm& first = line.front();
    if (first.word == "sequentialplan:" || first.word == "timetriggeredplan:") {
      lists_calls_ = true;
      return line.size() == 1 || read_steps(line.subspan(1));
    }
    if (first.word == "partialorderplan:" || first.word == "hierarchicalplan:" || first.word == "stnplan:")
      return refuse(quote(first.word) + " is not supported: give a sequential or a time-stamped plan",
                    first.where);
    return read_steps(line);
  }

  /// "step 0:", "0:", "0.5 :": the time counts for what follows in the line, or stands in a line of its own.
  bool take_time(Line& line) {
    Line rest = line;
    if (rest.front().word == "step" && rest.size() > 1) rest = rest.subspan(1);
    std::string_view word = rest.front().word;
    std::size_t used = 1;
    if (rest.size() > 1 && rest[1].word == ":")
      used = 2;
    else if (word.ends_with(':'))
      word.remove_suffix(1);
    else
      return false;
    const auto time = number_in(word);
    if (!time) return false;
    time_ = time;
    line = rest.subspan(used);
    return true;
  }

  bool read_steps(Line line) {
    const SourceLocation where = line.front().where;
    const bool timed = take_time(line);
    const auto duration =
        std::ranges::find_if(line, [](const PddlTerm& term) { return term.word.starts_with('['); });
    if (!read_duration({duration, line.end()})) return false;
    line = line.first(static_cast<std::size_t>(duration - line.begin()));
    if (line.empty()) return true;  // a time or a duration in a line of its own
    const bool read =
        read_lists(line) || read_calls(line) || ((timed || lists_calls_) && read_words(line, timed));
    time_.reset();
    return read ||
           refuse(
               "this is not a step of a plan such as '(move a b)', '0: (move a b) [1]' or 'move(a, b)'; "
               "give the "
               "plan alone, without what the planner prints beside it",
               where);
  }

  /// "[1]", "[ 1 ]", or "[D:1.0000", of which a comment is the rest; nothing where the plan gives none.
  bool read_duration(Line rest) {
    duration_.reset();
    if (rest.empty()) return true;
    std::string_view word = rest.front().word;
    word.remove_prefix(1);
    if (word.empty() && rest.size() > 1) word = rest[1].word;
    if (word.starts_with("d:")) word.remove_prefix(2);
    if (word.ends_with(']')) word.remove_suffix(1);
    duration_ = number_in(word);
    return duration_ || refuse("a duration is a number of seconds, such as [1.5]", rest.front().where);
  }

  void add(PddlTerm action) { steps_.push_back({std::move(action), time_, duration_}); }

  /// "(move a b)"
  bool read_lists(Line line) {
    if (!std::ranges::all_of(line, &PddlTerm::is_list)) return false;
    for (const PddlTerm& term : line)
      add(term);
    return true;
  }

  /// "move(a,b)", without a blank before the parenthesis.
  bool read_calls(Line line) {
    std::vector<PddlTerm> calls;
    for (std::size_t i = 0; i < line.size(); i += 2) {
      const bool call =
          i + 1 < line.size() && !line[i].is_list() && line[i + 1].is_list() &&
          line[i + 1].where.column == line[i].where.column + static_cast<int>(line[i].word.size());
      if (!call) return false;
      PddlTerm action{{}, {line[i]}, line[i].where};
      for (const PddlTerm& argument : line[i + 1].list)
        add_arguments(action, argument);
      calls.push_back(std::move(action));
    }
    for (PddlTerm& action : calls)
      add(std::move(action));
    return true;
  }

  /// "a,b" and "a," are words to the parser.
  static void add_arguments(PddlTerm& action, const PddlTerm& argument) {
    if (argument.is_list()) return action.list.push_back(argument);
    const std::string_view text = argument.word;
    for (std::size_t at = 0; at < text.size();) {
      const auto end = std::min(text.find(',', at), text.size());
      if (end > at) {
        PddlTerm word{std::string(text.substr(at, end - at)), {}, argument.where};
        word.where.column += static_cast<int>(at);
        action.list.push_back(std::move(word));
      }
      at = end + 1;
    }
  }

  /// "MOVE A B" after a number, as FF writes it, or an action without objects of unified-planning.
  bool read_words(Line line, bool timed) {
    if (std::ranges::any_of(line, &PddlTerm::is_list) || (!timed && line.size() > 1)) return false;
    add(PddlTerm{{}, {line.begin(), line.end()}, line.front().where});
    return true;
  }

  Diagnostics& diagnostics_;
  std::vector<PddlStep> steps_;
  std::optional<double> time_;
  std::optional<double> duration_;
  bool lists_calls_ = false;
};

}  // namespace

std::optional<std::vector<PddlStep>> parse_plan(std::string_view text, const std::string& file,
                                                Diagnostics& diagnostics) {
  const auto terms = parse_pddl(only_steps_of_ff(text), file, diagnostics);
  return terms ? PlanParser(diagnostics).parse(*terms) : std::nullopt;
}

}  // namespace segue::pddl::detail
