// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/diagram.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>

namespace segue::draw {

namespace {

using type::Value;
using type::ValueMap;

/// An opaque subtree in JSON, whatever people read.
constexpr std::string_view kSubtreeKey = "routine";

/// Lines of what may happen although something earlier fails, and names in a line.
constexpr std::size_t kMostListed = 12;
constexpr std::size_t kMostNamed = 6;

constexpr std::string_view kStrict = "starts when nothing before it can fail any more";

std::string plural(std::size_t count, std::string_view one) {
  return fmt::format("{} {}{}", count, one, count == 1 ? "" : one.ends_with('y') ? "" : "s");
}

bool waits_for_safety(const Diagram& diagram, const Diagram::Node& node) {
  return node.strict || (diagram.strict && (node.role == Diagram::Role::Irreversible ||
                                            node.role == Diagram::Role::OpaqueSubtree));
}

std::string summary(const Diagram& diagram) {
  const Diagram::Counts counts = diagram.counts();
  std::string roles;
  for (std::size_t i = 0; i < counts.roles.size(); ++i) {
    if (counts.roles.at(i) == 0) continue;
    if (!roles.empty()) roles += ", ";
    roles += fmt::format("{} {}", counts.roles.at(i), to_string(static_cast<Diagram::Role>(i)));
  }
  return fmt::format("{}: {}{}; {} dependencies, {} of them implied by others\n", diagram.name,
                     plural(diagram.nodes.size(), "node"), roles.empty() ? "" : " (" + roles + ")",
                     counts.dependencies, counts.implied);
}

void append(std::string& text, const Diagram& diagram, const Diagram::Dependency& dependency) {
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "    after {} {}", dependency.from, diagram.nodes[dependency.from].name);
  char separator = ':';
  for (const Diagram::Cause& cause : dependency.causes) {
    fmt::format_to(out, "{} {}", separator, to_string(cause));
    separator = ';';
  }
  if (!dependency.holds_start) text += "; may run ahead";
  text += dependency.implied ? " [implied]\n" : "\n";
}

Value to_value(const Diagram& diagram, const Diagram::Dependency& dependency) {
  Value::List causes;
  for (const Diagram::Cause& cause : dependency.causes) {
    ValueMap map;
    map.append("kind", cause.kind == Diagram::Kind::OpaqueSubtree ? kSubtreeKey : to_string(cause.kind));
    map.append("subject", cause.subject);
    map.append(cause.kind == Diagram::Kind::Data ? "output" : "detail", cause.detail);
    causes.emplace_back(std::move(map));
  }
  ValueMap map;
  map.append("number", static_cast<std::uint64_t>(dependency.from));
  map.append("node", diagram.nodes[dependency.from].name);
  map.append("holds_start", dependency.holds_start);
  map.append("implied", dependency.implied);
  map.append("because", std::move(causes));
  return map;
}

}  // namespace

std::string ahead_text(const std::vector<task_network::NamedActsAhead>& ahead, bool complete) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (!ahead.empty())
    text = "In a concurrent run that is not strict, these may happen although something earlier fails:\n";
  for (const task_network::NamedActsAhead& each :
       std::span(ahead).first(std::min(ahead.size(), kMostListed))) {
    const auto named = std::span(each.fails).first(std::min(each.fails.size(), kMostNamed));
    const std::size_t left = each.fails.size() - named.size();
    fmt::format_to(out, "    {}, although {}{}{} fails\n", each.acts, each.fails.size() > 1 ? "one of " : "",
                   fmt::join(named, ", "), left == 0 ? "" : fmt::format(" or {} more", left));
  }
  if (ahead.size() > kMostListed)
    fmt::format_to(out, "    and {} more (--json lists all)\n", ahead.size() - kMostListed);
  if (!complete)
    text += "The mission is too long to find all that may happen although something earlier fails\n";
  return text;
}

