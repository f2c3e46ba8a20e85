// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/draw/diagram.hpp>
#include <segue/task_network/implied.hpp>

#include <fmt/format.h>

#include <algorithm>

namespace segue::draw {

std::string_view to_string(Diagram::Role role) {
  static constexpr std::array<std::string_view, 7> kNames{
      "irreversible", "pure", "sensing", "opaque subtree", "join", "copy", "global read"};
  return kNames.at(static_cast<std::size_t>(role));
}

std::string_view to_string(Diagram::Kind kind) {
  static constexpr std::array<std::string_view, Diagram::kKinds> kNames{
      "data", "condition", "world", "resource", "group", "opaque", "opaque subtree"};
  return kNames.at(static_cast<std::size_t>(kind));
}

std::string to_string(const Diagram::Cause& cause) {
  if (cause.kind == Diagram::Kind::Data) return fmt::format("data {} -> {}", cause.detail, cause.subject);
  const auto text = fmt::format("{} {}", to_string(cause.kind), cause.subject);
  return cause.detail.empty() ? text : text + ": " + cause.detail;
}

Diagram::Counts Diagram::counts() const {
  Counts counts;
  for (const Node& node : nodes) {
    ++counts.roles.at(static_cast<std::size_t>(node.role));
    counts.dependencies += node.before.size();
    counts.implied +=
        static_cast<std::size_t>(std::ranges::count_if(node.before, &Diagram::Dependency::implied));
  }
  return counts;
}

namespace {

using Kind = Diagram::Kind;

/// Puts into words what an order says of a network.
class DiagramMaker {
 public:
  DiagramMaker(const task_network::TaskNetwork& network, const task_network::Order& order,
               const std::vector<task_network::Dependency>& further)
      : network_(network), order_(order), further_(further), implied_(implied_dependencies(network, order)) {}

  Diagram make(std::size_t most) {
    Diagram diagram;
    diagram.name = network_.name;
    diagram.nodes_in_all = network_.size();
    const auto count = std::min<std::size_t>(most, network_.size());
    diagram.nodes.reserve(count);
    auto also = further_.begin();
    std::size_t place = 0;  // of a dependency in the order
    for (std::uint32_t i = 0; i < count; ++i) {
      const task_network::NodeId node{i};
      reasons_.clear();
      for (const task_network::Dependency& dependency : order_.before(node))
        reasons_.push_back({&dependency, implied_[place++]});
      for (; also != further_.end() && also->to == node; ++also)
        reasons_.push_back({&*also, true});
      diagram.nodes.push_back(described(node));
      join_reasons(diagram.nodes.back());
    }
    return diagram;
  }

 private:
  [[nodiscard]] Diagram::Node described(task_network::NodeId node) const {
    const task_network::NodeRecord& entry = network_[node];
    Diagram::Node made{network_.label(node)};
    made.duration = entry.duration;
    made.strict = entry.strict;
    if (entry.opaque && !entry.opaque_subtree) made.note = "opaque";
    if (entry.opaque_subtree)
      made.role = Diagram::Role::OpaqueSubtree;
    else if (entry.kind != ActionClass::Irreversible)
      made.role = entry.kind == ActionClass::Pure ? Diagram::Role::Pure : Diagram::Role::Sensing;
    for (const task_network::Claim& claim : network_.claims(node)) {
      const auto name = network_.resources.name(claim.resource);
      if (std::ranges::find(made.units, name, &Diagram::Units::resource) == made.units.end())
        made.units.push_back({name, network_.resources[claim.resource].observed});
    }
    return made;
  }

  /// One entry for two nodes; it is implied where each reason that the engine keeps is.
  void join_reasons(Diagram::Node& node) {
    std::ranges::stable_sort(reasons_, {}, [](const NotedReason& noted) { return noted.dependency->from; });
    for (const NotedReason& noted : reasons_) {
      const std::uint32_t from = index(noted.dependency->from);
      if (node.before.empty() || node.before.back().from != from)
        node.before.push_back({from, {}, true, false});
      Diagram::Dependency& entry = node.before.back();
      entry.implied = entry.implied && noted.implied;
      entry.holds_start = entry.holds_start || holds_start(network_, *noted.dependency);
      entry.causes.push_back(cause(*noted.dependency));
    }
  }

  [[nodiscard]] Diagram::Cause cause(const task_network::Dependency& dependency) const {
    const std::string subject = subject_text(network_, dependency);
    switch (dependency.reason()) {
      case task_network::Reason::Data:
        return {Kind::Data, subject, output_of(dependency)};
      case task_network::Reason::Condition:
        return {Kind::Condition, subject, {}};
      case task_network::Reason::Fact:
        return {Kind::World, subject, on_fact(dependency)};
      case task_network::Reason::Resource:
        return on_resource(task_network::ResourceId{dependency.subject}, subject);
      case task_network::Reason::Place:
        break;
    }
    const task_network::NodeId toucher = network_[dependency.to].opaque ? dependency.to : dependency.from;
    if (network_[toucher].opaque_subtree)
      return {Kind::OpaqueSubtree, network_.label(toucher), "it may touch anything", index(toucher)};
    const bool silent = network_.accesses(toucher).empty() && network_.claims(toucher).empty();
    return {Kind::Opaque, network_.label(toucher),
            silent ? "it declares no facts and no resources, so it may touch anything"
                   : "it may touch what it does not declare",
            index(toucher)};
  }

  [[nodiscard]] std::string output_of(const task_network::Dependency& dependency) const {
    for (const task_network::DataInput& input : network_.inputs(dependency.to)) {
      if (input.producer == dependency.from && input.input == dependency.subject)
        return network_.names.name(input.output);
    }
    return {};
  }

  [[nodiscard]] std::string use_of(task_network::NodeId node, task_network::FactId fact) const {
    const auto accesses = network_.accesses(node);
    const auto access = std::ranges::find(accesses, fact, &task_network::Access::fact);
    if (access == accesses.end()) return "touched";
    std::string text;
    if (access->reads) text = access->needed ? "relied on" : "relied on as false";
    if (!access->writes) return text;
    if (access->reads) text += " and ";
    text += network_[node].uncertain ? "probably made " : "made ";
    return text + (access->value ? "true" : "false");
  }
  [[nodiscard]] std::string on_fact(const task_network::Dependency& dependency) const {
    const task_network::FactId fact{dependency.subject};
    return use_of(dependency.from, fact) + " there, " + use_of(dependency.to, fact) + " here";
  }

  [[nodiscard]] Diagram::Cause on_resource(task_network::ResourceId id, const std::string& subject) const {
    const task_network::ResourceRecord& resource = network_.resources[id];
    if (resource.grouped)
      return {Kind::Group, subject, "held over several nodes, whose starts keep the program's order"};
    if (resource.varies)
      return {Kind::Resource, subject, "units come and go, so starts keep the program's order"};
    return {Kind::Resource, subject, "what is irreversible uses it in the program's order"};
  }

  const task_network::TaskNetwork& network_;
  const task_network::Order& order_;
  const std::vector<task_network::Dependency>& further_;
  const std::vector<bool> implied_;
  struct NotedReason {
    const task_network::Dependency* dependency = nullptr;
    bool implied = false;
  };
  std::vector<NotedReason> reasons_;  ///< of the node at hand
};

}  // namespace

Diagram diagram_of(const task_network::TaskNetwork& network, const task_network::Order& order,
                   const std::vector<task_network::Dependency>& further, std::size_t most) {
  return DiagramMaker(network, order, further).make(most);
}

}  // namespace segue::draw
