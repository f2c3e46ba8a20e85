// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/fault.hpp>
#include <segue/convert/unfinished_outputs.hpp>

#include <string>
#include <unordered_map>

namespace segue::convert {

using cdtn::NodeId;
using cdtn::NodeStatus;
using cdtn::OutcomeId;
using type::Value;
using type::ValueMap;

namespace {

/// Plans the mission again along the way that the run took. Since each end is known when its node is planned,
/// nothing is planned that is not on the path, and the plan ends where the run did.
class Replay {
 public:
  Replay(const MissionPlan& plan, const cdtn::RunResult& result, const mission::Globals& globals)
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
    Recorded& recorded = recorded_[again_->network().name_of(node)];
    if (recorded.next == recorded.nodes.size()) return end_unrecorded(node);
    const NodeId then = recorded.nodes[recorded.next++];
    const cdtn::NodeResult& result = result_.nodes[index(then)];
    if (result.status == NodeStatus::NotReached) return end_unrecorded(node);
    again_->ended(node, translated(result.outcome), result_.outputs[index(then)].get());
  }

  /// Actions that did not end leave their default outputs; global variables have the values that they have.
  void end_unrecorded(NodeId node) {
    const PlannedNode& planned = (*again_)[node];
    ValueMap outputs;
    if (planned.role == Role::Global)
      outputs.append(std::string(kValueOutput), globals_.get(planned.global).value_or(Value()));
    if (planned.state == mission::kNoState)
      return again_->ended(node, cdtn::kSuccess, &(given_ = Value(std::move(outputs))));
    const mission::CompiledState& state = plan_.program().node(planned.state);
    for (std::size_t i = 0; i < state.outputs.size(); ++i) {
      const mission::PortSource& output = plan_.program().node(planned.shown_as).outputs[i];
      auto global = output.global.empty() ? std::nullopt : globals_.get(output.global);
      outputs.append((*state.output_ports)[i].name, global ? std::move(*global) : output.fallback);
    }
    again_->ended(node, result_.failed ? cdtn::kAborted : cdtn::kPreempted,
                  &(given_ = Value(std::move(outputs))));
  }

  /// Both plans number the outcomes of the mission as they meet them.
  OutcomeId translated(OutcomeId outcome) {
    if (outcome == cdtn::kSuccess || outcome == cdtn::kAborted || outcome == cdtn::kPreempted) return outcome;
    return again_->network().outcome(
        std::string(plan_.network().outcomes.name(static_cast<std::uint32_t>(outcome))));
  }

  const MissionPlan& plan_;
  const cdtn::RunResult& result_;
  const mission::Globals& globals_;
  const std::unique_ptr<MissionPlan> again_;
  std::unordered_map<std::string, Recorded> recorded_;
  Value given_;
};

}  // namespace

std::vector<Value> unfinished_outputs(const MissionPlan& plan, const cdtn::RunResult& result,
                                      const mission::Globals& globals) {
  if (planted(ConversionFault::ForgetsUnfinishedOutputs)) return {};
  return Replay(plan, result, globals).outputs();
}

}  // namespace segue::convert
