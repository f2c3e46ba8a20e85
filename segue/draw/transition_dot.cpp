// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <set>
#include <utility>

#include <segue/draw/dot.hpp>
#include <segue/draw/transition_picture.hpp>
#include <segue/draw/transition_schedule.hpp>
#include <segue/draw/transition_style.hpp>

namespace segue::draw {

namespace {

std::string cluster(const model::Transition& transition, model::Phase phase, const std::set<int>& critical) {
  std::string nodes;
  for (const model::Action& action : transition.actions) {
    if (action.phase != phase) continue;
    const KindStyle& style = style_of(action.kind);
    nodes += fmt::format("    {} [label={}, fillcolor=\"{}\", fontcolor=\"{}\"{}];\n", action.id,
                         dot_quoted(action.label()), style.fill, style.text,
                         critical.contains(action.id)
                             ? ", penwidth=3, color=\"" + std::string(kCriticalColour) + '"'
                             : std::string());
  }
  if (nodes.empty()) return {};
  return fmt::format("  subgraph cluster_{0} {{\n    label=\"{0}\"; style=filled; color=\"{1}\";\n{2}  }}\n",
                     to_string(phase), tint_of(phase), nodes);
}

}  // namespace

std::string to_dot(const model::Transition& transition, const std::vector<Duration>& durations) {
  const Schedule schedule = schedule_of(transition, durations);
  std::set<int> critical;
  std::set<std::pair<int, int>> path;
  int last = 0;
  for (const int place : schedule.critical) {
    const int id = transition.actions[static_cast<std::size_t>(place)].id;
    critical.insert(id);
    path.emplace(last, id);
    last = id;
  }
  std::string text =
      "digraph transition {\n  rankdir=LR;\n  node [shape=box, style=filled, fontname=\"sans-serif\"];\n";
  for (const auto phase : {model::Phase::Prepare, model::Phase::Commit, model::Phase::Retire})
    text += cluster(transition, phase, critical);
  for (const model::Action& action : transition.actions) {
    for (const int before : action.after) {
      const bool decides = path.contains({before, action.id});
      text +=
          fmt::format("  {} -> {}{};\n", before, action.id,
                      decides ? fmt::format(" [penwidth=3, color=\"{}\"]", kCriticalColour) : std::string());
    }
  }
  return text + "}\n";
}

}  // namespace segue::draw
