// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unfinished_outputs.hpp>

#include <deque>
#include <string>
#include <unordered_map>

namespace segue::convert {

using task_network::NodeId;
using task_network::NodeStatus;
using task_network::OutcomeId;
using type::Value;
using type::ValueMap;

namespace {

/// Plans the mission again along the way that the run took, node by node, so that the plan ends where the run
/// did. Only what is planned together with the node that decides about it may be off the path.
class Replay {
 public:
  Replay(const MissionPlan& plan, const task_network::RunResult& result, const mission::Globals& globals)
      : plan_(plan), result_(result), globals_(globals), again_(plan.from_the_beginning()) {
    for (std::uint32_t i = 0; i < result.nodes.size(); ++i) {
      if (result.nodes[i].status != NodeStatus::Skipped)
        recorded_[plan.network().name_of(NodeId{i})].nodes.push_back(NodeId{i});
    }
  }

  std::vector<Value> outputs() {
    for (std::uint32_t next = 0;;) {
      for (; next < again_->network().size(); ++next)
        end(NodeId{next});
      if (again_->finished()) return again_->final_outputs();
      again_->expand(again_->network(), 1);
      if (next == again_->network().size() && !again_->finished()) return {};
    }
  }

 private:
  /// The nodes of one name that were on the path, in program order.
  struct Recorded {
    std::vector<NodeId> nodes;
    std::size_t next = 0;
  };

  void end(NodeId node) {
    if (again_->off_path(node)) {
      outputs_.resize(index(node) + 1);
      return again_->skipped(node);
    }
    if ((*again_)[node].role == Role::Copy) {
      ValueMap outputs;
      outputs.append(std::string(kValueOutput), copied(node));
      return end(node, task_network::kSuccess, &given_.emplace_back(std::move(outputs)));
    }
    Recorded& recorded = recorded_[again_->network().name_of(node)];
    if (recorded.next == recorded.nodes.size()) return end_unrecorded(node);
    const NodeId then = recorded.nodes[recorded.next++];
    const task_network::NodeResult& result = result_.nodes[index(then)];
    if (result.status == NodeStatus::NotReached) return end_unrecorded(node);
    end(node, translated(result.outcome), result_.outputs[index(then)].get());
  }

  void end(NodeId node, OutcomeId outcome, const Value* outputs) {
    outputs_.resize(index(node) + 1);
    outputs_[index(node)] = outputs;
    again_->ended(node, outcome, outputs);
  }

  Value copied(NodeId node) const {
    const task_network::TaskNetwork& network = again_->network();
    const auto input = [&](std::uint32_t name) -> const Value* {
      for (const task_network::DataInput& each : network.inputs(node)) {
        const Value* outputs = each.input == name ? outputs_[index(each.producer)] : nullptr;
        if (outputs != nullptr) return outputs->find(network.names.name(each.output));
      }
      return nullptr;
    };
    return newest_value((*again_)[node].inputs, input, network.names);
  }

  /// Actions that did not end leave their default outputs; global variables have the values that they have.
  void end_unrecorded(NodeId node) {
    const PlannedNode& planned = (*again_)[node];
    ValueMap outputs;
    if (planned.role == Role::Global)
      outputs.append(std::string(kValueOutput), globals_.get(planned.variable).value_or(Value()));
    if (planned.state == mission::kNoState || planned.role == Role::Change)
      return end(node, task_network::kSuccess, &given_.emplace_back(std::move(outputs)));
    const mission::CompiledState& state = plan_.program().node(planned.state);
    for (std::size_t i = 0; i < state.outputs.size(); ++i) {
      const mission::PortSource& output = plan_.program().node(planned.shown_as).outputs[i];
      auto global = output.global.empty() ? std::nullopt : globals_.get(output.global);
      outputs.append((*state.output_ports)[i].name, std::move(global).value_or(output.fallback));
    }
    // A node that handles the abort would go on, but the run did not.
    const bool aborts = result_.failed && !again_->network()[node].handles_abort;
    end(node, aborts ? task_network::kAborted : task_network::kPreempted,
        &given_.emplace_back(std::move(outputs)));
  }

  /// Both plans number the outcomes of the mission as they meet them.
  OutcomeId translated(OutcomeId outcome) {
    if (outcome == task_network::kSuccess || outcome == task_network::kAborted ||
        outcome == task_network::kPreempted)
      return outcome;
    return again_->network().outcome(
        std::string(plan_.network().outcomes.name(static_cast<std::uint32_t>(outcome))));
  }

  const MissionPlan& plan_;
  const task_network::RunResult& result_;
  const mission::Globals& globals_;
  const std::unique_ptr<MissionPlan> again_;
  std::unordered_map<std::string, Recorded> recorded_;
  std::deque<Value> given_;            ///< outputs that the run did not record
  std::vector<const Value*> outputs_;  ///< by node that has ended; may be null
};

}  // namespace

std::vector<Value> unfinished_outputs(const MissionPlan& plan, const task_network::RunResult& result,
                                      const mission::Globals& globals) {
  if (planted(ConversionFault::ForgetsUnfinishedOutputs)) return {};
  return Replay(plan, result, globals).outputs();
}

}  // namespace segue::convert
