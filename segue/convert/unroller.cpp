// SPDX-License-Identifier: Apache-2.0
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unroller.hpp>
#include <segue/mission/mission_index.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

using mission::kAborted;
using mission::NextStep;
using mission::Outcome;
using mission::StateIndex;
using mission::StateKind;
using task_network::NodeId;
using task_network::OutcomeId;

Unroller::Unroller(MissionPlan& plan, std::vector<type::Value> inputs, PlanScope scope)
    : plan_(plan),
      given_(std::move(inputs)),
      scope_(scope),
      subtrees_(find_opaque_subtrees(plan.program())),
      shared_(plan.program()),
      passed_on_(plan.shared_program()),
      touches_(plan.program().mission().actions.size()),
      world_(plan.program().mission()) {
  find_varying();
}

Result<void> Unroller::begin() {
  StateEntry entry;
  entry.state = 0;
  entry.aborts_handled = scope_ == PlanScope::EveryEnd;
  entry.strict = plan_.program().state(0).strict;
  const auto& supplies = node(0).inputs;
  for (std::size_t i = 0; i < supplies.size(); ++i) {
    Symbol input;
    const bool given = i < given_.size() && !given_[i].is_null();
    input.rest = with({}, given ? Default{given_[i]} : fallback(supplies[i], {}));
    entry.inputs.push_back(std::move(input));
  }
  enter(main_, std::move(entry));
  return {};
}

void Unroller::ended(NodeId node, OutcomeId outcome, const type::Value* outputs) {
  note_over(node);
  paths_.decide(node, outcome);
  if (outputs_.size() <= index(node)) outputs_.resize(index(node) + 1);
  if (outputs != nullptr) outputs_[index(node)] = std::make_shared<const type::Value>(*outputs);
}

/// The first node that may be on the path and has not ended, those in parallel to what is being planned
/// aside. All that follows comes after it.
std::optional<NodeId> Unroller::first_open() {
  const std::uint32_t size = plan_.network_.size();
  while (over_before_ < size && !is_open(NodeId{over_before_}))
    ++over_before_;
  for (std::uint32_t i = over_before_; i < size; ++i) {
    if (is_open(NodeId{i}) && !mission::in_parallel(plan_.nodes_[i].branch.get(), branch_.place.get()))
      return NodeId{i};
  }
  return std::nullopt;
}

/// Whether the node may be on the path and has not ended.
bool Unroller::is_open(NodeId node) {
  return !is_over(node) && paths_.live(plan_[node].when).has_value();
}

bool Unroller::step(Track& track) {
  const auto around = std::exchange(branch_, track.branch);
  Track* const racing = std::exchange(racing_, track.races ? &track : racing_);
  const bool more = step_within(track);
  branch_ = around;
  racing_ = racing;
  return more;
}

bool Unroller::step_within(Track& track) {
  take_alternatives(track);
  if (track.pending) return enter_pending(track);
  if (track.frames.empty()) {
    wait_for_unexpected(track);
    return false;
  }
  const StateKind kind = node(track.frames.back().activation->entry.state).kind;
  if (kind == StateKind::Preemptive) return step_race(track);
  return kind == StateKind::Hierarchy ? step_hierarchy(track) : step_barrier(track);
}

bool Unroller::step_hierarchy(Track& track) {
  Frame& frame = track.frames.back();
  const WeakOrder& order = *frame.activation->order;
  const bool at_end = !frame.loops.empty() && frame.place == order.end[frame.loops.back().head];
  if (at_end) return end_of_loop(track);
  if (frame.place == order.vertices.size()) {
    leave(track);
    return true;
  }
  if (order.end[frame.place] != 0 && (frame.loops.empty() || frame.loops.back().head != frame.place))
    frame.loops.push_back({.head = frame.place, .nodes = plan_.network_.size()});
  const StateIndex child = node(frame.activation->entry.state).children[order.vertices[frame.place]];
  return visit(track, child);
}

const std::vector<Arrival>& Unroller::live_arrivals(std::vector<Arrival>& arrivals) {
  std::erase_if(arrivals, [&](Arrival& arrival) {
    const auto live = paths_.live(arrival.when);
    if (live) arrival.when = *live;
    return !live;
  });
  return arrivals;
}

std::string Unroller::path_of(const ContainerExecution& around, StateIndex child) const {
  const std::string& id = plan_.program().state(child).id.str();
  return around.entry.path.empty() ? id : around.entry.path + "/" + id;
}

