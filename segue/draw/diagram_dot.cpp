// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <map>

#include <segue/draw/diagram_style.hpp>
#include <segue/draw/dot.hpp>

namespace segue::draw {

std::string tooltip_of(const Diagram& diagram, const Diagram::Dependency& dependency, std::uint32_t to) {
  std::string text = fmt::format("{} after {}", diagram.nodes[to].name, diagram.nodes[dependency.from].name);
  for (const Diagram::Cause& cause : dependency.causes)
    text += '\n' + to_string(cause);
  if (!dependency.holds_start) text += "\nit may run speculatively; only its result waits";
  return text;
}

std::string tooltip_of(const Diagram::Node& node) {
  std::string text(to_string(node.role));
  if (!node.note.empty()) text += ", " + node.note;
  if (node.duration > Duration::zero()) text += ", " + format_duration(node.duration);
  return text;
}

std::string caption_of(const Diagram& diagram) {
  const std::size_t drawn = std::min(diagram.nodes.size(), kMostDrawn);
  std::string text;
  if (drawn < diagram.nodes_in_all)
    text = fmt::format("the first {} of {} nodes; ", drawn, diagram.nodes_in_all);
  const Diagram::Counts counts = diagram.counts();
  if (counts.implied > 0) text += fmt::format("without {} dependencies that others imply; ", counts.implied);
  if (diagram.strict) text += "irreversible nodes start when nothing before them can fail any more; ";
  if (!diagram.waits_for.empty())
    text += "goes on when it is known: " + diagram.waits_for + "; ";
  else if (!diagram.complete)
    text += "goes on behind the horizon; ";
  if (!text.empty()) text.resize(text.size() - 2);
  return text;
}

namespace {

/// Draws nodes within the clusters of their containers.
struct Cluster {
  std::map<std::string, Cluster> inside;
  std::vector<std::uint32_t> nodes;
};

class DotWriter {
 public:
  explicit DotWriter(const Diagram& diagram)
      : diagram_(diagram), drawn_(static_cast<std::uint32_t>(std::min(diagram.nodes.size(), kMostDrawn))) {}

  std::string write() {
    fmt::format_to(
        out(),
        "digraph plan {{\n  rankdir=LR;\n  label={};\n  node [shape=box, style=filled, "
        "fontname=\"sans-serif\"];\n  edge [fontname=\"sans-serif\", fontsize=10];\n",
        dot_quoted(diagram_.name + (caption_of(diagram_).empty() ? "" : "\n" + caption_of(diagram_))));
    Cluster whole;
    for (std::uint32_t i = 0; i < drawn_; ++i)
      cluster_of(whole, diagram_.nodes[i].container).nodes.push_back(i);
    write(whole, "  ");
    for (std::uint32_t i = 0; i < drawn_; ++i) {
      for (const Diagram::Dependency& dependency : diagram_.nodes[i].before)
        if (!dependency.implied) write(dependency, i);
    }
    return text_ + "}\n";
  }

 private:
  std::back_insert_iterator<std::string> out() { return std::back_inserter(text_); }

  static Cluster& cluster_of(Cluster& whole, std::string_view path) {
    Cluster* at = &whole;
    while (!path.empty()) {
      const auto slash = path.find('/');
      at = &at->inside[std::string(path.substr(0, slash))];
      path = slash == std::string_view::npos ? std::string_view() : path.substr(slash + 1);
    }
    return *at;
  }

  void write(const Cluster& cluster, const std::string& indent) {
    for (const std::uint32_t node : cluster.nodes) {
      const Diagram::Node& entry = diagram_.nodes[node];
      const RoleStyle style = style_of(entry.role);
      fmt::format_to(out(), "{}{} [label={}, fillcolor=\"{}\", fontcolor=\"{}\", tooltip={}];\n", indent,
                     node, dot_quoted(entry.name), style.fill, style.text, dot_quoted(tooltip_of(entry)));
    }
    for (const auto& [name, inside] : cluster.inside) {
      fmt::format_to(out(), "{0}subgraph cluster_{1} {{\n{0}  label={2}; color=\"#999999\";\n", indent,
                     clusters_++, dot_quoted(name));
      write(inside, indent + "  ");
      fmt::format_to(out(), "{}}}\n", indent);
    }
  }

  void write(const Diagram::Dependency& dependency, std::uint32_t to) {
    const Diagram::Cause& cause = dependency.causes.front();
    const bool named = cause.kind != Diagram::Kind::Opaque && cause.kind != Diagram::Kind::OpaqueSubtree;
    fmt::format_to(out(), "  {} -> {} [color=\"{}\", fontcolor=\"{}\", label={}, tooltip={}{}];\n",
                   dependency.from, to, colour_of(cause.kind), colour_of(cause.kind),
                   dot_quoted(named ? cause.subject : std::string(to_string(cause.kind))),
                   dot_quoted(tooltip_of(diagram_, dependency, to)),
                   dependency.holds_start ? "" : ", style=dashed");
  }

  const Diagram& diagram_;
  const std::uint32_t drawn_;
  std::string text_;
  std::size_t clusters_ = 0;
};

}  // namespace

std::string to_dot(const Diagram& diagram) {
  return DotWriter(diagram).write();
}

}  // namespace segue::draw