std::string senses_text(const std::vector<task_network::NamedSensesAhead>& senses) {
  std::string text;
  const auto out = std::back_inserter(text);
  if (!senses.empty()) text = "In a concurrent run these may sense before something earlier has been done:\n";
  for (const task_network::NamedSensesAhead& each :
       std::span(senses).first(std::min(senses.size(), kMostListed))) {
    const auto named = std::span(each.acts).first(std::min(each.acts.size(), kMostNamed));
    const std::size_t left = each.acts.size() - named.size();
    fmt::format_to(out, "    {}, before {}{}\n", each.senses, fmt::join(named, ", "),
                   left == 0 ? "" : fmt::format(" and {} more", left));
  }
  if (senses.size() > kMostListed)
    fmt::format_to(out, "    and {} more (--json lists all)\n", senses.size() - kMostListed);
  return text;
}

Value senses_value(const std::vector<task_network::NamedSensesAhead>& senses) {
  Value::List list;
  for (const task_network::NamedSensesAhead& each : senses)
    list.push_back(Value::map(
        {{"senses", each.senses}, {"before", Value(Value::List(each.acts.begin(), each.acts.end()))}}));
  return list;
}

Value ahead_value(const std::vector<task_network::NamedActsAhead>& ahead) {
  Value::List list;
  for (const task_network::NamedActsAhead& each : ahead) {
    list.push_back(
        Value::map({{"happens", each.acts},
                    {"although_fails", Value(Value::List(each.fails.begin(), each.fails.end()))}}));
  }
  return list;
}

std::string to_text(const Diagram& diagram) {
  std::string text = summary(diagram);
  const auto out = std::back_inserter(text);
  for (std::size_t i = 0; i < diagram.nodes.size(); ++i) {
    const Diagram::Node& node = diagram.nodes[i];
    fmt::format_to(out, "{} {}: {}", i, node.name, to_string(node.role));
    if (!node.note.empty()) fmt::format_to(out, ", {}", node.note);
    if (node.duration > Duration::zero()) fmt::format_to(out, ", {}", format_duration(node.duration));
    if (waits_for_safety(diagram, node)) fmt::format_to(out, "; strict: {}", kStrict);
    text += '\n';
    for (const bool implied : {false, true}) {
      for (const Diagram::Dependency& dependency : node.before)
        if (dependency.implied == implied) append(text, diagram, dependency);
    }
  }
  if (diagram.nodes_in_all > diagram.nodes.size())
    fmt::format_to(out, "{} more nodes are not shown\n", diagram.nodes_in_all - diagram.nodes.size());
  if (!diagram.waits_for.empty())
    fmt::format_to(out, "It goes on when it is known: {}\n", diagram.waits_for);
  else if (!diagram.complete)
    text += "It goes on; this is as far as the horizon reaches\n";
  return text + ahead_text(diagram.ahead, diagram.ahead_complete) + senses_text(diagram.senses_ahead);
}

Value to_value(const Diagram& diagram) {
  Value::List nodes;
  for (std::size_t i = 0; i < diagram.nodes.size(); ++i) {
    const Diagram::Node& node = diagram.nodes[i];
    Value::List before;
    for (const Diagram::Dependency& dependency : node.before)
      before.push_back(to_value(diagram, dependency));
    ValueMap map;
    map.append("number", static_cast<std::uint64_t>(i));
    map.append("name", node.name);
    map.append("role", std::string(to_string(node.role)));
    map.append("note", node.note);
    map.append("in", node.container);
    map.append("duration_s", std::chrono::duration<double>(node.duration).count());
    map.append("strict", waits_for_safety(diagram, node));
    map.append("after", std::move(before));
    nodes.emplace_back(std::move(map));
  }
  const Diagram::Counts counts = diagram.counts();
  ValueMap map;
  map.append("name", diagram.name);
  map.append("nodes", std::move(nodes));
  map.append("nodes_in_all", static_cast<std::uint64_t>(diagram.nodes_in_all));
  map.append("dependencies", static_cast<std::uint64_t>(counts.dependencies));
  map.append("implied", static_cast<std::uint64_t>(counts.implied));
  map.append("complete", diagram.complete);
  map.append("waits_for", diagram.waits_for);
  map.append("ahead", ahead_value(diagram.ahead));
  map.append("senses_ahead", senses_value(diagram.senses_ahead));
  return map;
}

}  // namespace segue::draw
