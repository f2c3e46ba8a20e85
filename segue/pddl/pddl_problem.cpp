// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl_problem.hpp>

#include <segue/pddl/pddl_text.hpp>

#include <algorithm>

namespace segue::pddl {

namespace {

using detail::PddlTerm;

bool says(const PddlTerm& term, const GroundAtom& fact) {
  const PddlTerm& atom = term.begins_with("not") && term.list.size() == 2 ? term.list[1] : term;
  return std::ranges::equal(atom.list, fact.words, {}, &PddlTerm::word);
}

void append(std::string& text, const PddlTerm& term) {
  if (!term.is_list()) {
    text += term.word;
    return;
  }
  text += '(';
  for (std::size_t i = 0; i < term.list.size(); ++i) {
    const bool is_section = i > 0 && term.list[i].is_list() && !term.list[i].list.empty() &&
                            term.list[i].list.front().word.starts_with(':');
    if (i > 0) text += is_section ? "\n  " : " ";
    append(text, term.list[i]);
  }
  text += ')';
}

}  // namespace

namespace {

/// "on(red,table)" as "on", "red", "table".
std::vector<std::string> words_of(std::string_view fact) {
  std::vector<std::string> words(1);
  for (const char c : fact) {
    if (c == '(' || c == ',') {
      words.emplace_back();
    } else if (c != ')' && c != ' ') {
      words.back() += c;
    }
  }
  if (words.back().empty()) words.pop_back();
  return words;
}

}  // namespace

std::vector<GroundAtom> effects_of(const PddlPlan& plan, std::size_t steps) {
  std::vector<GroundAtom> effects;
  for (std::uint32_t i = 0; i < std::min(steps, plan.steps.size()); ++i) {
    for (const task_network::Access& access : plan.network.accesses(task_network::NodeId{i})) {
      if (access.writes) effects.push_back({words_of(plan.network.facts.text(access.fact)), access.value});
    }
  }
  return effects;
}

std::optional<std::string> problem_with(const PddlText& problem, std::span<const GroundAtom> facts,
                                        Diagnostics& diagnostics) {
  auto terms = detail::parse_pddl(problem.text, problem.file, diagnostics);
  if (!terms) return std::nullopt;
  PddlTerm* init = nullptr;
  if (terms->size() == 1 && terms->front().begins_with("define")) {
    for (PddlTerm& section : terms->front().list) {
      if (section.begins_with(":init")) init = &section;
    }
  }
  if (init == nullptr) {
    diagnostics.error("bad-definition", "expected (define (problem ...) ... (:init ...) ...)",
                      {problem.file, 1, 1});
    return std::nullopt;
  }
  for (const GroundAtom& fact : facts) {
    std::erase_if(init->list, [&](const PddlTerm& term) { return says(term, fact); });
    if (!fact.holds) continue;
    PddlTerm atom{{}, {}, init->where};
    for (const std::string& word : fact.words)
      atom.list.push_back({word, {}, init->where});
    init->list.push_back(std::move(atom));
  }
  std::string text;
  append(text, terms->front());
  return text + "\n";
}

}  // namespace segue::pddl
