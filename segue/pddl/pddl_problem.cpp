// SPDX-License-Identifier: Apache-2.0
#include <segue/pddl/pddl_problem.hpp>

#include <segue/pddl/pddl_text.hpp>

#include <algorithm>

namespace segue::pddl {

namespace {

using detail::PddlTerm;

bool says(const PddlTerm& term, const ObservedAtom& fact) {
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

std::optional<std::string> problem_with(const PddlText& problem, std::span<const ObservedAtom> facts,
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
  for (const ObservedAtom& fact : facts) {
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
