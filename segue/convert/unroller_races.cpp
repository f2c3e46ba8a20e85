// SPDX-License-Identifier: Apache-2.0
//
// How the unroller plans preemptive containers: each of their states on a track of its own. The nodes after
// the container are planned once it is known which state has ended first, and all that was running in the
// others has ended.
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unroller.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

using mission::NextStep;
using mission::Outcome;
using mission::StateIndex;
using task_network::NodeId;

/// Its states guard each other, so none may begin before all can: once everything before has ended.
bool Unroller::may_race(const StateEntry& entry) {
  if (scope_ != PlanScope::AsKnown || planted(ConversionFault::RacesBeginEarly)) return true;
  const auto live = paths_.live(entry.when);
  const bool may = !live || (live->always() && !first_open());
  if (!may) plan_.waits_for_ = "the end of what comes before " + entry.path;
  return may;
}

void Unroller::enter_race(Track& track, ContainerExecution& activation) {
  const BranchEdge when = activation.entry.when;
  const std::uint64_t number = barriers_++;
  const auto race = std::make_shared<Race>(Race{track.frames.back().activation});
  track.frames.back().race = race;
  races_.push_back(race);
  world_.may_forget();
  for (const StateIndex child : node(activation.entry.state).children) {
    StateEntry entry = entry_of(track.frames.back(), child, when);
    auto beside = std::make_shared<Track>();
    beside->branch = this->beside(track, number, child);
    beside->races = true;
    beside->around = racing_;
    race->tracks.push_back(beside);
    const auto branch = std::exchange(branch_, beside->branch);
    Track* const racing = std::exchange(racing_, beside.get());
    enter(*beside, std::move(entry));
    branch_ = branch;
    racing_ = racing;
  }
}

bool Unroller::step_race(Track& track) {
  const Frame& frame = track.frames.back();
  if (!paths_.live(frame.activation->entry.when)) {
    leave_off_path(track);
    return true;
  }
  Race& race = *frame.race;
  bool open = false;
  bool settled = true;
  for (const auto& beside : race.tracks) {
    const bool is_decided = scope_ == PlanScope::AsKnown && race.first;
    if (!is_decided && step(*beside)) return true;
    drop_ended(*beside);
    open = open || !beside->open.empty();
    settled = settled && beside->settled();
  }
  if (scope_ == PlanScope::AsKnown) {
    find_first(race);
    settled = race.first && !open;
  } else {
    race.first = recorded_first(race);
  }
  if (settled)
    join_race(track);
  else
    plan_.waits_for_ = "which state of " + frame.activation->entry.path + " ends first";
  return settled;
}

mission::Execution Unroller::execution(const Race& race, std::size_t state) const {
  const StateEntry& around = race.activation->entry;
  return {path_of(*race.activation, node(around.state).children[state]), 0, around.loops};
}

std::optional<std::size_t> Unroller::recorded_first(const Race& race) const {
  for (std::size_t i = 0; i < race.tracks.size(); ++i) {
    if (record_.firsts.contains(execution(race, i))) return i;
  }
  return std::nullopt;
}

/// The outputs of all states count, those of the first one last.
void Unroller::join_race(Track& track) {
  const Frame frame = track.frames.back();
  ContainerExecution& activation = *frame.activation;
  const auto& children = node(activation.entry.state).children;
  const BranchEdge when = activation.entry.when;
  for (std::size_t i = 0; i < children.size(); ++i) {
    if (!frame.race->tracks[i]->end) continue;  // nobody uses its outputs
    std::vector<Symbol> outputs = frame.race->tracks[i]->end->outputs;
    for (std::size_t port = 0; port < outputs.size(); ++port)
      outputs[port].rest = with(outputs[port].rest, fallback(node(children[i]).outputs[port], when));
    take_outputs(activation, children[i], when, std::move(outputs));
  }
  if (const auto first = frame.race->first) {
    take_outputs(activation, children[*first], when, frame.race->tracks[*first]->end->outputs);
    leave_race(activation, children[*first], *frame.race->tracks[*first]->end);
  } else if (scope_ == PlanScope::EveryEnd) {
    activation.exits.push_back({mission::kPreempted, {when, false, {}}});
  } else {
    for (std::size_t i = 0; i < children.size(); ++i)
      leave_race(activation, children[i], *frame.race->tracks[i]->end);
  }
  leave(track);
}

