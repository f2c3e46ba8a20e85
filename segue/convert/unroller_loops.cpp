// SPDX-License-Identifier: Apache-2.0
//
// How the unroller plans loops: ahead of decisions, and on beyond those that are expected to end.
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/unroller.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

using mission::NextStep;
using mission::StateIndex;

namespace {

/// Rounds of a loop in an outline: the actions that a round may overtake are in it or in the one before, and
/// the first round may change facts that later ones leave as they are.
constexpr std::size_t kOutlinedRounds = 3;
/// Iterations of a loop that are planned, at least, while something before them is under way. Twice as many
/// are never reached: iterations that end without beginning anything, or that take no time, would go on for
/// ever where the sequential run never gets to them.
constexpr std::size_t kIterationsAhead = 1000;

}  // namespace

/// Resumes the first alternative that turned out to be the way; drops those that turned out not to be.
void Unroller::take_alternatives(Track& track) {
  for (std::size_t i = 0; i < track.alternatives.size();) {
    Alternative& alternative = track.alternatives[i];
    if (has_lapsed(alternative)) {
      track.alternatives.erase(track.alternatives.begin() + static_cast<std::ptrdiff_t>(i));
      continue;
    }
    if (!goes_on(alternative) || planted(ConversionFault::NeverGoesBack)) {
      ++i;
      continue;
    }
    Frame& frame = alternative.frames.back();
    ContainerExecution& execution = *frame.activation;
    if (alternative.behind) {
      execution.exits.clear();  // those were behind the barrier
    } else {
      Frame::Loop& loop = frame.loops.back();
      execution.arrivals[execution.order->vertices[loop.head]] = std::exchange(loop.back, {});
    }
    track.frames = std::move(alternative.frames);
    track.alternatives.resize(i);
    track.pending.reset();
    track.end.reset();
    return;
  }
}

/// Whether it is certain that the nodes that were planned behind the loop are on the path, or that neither
/// they nor the loop are.
bool Unroller::has_lapsed(Alternative& alternative) {
  Frame& frame = alternative.frames.back();
  const auto base = paths_.live(frame.activation->inside);
  if (!base) return true;
  if (!alternative.behind) return live_arrivals(frame.loops.back().back).empty();
  const auto behind = paths_.live(*alternative.behind);
  return behind && paths_.implies(*base, *behind);
}

/// Whether it is certain that the loop goes on, or one of those in the barrier.
bool Unroller::goes_on(Alternative& alternative) {
  if (alternative.behind)
    return paths_.off_path(*alternative.behind) && !planted(ConversionFault::StaysBehindBarrier);
  Frame& frame = alternative.frames.back();
  const auto base = paths_.live(frame.activation->inside);
  return base && std::ranges::any_of(frame.loops.back().back, [&](const Arrival& arrival) {
           return paths_.implies(*base, arrival.when);
         });
}

/// Plans another iteration if it is certain, or as many ahead as the loop has run before; continues after the
/// loop if it is expected to end.
bool Unroller::end_of_loop(Track& track) {
  Frame& frame = track.frames.back();
  ContainerExecution& activation = *frame.activation;
  Frame::Loop& loop = frame.loops.back();
  const auto& arrivals = live_arrivals(activation.arrivals[activation.order->vertices[loop.head]]);
  if (arrivals.empty()) {
    frame.loops.pop_back();
    return true;
  }
  if (is_too_far_ahead(loop)) {
    wait_for_loop(frame, ", once " + plan_.network_.name_of(*loop.far_behind) + " has ended");
    return false;
  }
  if (scope_ == PlanScope::Outline) return end_of_outlined_loop(frame);
  const auto base = paths_.live(activation.inside);
  if (!base) return false;
  const auto certain = [&](const BranchEdge& edge) {
    const auto live = paths_.live(edge);
    return live && paths_.implies(*base, *live);
  };
  while (!loop.open.empty() && std::ranges::any_of(loop.open.front(), certain))
    loop.open.erase(loop.open.begin());
  std::vector<BranchEdge> edges;
  bool expected = false;
  for (const Arrival& arrival : arrivals) {
    edges.push_back(arrival.when);
    expected = expected || paths_.expected(arrival.when, *base);
  }
  if (std::ranges::any_of(edges, certain)) {
    loop.open.clear();
    return plan_again(frame);
  }
  if (!expected && leads_on(frame, activation.order->end[loop.head])) {
    plan_behind_loop(track);
    return true;
  }
  if (2 * loop.open.size() <= loop.iterations) {
    loop.open.push_back(std::move(edges));
    return plan_again(frame);
  }
  wait_for_loop(frame, "");
  return false;
}

/// Begins another iteration of the innermost loop; true.
bool Unroller::plan_again(Frame& frame) {
  Frame::Loop& loop = frame.loops.back();
  frame.place = loop.head;
  ++loop.iterations;
  return true;
}

