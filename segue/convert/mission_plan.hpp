// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/cdtn/concurrent_engine.hpp>
#include <segue/cdtn/run_result.hpp>
#include <segue/convert/symbol.hpp>
#include <segue/mission/program.hpp>

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Missions as task networks: what a state machine does, unrolled into nodes that run concurrently.
namespace segue::convert {

/// Action: a leaf. OpaqueSubtree: a state that runs by itself, one thing after the other, with all that is in
/// it. Join: tells whether one of several ways to a state was taken. Copy: an input or a constant that a
/// container hands on under a condition. Global: reads a global variable.
enum class Role : std::uint8_t { Action, OpaqueSubtree, Join, Copy, Global };

/// Where a value comes from: the first input that is there, the newest first; else `rest`.
struct ValueSource {
  struct Feed {
    std::uint32_t input = 0;  ///< of TaskNetwork::names
    Defaults defaults;
  };
  std::vector<Feed> feeds;
  Defaults rest;
};

/// How a state beside a decider may have ended: as `outcome`, if that input says `reached`.
struct BranchEnd {
  std::uint32_t input = cdtn::kNone;  ///< none: that is certain
  cdtn::OutcomeId reached{};
  mission::Outcome outcome = 0;
  ValueSource error;
};
struct BranchSource {
  mission::StateIndex state = mission::kNoState;
  std::vector<BranchEnd> ends;
};

/// What a node of the network is in the mission.
struct PlannedNode {
  Role role = Role::Action;
  mission::StateIndex state = mission::kNoState;
  std::uint32_t iteration = 0;      ///< how often it stands in the plan before
  std::string_view path;            ///< in TaskNetwork::names; empty: the mission itself, or no state
  std::vector<ValueSource> inputs;  ///< by port; of a Copy or Global: one, what it hands on
  ValueSource error_before;
  ValueSource begun;  ///< how often the state has begun, where its action asks for that
  bool counts = false;
  std::vector<BranchSource> branches;                             ///< deciders
  std::vector<std::pair<std::uint32_t, cdtn::OutcomeId>> joined;  ///< Join: inputs and what they must say
  std::string global;
  std::string refused;  ///< why the action will not begin, whatever holds then
};

/// Names of outputs beside those of ports.
inline constexpr std::string_view kOutcomeOutput = "#outcome";  ///< an OutcomeId, of nodes that branch
inline constexpr std::string_view kErrorOutput = "#error";      ///< only where it aborted
inline constexpr std::string_view kCountOutput = "#count";
inline constexpr std::string_view kValueOutput = "value";

/// Why a state is a OpaqueSubtree.
struct OpaqueSubtreeReason {
  enum class Kind : std::uint8_t {
    None,
    Preemptive,         ///< a preemptive container
    HandlesPreemption,  ///< `state`, in it, has a transition for its preemption
    OpaqueBeside        ///< a barrier, and `state`, in it, may touch anything
  };
  Kind kind = Kind::None;
  mission::StateIndex state = mission::kNoState;
};

class Unroller;

/// A mission on its way to be a task network. Grows while it runs: loops are unrolled ahead of what is
/// decided, more iterations the longer they go on; what the mission does not expect (aborts, other outcomes
/// than declared) is planned for once it has happened, where it leads back. One thread.
class MissionPlan final : public cdtn::Expansion {
 public:
  /// `inputs` by port of the root, null for its default; `facts` hold at the beginning, or do not, whatever
  /// the mission says of its world. TypeMismatch for an input of another type, InvalidArgument for one too
  /// many and for a fact that is none.
  static Result<std::unique_ptr<MissionPlan>> create(std::shared_ptr<const mission::Program> program,
                                                     std::vector<type::Value> inputs = {},
                                                     const std::vector<mission::Fact>& facts = {});
  ~MissionPlan() override;

  void expand(cdtn::TaskNetwork& network, std::size_t wanted) override;
  void ended(cdtn::NodeId node, cdtn::OutcomeId outcome, const type::Value* outputs) override;
  [[nodiscard]] bool finished() const override;

  [[nodiscard]] cdtn::TaskNetwork& network() { return network_; }
  [[nodiscard]] const cdtn::TaskNetwork& network() const { return network_; }
  [[nodiscard]] const mission::Program& program() const { return *program_; }
  [[nodiscard]] const std::shared_ptr<const mission::Program>& shared_program() const { return program_; }
  [[nodiscard]] const PlannedNode& operator[](cdtn::NodeId node) const { return nodes_[index(node)]; }
  /// Why it could not go on when it last tried: "" where it had planned as much as was wanted.
  [[nodiscard]] const std::string& waits_for() const { return waits_for_; }
  [[nodiscard]] OpaqueSubtreeReason subtree_reason(mission::StateIndex state) const;
  /// The number of an outcome of that node's state.
  [[nodiscard]] mission::Outcome outcome(cdtn::NodeId node, cdtn::OutcomeId outcome) const;

  /// How the mission ended. Requires a run to its end.
  [[nodiscard]] mission::Outcome final_outcome(const cdtn::RunResult& result);
  [[nodiscard]] std::vector<type::Value> final_outputs();

 private:
  friend class Unroller;
  explicit MissionPlan(std::shared_ptr<const mission::Program> program);

  std::shared_ptr<const mission::Program> program_;
  cdtn::TaskNetwork network_;
  std::deque<PlannedNode> nodes_;
  std::string waits_for_;
  std::unique_ptr<Unroller> unroller_;
};

}  // namespace segue::convert
