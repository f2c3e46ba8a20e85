// SPDX-License-Identifier: Apache-2.0
//
// Nodes that are opaque subtrees: each is run by an engine of its own.
#include <segue/base/time_after.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/convert/action_environment.hpp>
#include <segue/convert/conversion_fault.hpp>
#include <segue/convert/reporter.hpp>
#include <segue/convert/subtree_watch.hpp>
#include <segue/convert/world_flow.hpp>
#include <segue/convert/world_views.hpp>
#include <segue/mission/world_values.hpp>

#include <utility>

namespace segue::convert {

using mission::kAborted;
using task_network::Completions;
using task_network::NodeContext;
using type::Value;

/// The subtree of the node, with everything that it begins with.
mission::MissionPart ActionEnvironment::part(NodeContext& context, const mission::Globals& used) const {
  const PlannedNode& planned = plan_[context.node()];
  const auto slash = planned.path.rfind('/');
  std::string parent(planned.path);  // the root of a library has no path element of its own
  if (plan_.program().node(planned.state).parent != mission::kNoState)
    parent.resize(slash == std::string::npos ? 0 : slash);
  const Value error = value(context, planned.error_before);
  std::vector<Value> given = inputs(context);
  mission::WorldValues values;
  const auto ports = static_cast<std::ptrdiff_t>(plan_.program().node(planned.state).input_ports->size());
  auto seen = given.begin() + ports;
  for (const std::string& name : planned.touched->all)
    values.emplace(name, std::move(*seen++));
  given.resize(static_cast<std::size_t>(ports));
  return {planned.state,
          planned.shown_as,
          parent,
          std::move(given),
          error.is_string() ? error.as_string() : "",
          planted(ConversionFault::ForgetsSharedGlobals) ? mission::Globals() : used,
          iterations_,
          world(context),
          std::move(values),
          units(context),
          planned.around};
}

mission::Units::Counts ActionEnvironment::units(NodeContext& context) const {
  const task_network::ResourceTable& resources = plan_.network().resources;
  mission::Units::Counts counts;
  for (std::uint32_t i = 0; i < resources.size(); ++i) {
    const task_network::ResourceId resource{i};
    counts[resources.name(resource)] =
        planted(ConversionFault::SeesOldUnits) ? resources[resource].count : context.units(resource);
  }
  return counts;
}

mission::WorldView ActionEnvironment::world(NodeContext& context) const {
  const task_network::TaskNetwork& network = plan_.network();
  const task_network::VersionedWorld world = context.world();
  return view_of(planted(ConversionFault::SeesOldWorld) ? network.initial_world : world, network.facts,
                 options_.world_data);
}

/// In virtual time the subtree runs immediately, and its end is reported for the time at which it occurs.
void ActionEnvironment::start_subtree(NodeContext& context, Completions& completions) {
  const bool in_virtual_time = options_.clock == task_network::ClockKind::Virtual;
  auto clock = std::make_shared<VirtualClock>();
  mission::EngineOptions options;
  if (in_virtual_time) options.clock = clock.get();
  options.warn = options_.warn;
  options.history = false;
  options.observe = options_.observe;
  options.preemption_grace = options_.preemption_grace;
  auto reports = reporter(context.node());
  options.part = part(context, reports->globals);
  const SubtreeWatch watch(*options.part, plan_[context.node()].touched->changed);
  auto made = mission::Engine::create(plan_.shared_program(), runners_, std::move(options));
  if (!made) {
    return completions.finish_at(completions.now(), context.node(), context.attempt(),
                                 reports->report({kAborted, made.error().message}, {}));
  }
  if (events_ != nullptr) events_->begins(context.node(), completions.now());
  if (journal_ != nullptr) journal_->began(context.node());
  std::shared_ptr<mission::Engine> engine = std::move(*made);
  const auto carry_out = [engine, reports, watch] {
    engine->run();
    const mission::MissionResult& ended = engine->result();
    return reports->report({ended.outcome, ended.error}, ended.outputs, watch.changes(*engine));
  };
  if (in_virtual_time) {
    occupy(engine.get());
    auto report = carry_out();
    occupy(nullptr);
    const Duration taken = clock->now() - VirtualClock().now();
    const auto when = time_after(completions.now(), taken);
    if (!when) report = reports->report({kAborted, when.error().message}, {});
    return completions.finish_at(when.value_or(completions.now()), context.node(), context.attempt(),
                                 std::move(report));
  }
  running_[index(context.node())] = {reports, [engine] { engine->stop(); }};
  const auto run = [carry_out, receiver = receiver_, node = context.node(), attempt = context.attempt()](
                       const std::stop_token& /*own*/) { receiver->deliver(node, attempt, carry_out()); };
  subtrees_.push_back(concurrent::start_stoppable_thread("segue-subtree", run));
}

/// Registers the subtree that occupies this thread, so that another thread can stop it.
void ActionEnvironment::occupy(mission::Engine* opaque_subtree) {
  const Lock lock(stopping_);
  subtree_ = opaque_subtree;
  if (subtree_ != nullptr && stopped_) subtree_->stop();
}

}  // namespace segue::convert
