// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/convert/in_sequence.hpp>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace segue::convert {

using task_network::NodeId;
using task_network::NodeStatus;

namespace {

/// The most names in a sentence; further ones are only counted.
constexpr std::size_t kMostNames = 4;

/// Why an action may touch anything.
enum class Cause : std::uint8_t { Silent, RestsOnAnything, ReadsWorld };
constexpr std::array<std::pair<std::string_view, std::string_view>, 3> kTexts{{
    {"it declares no facts and no resources, so it may touch anything",
     "they declare no facts and no resources, so they may touch anything"},
    {"it senses and declares no facts and no resources, so it may rely on anything",
     "they sense and declare no facts and no resources, so they may rely on anything"},
    {"it reads the whole world and is not pure", "they read the whole world and are not pure"},
}};

class Causes {
 public:
  Causes(const MissionPlan& plan, const task_network::Order& order, const task_network::RunResult& result)
      : plan_(plan), order_(order), result_(result) {}

  std::vector<std::string> find() {
    std::vector<std::string> texts;
    for (std::uint32_t i = 0; i < result_.nodes.size(); ++i) {
      const PlannedNode& planned = plan_[NodeId{i}];
      if (!counts(NodeId{i}) || !plan_.network()[NodeId{i}].opaque) continue;
      if (planned.role == Role::OpaqueSubtree)
        add(texts, as_written(planned));
      else if (planned.role == Role::Action && others_wait(NodeId{i}))
        add(alone_[static_cast<std::size_t>(cause(planned))], std::string(planned.path));
    }
    for (std::size_t i = 0; i < alone_.size(); ++i) {
      if (!alone_[i].empty()) texts.push_back(alone(alone_[i], i));
    }
    return texts;
  }

 private:
  static void add(std::vector<std::string>& texts, std::string text) {
    if (std::ranges::find(texts, text) == texts.end()) texts.push_back(std::move(text));
  }

  [[nodiscard]] bool counts(NodeId node) const {
    const NodeStatus status = result_.nodes[index(node)].status;
    const Role role = plan_[node].role;
    return status != NodeStatus::Skipped && status != NodeStatus::NotReached &&
           (role == Role::Action || role == Role::OpaqueSubtree);
  }

  /// Whether it had to wait for another action because of its place, or another one for it.
  [[nodiscard]] bool others_wait(NodeId node) const {
    const auto of_place = [](const task_network::Dependency& each) {
      return each.reason() == task_network::Reason::Place;
    };
    for (const task_network::Dependency& each : order_.before(node)) {
      if (of_place(each) && counts(each.from)) return true;
    }
    for (const task_network::Dependency& each : order_.after(node)) {
      if (of_place(each) && index(each.to) < result_.nodes.size() && counts(each.to)) return true;
    }
    return false;
  }

  [[nodiscard]] Cause cause(const PlannedNode& planned) const {
    const mission::Program& program = plan_.program();
    const mission::Action& action = program.mission().actions[program.node(planned.state).action];
    if (action.reads_world) return Cause::ReadsWorld;
    return action.action_class() == ActionClass::Sensing ? Cause::RestsOnAnything : Cause::Silent;
  }

  [[nodiscard]] std::string as_written(const PlannedNode& planned) const {
    const std::string name =
        planned.path.empty() ? plan_.program().mission().name : std::string(planned.path);
    return name + " runs sequentially, " + text_of(plan_.subtree_reason(planned.state), plan_.program());
  }

  [[nodiscard]] static std::string alone(std::vector<std::string> names, std::size_t cause) {
    const bool one = names.size() == 1;
    if (names.size() > kMostNames) {
      const std::size_t more = names.size() - kMostNames + 1;
      names.resize(kMostNames - 1);
      names.push_back(std::to_string(more) + " more");
    }
    const auto& [of_one, of_several] = kTexts[cause];
    return listed(names) + (one ? " runs alone: " : " run alone: ") + std::string(one ? of_one : of_several);
  }

  const MissionPlan& plan_;
  const task_network::Order& order_;
  const task_network::RunResult& result_;
  std::array<std::vector<std::string>, 3> alone_;  ///< by cause: paths
};

}  // namespace

std::vector<std::string> why_in_sequence(const MissionPlan& plan, const task_network::Order& order,
                                         const task_network::RunResult& result) {
  return Causes(plan, order, result).find();
}

}  // namespace segue::convert
