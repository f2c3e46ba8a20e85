// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_robot/upcoming_controllers.hpp>

#include <segue/mission/controllers.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/outcome_likelihoods.hpp>
#include <segue/model/reader.hpp>

#include <algorithm>
#include <map>
#include <optional>
#include <queue>
#include <utility>

namespace segue::mission {

namespace {

constexpr double kLeast = 0.01;
constexpr int kMostRounds = 3;  ///< of a loop

/// A state that begins with some probability, some time from now.
struct Step {
  StateIndex state = kNoState;
  double probability = 0;
  Duration after{};
  bool operator<(const Step& other) const { return probability < other.probability; }
};

class Search {
 public:
  explicit Search(const Program& program) : program_(program) {}

  std::vector<UpcomingController> run(StateIndex from) {
    leave_leaf({from, 1, {}});
    while (!ahead_.empty()) {
      const Step next = ahead_.top();
      ahead_.pop();
      if (++begun_[next.state] <= kMostRounds) enter(next);
    }
    std::vector<UpcomingController> all;
    for (auto& [name, one] : found_)
      all.push_back(std::move(one));
    std::ranges::sort(all, sooner_or_likelier);
    return all;
  }

 private:
  void go(Step step) {
    if (step.probability >= kLeast) ahead_.push(step);
  }

  void enter(const Step& step) {
    const CompiledState& node = program_.node(step.state);
    if (is_leaf(node.kind)) {
      note(step);
      return leave_leaf(step);
    }
    if (node.kind == StateKind::Library) return go({node.library, step.probability, step.after});
    if (node.kind == StateKind::Hierarchy) return follow(node.start, step.state, step);
    for (const StateIndex child : node.children) {
      if (child != node.decider) go({child, step.probability, step.after});
    }
  }

  void note(const Step& step) {
    const auto* use = std::get_if<ControllerUse>(&program_.declared(step.state)->run);
    const auto name = use == nullptr ? std::nullopt : name_of(step.state, *use);
    if (!name) return;
    UpcomingController& one =
        found_.try_emplace(*name, UpcomingController{*name, 0, step.after}).first->second;
    one.probability = std::min(one.probability + step.probability, 1.0);
    one.after = std::min(one.after, step.after);
  }

  /// Nothing where it depends on an input that is not constant.
  std::optional<std::string> name_of(StateIndex state, const ControllerUse& use) const {
    const auto& inputs = program_.declared(state)->inputs;
    return controller_name(use.controller, [&](const std::string& input) -> std::optional<std::string> {
      const auto at = position(inputs, input);
      if (!at) return std::nullopt;
      const PortSource& source = program_.node(state).inputs[*at];
      if (!source.slots.empty() || !source.global.empty()) return std::nullopt;
      return model::detail::scalar_text(source.fallback);
    });
  }

  void leave_leaf(const Step& step) {
    const Action& action = *program_.declared(step.state);
    const Duration after = step.after + action.expected_duration.value_or(Duration());
    const auto likelihoods = outcome_likelihoods(action, false);
    for (std::size_t i = 0; i < likelihoods.size(); ++i)
      leave(step.state, static_cast<Outcome>(i), {kNoState, likelihoods[i] * step.probability, after});
  }

  void leave(StateIndex state, Outcome outcome, const Step& step) {
    const CompiledState& node = program_.node(state);
    if (node.parent == kNoState) return leave_root(state, outcome, step);
    const CompiledState& parent = program_.node(node.parent);
    if (is_concurrency(parent.kind) && state != parent.decider) {
      // The container is left once, as if the first state that is seen to end were the one that counts.
      if (left_.try_emplace(node.parent, state).first->second != state) return;
      if (parent.decider != kNoState) return go({parent.decider, step.probability, step.after});
    }
    follow(node.next_after(outcome), node.parent, step);
  }

  void follow(const NextStep& next, StateIndex parent, const Step& step) {
    if (next.kind == NextStep::Kind::Child) {
      go({program_.node(parent).children[next.child], step.probability, step.after});
    } else if (next.kind == NextStep::Kind::Leave && next.outcome >= 0) {
      leave(parent, next.outcome, step);
    }
  }

  void leave_root(StateIndex root, Outcome outcome, const Step& step) {
    std::vector<StateIndex> users;
    for (StateIndex state = 0; state < program_.nodes().size(); ++state) {
      if (program_.node(state).library == root) users.push_back(state);
    }
    for (const StateIndex user : users)
      leave(user, outcome, {kNoState, step.probability / static_cast<double>(users.size()), step.after});
  }

  const Program& program_;
  std::priority_queue<Step> ahead_;
  std::map<StateIndex, int> begun_;
  std::map<StateIndex, StateIndex> left_;  ///< of each concurrency, the state behind which it goes on
  std::map<std::string, UpcomingController> found_;
};

}  // namespace

std::vector<UpcomingController> upcoming_controllers(const Program& program, StateIndex from) {
  return Search(program).run(from);
}

}  // namespace segue::mission
