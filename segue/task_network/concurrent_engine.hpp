// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/task_network/completion_queue.hpp>
#include <segue/task_network/environment.hpp>
#include <segue/task_network/order.hpp>
#include <segue/task_network/run_result.hpp>
#include <segue/task_network/task_network.hpp>
#include <segue/task_network/unit_limits.hpp>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

namespace segue::task_network {

/// Appends nodes while a network runs, for example to unroll loops up to a horizon of unfinished nodes.
class Expansion {
 public:
  virtual ~Expansion() = default;
  /// Appends the nodes that are known to come next, about `wanted` of them. Called on the engine's thread
  /// whenever fewer nodes than the horizon are unfinished: at the beginning and after every end.
  virtual void expand(TaskNetwork& network, std::size_t wanted) = 0;
  /// `node` has ended for good, with that outcome and those outputs (null: none). Not called for nodes that
  /// were skipped.
  virtual void ended(NodeId node, OutcomeId outcome, const type::Value* outputs) = 0;
  /// `node` has failed: no node after it is reached any more.
  virtual void failed(NodeId node) { (void)node; }
  /// Whether there are races that have not been decided.
  [[nodiscard]] virtual bool races() const { return false; }
  /// The nodes that have lost a race since the last call: those that run are preempted, and their ends count;
  /// the others are skipped (see skipped()). Asked whenever a node has ended or was appended.
  virtual std::vector<NodeId> take_lost() { return {}; }
  /// The node turned out to be off the path, or was in take_lost(), and will not end.
  virtual void skipped(NodeId node) { (void)node; }
  /// Nothing will be appended any more.
  [[nodiscard]] virtual bool finished() const = 0;
};

struct ConcurrentEngineOptions {
  ClockKind clock = ClockKind::Virtual;
  bool strict = false;             ///< all nodes are strict (NodeSpec::strict)
  bool speculate = true;           ///< pure nodes may run speculatively
  std::uint32_t ahead = 0;         ///< speculative runs at the same time; 0: any number
  double least_likelihood = 0;     ///< what is less likely to count does not run speculatively; of 1
  std::uint32_t workers = 0;       ///< nodes that run at the same time; 0: any number
  std::uint32_t world_copies = 0;  ///< projections that exist at the same time, from the start of a run until
                                   ///< nobody needs its result any more; 0: any number
  bool log = false;
  std::size_t horizon = 1000;               ///< unfinished nodes that an Expansion is asked for
  std::vector<std::uint64_t> priorities{};  ///< by node, the least first; empty: program order
  /// Called on the engine's thread when it is paused and nothing runs any more, with the nodes that could
  /// begin, those first that are certain to count.
  std::function<void(const std::vector<NodeId>& next)> held{};
  /// Observed resources, of which nobody can have units before limit() says how many.
  std::vector<ResourceId> limited{};
  /// Called on the engine's thread when a node begins to wait for units beyond the limits that limit() has
  /// said, once for each node.
  std::function<void(const ResourcePool::Limited& wait)> waits_for_units{};
};

/// Runs a network concurrently and speculatively, as far as its order, its resources and the predicted world
/// allow, with the outcome of the sequential execution: the same end; unless that is a failure, the same
/// values read, the same final world, the same resources consumed; the same order of irreversible nodes for
/// each fact and resource. acts_ahead() tells which other nodes may have acted where it fails. All decisions
/// are made on the thread that calls `run`.
class ConcurrentEngine {
 public:
  /// All three must outlive the engine; `order` must cover the network.
  ConcurrentEngine(const TaskNetwork& network, const Order& order, Environment& environment,
                   ConcurrentEngineOptions options = {});
  /// A network that grows: the engine derives the order itself, by the epoch rule.
  ConcurrentEngine(TaskNetwork& network, Expansion& expansion, Environment& environment,
                   ConcurrentEngineOptions options = {});
  ~ConcurrentEngine();
  ConcurrentEngine(const ConcurrentEngine&) = delete;
  ConcurrentEngine& operator=(const ConcurrentEngine&) = delete;

  /// Runs it to its end. A failure of the mission is part of the result. Blocks; call it once.
  RunResult run();

  /// Ends the run soon: running nodes are preempted, and nothing new starts. On any thread, as the next
  /// three.
  void stop();
  /// Lets no node begin any more; running nodes go on. May be called before run().
  void pause();
  /// Ends a pause.
  void resume();
  /// Begins one more node during a pause: the first that can.
  void step();
  /// From now on, nodes get so many units of resources among `options.limited`. Who waits for more is no
  /// stall: the run goes on when this is called again, or ends by stop(). On any thread, with a real clock.
  void limit(UnitLimits limits);

  /// The order that it runs by: the given one, or that of the network as far as it has grown.
  [[nodiscard]] const Order& order() const;

  /// Bytes that the engine itself keeps, the network and its order aside.
  [[nodiscard]] std::size_t bytes() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::task_network
