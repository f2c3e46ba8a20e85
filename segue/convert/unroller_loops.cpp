// SPDX-License-Identifier: Apache-2.0
//
// How the unroller plans loops: ahead of decisions, and on beyond those that are expected to end.
#include <segue/convert/fault.hpp>
#include <segue/convert/unroller.hpp>

#include <algorithm>
#include <utility>

namespace segue::convert {

using mission::NextStep;
using mission::StateIndex;

namespace {

/// Rounds of a loop in an outline: what a round may overtake is in it or in the one before, and the first
/// round may change facts that later ones leave as they are.
constexpr std::size_t kOutlinedRounds = 3;

}  // namespace

/// Resumes the first loop that turned out to continue; drops alternatives that turned out not to.
void Unroller::take_alternatives(Track& track) {
  for (std::size_t i = 0; i < track.alternatives.size();) {
    Frame& frame = track.alternatives[i].back();
    ContainerExecution& activation = *frame.activation;
    Frame::Loop& loop = frame.loops.back();
    const auto& arrivals = live_arrivals(loop.back);
    const auto base = paths_.live(activation.inside);
    if (arrivals.empty() || !base) {
      track.alternatives.erase(track.alternatives.begin() + static_cast<std::ptrdiff_t>(i));
      continue;
    }
    const bool certain = std::ranges::any_of(
        arrivals, [&](const Arrival& arrival) { return paths_.implies(*base, arrival.when); });
    if (!certain || planted(ConversionFault::NeverGoesBack)) {
      ++i;
      continue;
    }
    activation.arrivals[activation.order->vertices[loop.head]] = std::exchange(loop.back, {});
    track.frames = std::move(track.alternatives[i]);
    track.alternatives.resize(i);
    track.pending.reset();
    track.end.reset();
    return;
  }
}

/// Plans another iteration if it is certain, or as many ahead as the loop has run before; continues after the
/// loop if it is expected to end.
bool Unroller::end_of_loop(Track& track) {
  Frame& frame = track.frames.back();
  ContainerExecution& activation = *frame.activation;
  Frame::Loop& loop = frame.loops.back();
  const auto again = [&] {
    frame.place = loop.head;
    ++loop.iterations;
    return true;
  };
  const auto& arrivals = live_arrivals(activation.arrivals[activation.order->vertices[loop.head]]);
  if (arrivals.empty()) {
    frame.loops.pop_back();
    return true;
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
    return again();
  }
  if (!expected && leads_on(frame, activation.order->end[loop.head])) {
    plan_behind_loop(track);
    return true;
  }
  if (2 * loop.open.size() <= loop.iterations) {
    loop.open.push_back(std::move(edges));
    return again();
  }
  wait_for_loop(frame, "");
  return false;
}

/// Goes on as if the loop had ended; how it goes on otherwise becomes an alternative.
void Unroller::plan_behind_loop(Track& track) {
  Frame& frame = track.frames.back();
  ContainerExecution& execution = *frame.activation;
  Frame::Loop& loop = frame.loops.back();
  loop.back = std::exchange(execution.arrivals[execution.order->vertices[loop.head]], {});
  track.alternatives.push_back(track.frames);
  frame.loops.pop_back();
}

/// Plans another round, or goes on behind the loop as if it had ended.
bool Unroller::end_of_outlined_loop(Frame& frame) {
  Frame::Loop& loop = frame.loops.back();
  if (loop.iterations < kOutlinedRounds) {
    frame.place = loop.head;
    ++loop.iterations;
    return true;
  }
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