/// Adds the ends of the container to which the ends of the child lead.
void Unroller::leave_race(ContainerExecution& activation, StateIndex child, const StateEnd& end) {
  for (Exit exit : end.exits) {
    const auto live = paths_.live(exit.arrival.when);
    if (!live || (scope_ == PlanScope::AsKnown && !live->always())) continue;
    const NextStep& step = node(child).next_after(exit.outcome);
    // An error that was handled inside of the state that ends the race is over, like in the sequential run.
    if (exit.outcome >= 0) exit.arrival.errors.clear();
    exit.arrival.errors = errors_of(child, exit, step);
    const Outcome outcome = step.kind == NextStep::Kind::Leave ? step.outcome : exit.outcome;
    activation.exits.push_back({outcome, std::move(exit.arrival)});
  }
}

/// Decides the race if one of its states has ended.
void Unroller::find_first(Race& race) {
  const auto recorded = recorded_first(race);
  for (std::size_t i = 0; i < race.tracks.size() && !race.first; ++i) {
    const bool may_be_first = !recorded || *recorded == i;
    if (may_be_first && has_ended(*race.tracks[i]) && !replays(race, i)) decide(race, i);
  }
}

/// Whether other states than the first are still to do again what they did in the earlier run.
bool Unroller::replays(const Race& race, std::size_t first) {
  if (!record_.replays) return false;
  for (std::size_t i = 0; i < race.tracks.size(); ++i) {
    if (i == first) continue;
    drop_ended(*race.tracks[i]);
    const auto replays = [this](NodeId node) {
      return record_.replays(node) || (record_.was_preempted(node) && !runs_for_certain(node));
    };
    if (record_.awaits(execution(race, i)) || std::ranges::any_of(race.tracks[i]->open, replays)) return true;
  }
  return false;
}

/// Whether nothing that it needs is open any more, so that it counts if it is preempted.
bool Unroller::runs_for_certain(NodeId node) {
  const auto way = paths_.live(plan_[node].when);
  return way && way->always() &&
         std::ranges::all_of(plan_.network_.inputs(node), [this](const task_network::DataInput& input) {
           return is_over(input.producer);
         });
}

/// The nodes of the other states have lost.
void Unroller::decide(Race& race, std::size_t first) {
  race.first = first;
  const mission::Execution ended = execution(race, first);
  if (record_.firsts.insert(ended).second && record_.decided) record_.decided(ended);
  for (std::size_t i = 0; i < race.tracks.size(); ++i) {
    if (i == first) continue;
    drop_ended(*race.tracks[i]);
    for (const NodeId node : race.tracks[i]->open) {
      lost_.push_back(node);
      for (auto around = container_of(node); around && around != race.activation->run;
           around = around->around)
        around->lost = true;
    }
    world_.forget(race.tracks[i]->open, paths_);
  }
  const auto is_open = [](const std::weak_ptr<Race>& each) { return !each.expired() && !each.lock()->first; };
  if (std::ranges::none_of(races_, is_open)) world_.keep();
}

/// Whether all that the state stands for has ended, for certain.
bool Unroller::has_ended(Track& track) {
  if (!track.settled()) return false;
  drop_ended(track);
  if (!track.open.empty()) return false;
  return std::ranges::any_of(track.end->exits,
                             [&](const Exit& exit) { return paths_.certain(exit.arrival.when); });
}

void Unroller::drop_ended(Track& track) {
  std::erase_if(track.open, [&](NodeId node) { return is_over(node) || !paths_.live(plan_[node].when); });
}

void Unroller::note_over(NodeId node) {
  if (over_.size() <= index(node)) over_.resize(index(node) + 1);
  over_[index(node)] = true;
  const auto within = inside_.extract(index(node));
  if (within.empty()) return;
  for (ContainerRun* container = within.mapped().get(); container != nullptr;
       container = container->around.get())
    --container->open;
}

void Unroller::skipped(NodeId node) {
  note_over(node);
}

/// The failure of a node ends the mission, and also the states that the node belongs to, so the states that
/// race with these are preempted.
void Unroller::failed(NodeId node) {
  for (const auto& each : races_) {
    const auto race = each.lock();
    if (!race || race->first) continue;
    for (std::size_t i = 0; i < race->tracks.size() && !race->first; ++i) {
      if (std::ranges::find(race->tracks[i]->open, node) != race->tracks[i]->open.end()) decide(*race, i);
    }
  }
}

std::vector<NodeId> Unroller::take_lost() {
  std::erase_if(races_, [](const auto& race) { return race.expired() || race.lock()->first; });
  for (const auto& race : races_)
    find_first(*race.lock());
  return std::exchange(lost_, {});
}

}  // namespace segue::convert