/// The data with which a state of the container at the frame is entered on that edge, except for errors.
StateEntry Unroller::entry_of(const Frame& frame, StateIndex child, BranchEdge when) {
  ContainerExecution& around = *frame.activation;
  StateEntry entry;
  entry.state = child;
  entry.when = when;
  entry.inputs = inputs_of(around, child, when);
  entry.path = path_of(around, child);
  entry.loops = loops_around(frame);
  entry.strict = around.entry.strict || plan_.program().state(child).strict;
  entry.around = around.around;
  entry.memberships = around.memberships;
  entry.container = around.run;
  entry.aborts_handled = around.entry.aborts_handled || node(child).next[1].kind != NextStep::Kind::Nowhere;
  return entry;
}

/// Enters the state at the position of the frame, if a way leads to it.
bool Unroller::visit(Track& track, StateIndex state) {
  Frame& frame = track.frames.back();
  ContainerExecution& activation = *frame.activation;
  auto& waiting = activation.arrivals[node(state).position];
  const auto& arrivals = live_arrivals(waiting);
  if (planted(ConversionFault::ForgetsArrivals) && waiting.size() > 1) waiting.pop_back();
  if (arrivals.empty()) {
    ++frame.place;
    return true;
  }
  std::vector<BranchEdge> edges;
  for (const Arrival& arrival : arrivals)
    edges.push_back(arrival.when);
  StateEntry entry = entry_of(frame, state, meet(std::move(edges)));
  for (const Arrival& arrival : arrivals) {
    if (arrival.aborted && !planted(ConversionFault::ForgetsAbortedError))
      entry.errors.insert(entry.errors.end(), arrival.errors.begin(), arrival.errors.end());
  }
  if (const auto port = mission::position(*node(state).input_ports, "error")) {
    auto& candidates = entry.inputs[*port].candidates;
    candidates.insert(candidates.end(), entry.errors.begin(), entry.errors.end());
  }
  waiting = {};  // no further way leads to it, unless it is in a loop
  ++frame.place;
  enter(track, std::move(entry));
  return !track.pending;
}

bool Unroller::enter_pending(Track& track) {
  StateEntry entry = std::move(*track.pending);
  track.pending.reset();
  const auto live = paths_.live(entry.when);
  if (!live) return true;
  entry.when = *live;
  enter(track, std::move(entry));
  return !track.pending;
}

/// Plans the state next; a leaf only once it is ready.
void Unroller::enter(Track& track, StateEntry entry) {
  const StateIndex state = entry.state;
  const StateKind kind = node(state).kind;
  if (subtrees_[state].kind != OpaqueSubtreeReason::Kind::None)
    return finish(track, state, add_subtree(entry));
  if (kind == StateKind::Preemptive && !may_race(entry)) {
    track.pending = std::move(entry);
    return;
  }
  if (plan_.program().declared(state) != nullptr && !is_ready(entry)) {
    track.pending = std::move(entry);
    return;
  }
  if (!mission::is_leaf(kind)) return enter_container(track, std::move(entry));
  if (kind != StateKind::Decider) return finish(track, state, add_action(entry, nullptr));
  const std::vector<StateEnd> beside = ends_beside(track);
  finish(track, state, add_action(entry, &beside));
}

void Unroller::enter_container(Track& track, StateEntry entry) {
  const StateIndex state = entry.state;
  const mission::CompiledState& container = node(state);
  auto activation = std::make_shared<ContainerExecution>(std::move(entry), container.slots);
  track.frames.push_back({activation, 0, {}, {}});
  if (container.kind == StateKind::Library) {
    StateEntry inside = activation->entry;
    inside.library = shown_as(inside);
    inside.state = container.library;
    inside.strict = inside.strict || plan_.program().state(container.library).strict;
    return enter(track, std::move(inside));
  }
  follow(*activation);
  const BranchEdge when = activation->entry.when;
  auto slot = static_cast<std::uint32_t>(activation->entry.inputs.size());
  for (const mission::PortSource& variable : container.variables) {
    Symbol value;
    value.rest = with({}, fallback(variable, when));
    activation->slots.write(slot++, when, std::move(value), paths_);
  }
  auto copy = container.at_begin.begin();
  for (std::uint32_t i = 0; i < activation->entry.inputs.size(); ++i) {
    activation->slots.write(i, when, activation->entry.inputs[i], paths_);
    for (; copy != container.at_begin.end() && copy->from == i; ++copy)
      activation->slots.write(copy->to, when, activation->slots.read(i, when, paths_), paths_);
  }
  begin_container(*activation);
  const BranchEdge inside = activation->inside;
  if (container.kind == StateKind::Hierarchy) {
    activation->arrivals.resize(container.children.size());
    activation->order = order_of(state);
    if (container.start.kind == NextStep::Kind::Child) {
      activation->arrivals[container.start.child].push_back({inside, false, {}});
      return;
    }
    activation->exits.push_back({container.start.outcome, {inside, false, {}}});
    if (container.start.outcome == kAborted)
      activation->exits.back().arrival.errors = constant(plan_.program().start_abort_text(state), inside);
    return;
  }
  if (container.kind == StateKind::Preemptive) return enter_race(track, *activation);
  enter_branches(track, *activation);
}