bool Unroller::is_too_far_ahead(Frame::Loop& loop) {
  if (loop.far_behind && is_open(*loop.far_behind)) return true;
  loop.far_behind.reset();
  if (scope_ != PlanScope::AsKnown || loop.iterations - loop.looked < kIterationsAhead) return false;
  const auto open = first_open();
  if (open && index(*open) < loop.nodes) {
    loop.far_behind = open;
    return true;
  }
  loop.looked = loop.iterations;
  loop.nodes = plan_.network_.size();
  return false;
}

/// Goes on as if the loop had ended; how it goes on otherwise becomes an alternative.
void Unroller::plan_behind_loop(Track& track) {
  Frame& frame = track.frames.back();
  ContainerExecution& execution = *frame.activation;
  Frame::Loop& loop = frame.loops.back();
  loop.back = std::exchange(execution.arrivals[execution.order->vertices[loop.head]], {});
  track.alternatives.push_back({track.frames});
  frame.loops.pop_back();
}

/// Goes on as if all loops in the states of the barrier at the top of the track had ended, where all that is
/// open is whether they do.
bool Unroller::plan_behind_barrier(Track& track) {
  const auto all_have_ends = [](const Frame& frame) {
    return std::ranges::all_of(frame.tracks, [](const auto& beside) { return beside->end.has_value(); });
  };
  if (!all_have_ends(track.frames.back())) return false;
  const auto behind = all_ended(track);
  if (!behind) return false;
  track.alternatives.push_back({track.frames, behind});
  join_barrier(track, *behind);
  return true;
}

/// The edge that is on the path if the states of the barrier at the top of the track have ended as planned so
/// far; nothing where one of them cannot.
std::optional<BranchEdge> Unroller::all_ended(const Track& track) {
  const Frame& frame = track.frames.back();
  BranchEdge ended = frame.activation->inside;
  for (const auto& beside : frame.tracks) {
    if (beside->settled()) continue;
    std::vector<BranchEdge> ways;
    for (const Exit& exit : beside->end->exits) {
      if (const auto live = paths_.live(exit.arrival.when)) ways.push_back(*live);
    }
    if (ways.empty()) return std::nullopt;
    const bool first = ended == frame.activation->inside;
    ended = first ? meet(std::move(ways)) : add_join(ended, std::move(ways));
  }
  return ended;
}

/// Plans another round, or goes on behind the loop as if it had ended.
bool Unroller::end_of_outlined_loop(Frame& frame) {
  Frame::Loop& loop = frame.loops.back();
  if (loop.iterations < kOutlinedRounds) return plan_again(frame);
  ContainerExecution& execution = *frame.activation;
  execution.arrivals[execution.order->vertices[loop.head]] = {};
  frame.loops.pop_back();
  return true;
}

void Unroller::wait_for_loop(const Frame& frame, std::string_view addition) {
  const ContainerExecution& activation = *frame.activation;
  const auto place = activation.order->vertices[frame.loops.back().head];
  const StateIndex head = node(activation.entry.state).children[place];
  plan_.waits_for_ = "whether the loop at " + path_of(activation, head) + " goes on" + std::string(addition);
}

/// Says for which loop the track waits that has been planned to its end.
void Unroller::wait_for_unexpected(const Track& track) {
  if (track.alternatives.empty()) return;
  const Alternative& last = track.alternatives.back();
  if (!last.behind) return wait_for_loop(last.frames.back(), ", which is not expected");
  for (const auto& beside : last.frames.back().tracks)
    wait_for_unexpected(*beside);
}

/// Whether there is a way to a state after the loop.
bool Unroller::leads_on(Frame& frame, std::uint32_t from) {
  ContainerExecution& activation = *frame.activation;
  const auto live = [&](const Exit& exit) { return paths_.live(exit.arrival.when).has_value(); };
  if (std::ranges::any_of(activation.exits, live)) return true;
  const auto& vertices = activation.order->vertices;
  for (std::uint32_t place = from; place < vertices.size(); ++place) {
    if (!live_arrivals(activation.arrivals[vertices[place]]).empty()) return true;
  }
  return false;
}

const std::shared_ptr<const WeakOrder>& Unroller::order_of(StateIndex hierarchy) {
  auto& order = orders_[hierarchy];
  if (order) return order;
  const auto& children = node(hierarchy).children;
  std::vector<std::vector<std::uint32_t>> successors(children.size());
  for (std::size_t i = 0; i < children.size(); ++i) {
    for (const NextStep& step : node(children[i]).next) {
      if (step.kind == NextStep::Kind::Child) successors[i].push_back(step.child);
    }
  }
  const NextStep& start = node(hierarchy).start;
  order = start.kind == NextStep::Kind::Child
              ? std::make_shared<const WeakOrder>(weak_order(successors, start.child))
              : std::make_shared<const WeakOrder>();
  return order;
}

/// The iterations of the loops around the position of the frame.
std::string Unroller::loops_around(const Frame& frame) {
  std::string loops = frame.activation->entry.loops;
  for (const Frame::Loop& loop : frame.loops)
    loops += (loops.empty() ? "" : ".") + std::to_string(loop.iterations);
  return loops;
}

}  // namespace segue::convert