/// The branch of a state of that execution of a container on the track.
BranchPlace Unroller::beside(const Track& track, std::uint64_t number, StateIndex child) {
  const BranchPlace& around = track.branch;
  const std::uint32_t depth = around.place ? around.place->depth + 1 : 1;
  return {std::make_shared<const mission::ParallelBranch>(
              mission::ParallelBranch{around.place, number, child, depth}),
          plan_.network_.add_parallel_branch(around.in_network, number)};
}

/// Enters all states of the barrier at the top of the track, each on a track of its own.
void Unroller::enter_branches(Track& track, ContainerExecution& activation) {
  const BranchEdge when = activation.inside;
  const mission::CompiledState& barrier = node(activation.entry.state);
  const std::uint64_t number = barriers_++;
  const std::size_t open_before = before_.size();
  for (const StateIndex child : barrier.children) {
    if (child == barrier.decider) continue;
    StateEntry branch = entry_of(track.frames.back(), child, when);
    branch.aborts_handled = true;
    auto beside = std::make_shared<Track>();
    beside->branch = this->beside(track, number, child);
    track.frames.back().tracks.push_back(beside);
    const auto around = std::exchange(branch_, beside->branch);
    enter(*beside, std::move(branch));
    branch_ = around;
    if (!beside->settled()) before_.push_back(beside.get());
  }
  before_.resize(open_before);
}

/// Ends the hierarchy at the top of the track.
void Unroller::leave(Track& track) {
  const auto activation = track.frames.back().activation;
  const StateIndex state = activation->entry.state;
  StateEnd end;
  end.exits = activation->exits;
  for (const mission::PortSource& output : node(state).outputs) {
    Symbol value = read(*activation, output.slots, activation->entry.when);
    const mission::PortSource& shown = node(shown_as(activation->entry)).outputs[end.outputs.size()];
    if (!planted(ConversionFault::ForgetsOuterDefaults)) {
      const Default none = fallback(shown, activation->entry.when);
      for (Candidate& candidate : value.candidates)
        candidate.defaults = with(candidate.defaults, none);
      value.rest = with(value.rest, none);
    }
    end.outputs.push_back(std::move(value));
  }
  if (const auto port = mission::position(*node(state).output_ports, "error")) {
    auto& candidates = end.outputs[*port].candidates;
    for (const Exit& exit : end.exits)
      candidates.insert(candidates.end(), exit.arrival.errors.begin(), exit.arrival.errors.end());
  }
  if (!activation->entry.path.empty()) activation->run->exits = end.exits;
  track.frames.pop_back();
  finish(track, state, std::move(end));
}

/// Passes the end to the parent, which is now at the top of the track.
void Unroller::finish(Track& track, StateIndex state, StateEnd end) {
  if (track.frames.empty()) {
    track.end = std::move(end);
    return;
  }
  Frame& frame = track.frames.back();
  const mission::CompiledState& around = node(frame.activation->entry.state);
  if (around.kind == StateKind::Hierarchy) return finish_in_hierarchy(frame, state, std::move(end));
  if (around.kind != StateKind::Library) return finish_decider(track, state, std::move(end));
  const StateIndex library = frame.activation->entry.state;
  track.frames.pop_back();
  finish(track, library, std::move(end));
}

void Unroller::finish_in_hierarchy(Frame& frame, StateIndex state, StateEnd end) {
  ContainerExecution& activation = *frame.activation;
  const mission::CompiledState& child = node(state);
  std::erase_if(end.exits, [&](Exit& exit) {
    const auto live = paths_.live(exit.arrival.when);
    if (live) exit.arrival.when = *live;
    return !live;
  });
  if (end.exits.empty()) return;  // it turned out to be off the path
  // Outputs are written however the child ends, so the condition is that of its entry.
  BranchEdge entered = end.exits.front().arrival.when;
  for (const Exit& exit : end.exits)
    entered = paths_.common(entered, exit.arrival.when);
  take_outputs(activation, state, entered, std::move(end.outputs));
  for (Exit& exit : end.exits) {
    const NextStep& step = child.next_after(exit.outcome);
    exit.arrival.aborted = exit.outcome == kAborted;
    if (step.kind == NextStep::Kind::Child) {
      activation.arrivals[step.child].push_back(std::move(exit.arrival));
    } else {
      exit.arrival.errors = errors_of(state, exit, step);
      const Outcome outcome = step.kind == NextStep::Kind::Leave ? step.outcome : exit.outcome;
      activation.exits.push_back({outcome, std::move(exit.arrival)});
    }
  }
}

/// The errors with which a container is left: those of its state or, where an outcome of that state leads to
/// an abort, one that says so.
std::vector<Candidate> Unroller::errors_of(StateIndex child, Exit& exit, const NextStep& step) {
  const bool aborts = step.kind == NextStep::Kind::Leave && step.outcome == kAborted;
  if (exit.outcome < 0 || !aborts) return std::move(exit.arrival.errors);
  return constant(plan_.program().abort_text(child, exit.outcome), exit.arrival.when);
}

std::vector<Candidate> Unroller::constant(std::string text, BranchEdge when) {
  Symbol value;
  Default known;
  known.value = type::Value(std::move(text));
  value.rest = with({}, std::move(known));
  return copied({&value, 1}, when).candidates;
}

bool Unroller::step_barrier(Track& track) {
  const Frame& frame = track.frames.back();
  if (!paths_.live(frame.activation->inside)) {
    leave_off_path(track);
    return true;
  }
  const std::size_t open_before = before_.size();
  for (const auto& beside : frame.tracks) {
    if (step(*beside)) {
      before_.resize(open_before);
      return true;
    }
    if (!beside->settled()) before_.push_back(beside.get());
  }
  const bool settled = before_.size() == open_before;
  before_.resize(open_before);
  if (!settled) return plan_behind_barrier(track);
  join_barrier(track, frame.activation->inside);
  return true;
}

/// The container at the top of the track is off the path, or has not begun.
void Unroller::leave_off_path(Track& track) {
  if (!track.frames.back().activation->exits.empty()) return leave(track);
  const StateIndex state = track.frames.back().activation->entry.state;
  track.frames.pop_back();
  finish(track, state, {});
}

/// Enters the decider of the barrier at the top of the track, on an edge on which all other states have
/// ended.
void Unroller::join_barrier(Track& track, BranchEdge when) {
  ContainerExecution& activation = *track.frames.back().activation;
  const mission::CompiledState& barrier = node(activation.entry.state);
  const std::vector<StateEnd> ends = ends_beside(track);
  std::size_t next = 0;
  for (const StateIndex child : barrier.children) {
    if (child != barrier.decider) take_outputs(activation, child, when, ends[next++].outputs);
  }
  activation.joined = when;
  enter(track, entry_of(track.frames.back(), barrier.decider, when));
}

/// The ends of the states of the barrier at the top of the track.
std::vector<StateEnd> Unroller::ends_beside(const Track& track) const {
  std::vector<StateEnd> ends;
  for (const auto& beside : track.frames.back().tracks)
    ends.push_back(*beside->end);
  return ends;
}

void Unroller::finish_decider(Track& track, StateIndex state, StateEnd end) {
  ContainerExecution& activation = *track.frames.back().activation;
  take_outputs(activation, state, activation.joined, end.outputs);
  for (Exit& exit : end.exits) {
    const NextStep& step = node(state).next_after(exit.outcome);
    exit.arrival.errors = errors_of(state, exit, step);
    const Outcome outcome = step.kind == NextStep::Kind::Leave ? step.outcome : exit.outcome;
    activation.exits.push_back({outcome, std::move(exit.arrival)});
  }
  leave(track);
}

}  // namespace segue::convert
