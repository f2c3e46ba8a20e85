// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/convert/mission_plan.hpp>
#include <segue/convert/node_journal.hpp>
#include <segue/convert/run_events.hpp>
#include <segue/mission_engine/engine.hpp>

#include <functional>
#include <memory>
#include <thread>
#include <unordered_map>
#include <vector>

namespace segue::convert {

/// Executes the nodes of a plan: actions by their runners, each opaque subtree by its own engine, all others
/// directly.
class ActionEnvironment final : public task_network::Environment {
 public:
  /// The listeners to nodes that begin and end; null: none.
  struct Listeners {
    NodeJournal* journal;
    RunEvents* events;
  };
  ActionEnvironment(const MissionPlan& plan, const mission::Runners& runners,
                    std::vector<std::shared_ptr<mission::ActionRunner>> by_action, RunOptions options,
                    Listeners listeners = {nullptr, nullptr});
  ~ActionEnvironment() override;

  void start(task_network::NodeContext& context, task_network::Completions& completions) override;
  task_network::ReportPtr refuse(task_network::NodeContext& context, std::string why) override;
  void cancel(task_network::NodeId node, std::uint32_t attempt,
              task_network::Completions& completions) override;
  void ended(task_network::NodeId node, std::uint32_t attempt) override;
  [[nodiscard]] bool outdated(task_network::NodeId node) const override;
  [[nodiscard]] bool had_begun(task_network::NodeId node) const override {
    return journal_ != nullptr && journal_->had_begun(node);
  }
  void passed_before(task_network::NodeId node) override;
  [[nodiscard]] Duration patience() const override { return options_.preemption_grace; }
  /// From any thread: preempts an opaque subtree that occupies the engine's thread, as in virtual time.
  void stop();
  /// Makes all later ends be ignored. Blocks while one is being delivered.
  void close();

  mission::Globals globals;

 private:
  class NodeCall;
  struct Reporter;
  /// Delivers ends to the engine as long as it runs. Shared with completers, which may outlive this.
  struct EndReceiver {
    Mutex mutex;  ///< guards `completions`, which is null before the first start and after close()
    task_network::Completions* completions = nullptr;
    void deliver(task_network::NodeId node, std::uint32_t attempt, task_network::ReportPtr report);
  };
  struct Running {
    std::shared_ptr<Reporter> reporter;
    std::function<void()> preempt;                 ///< null: it ends by itself
    std::shared_ptr<const type::Value> written{};  ///< outputs with which it ends; null: it ends by itself
  };

  bool replay(task_network::NodeContext& context, task_network::Completions& completions);
  void start_action(task_network::NodeContext& context, task_network::Completions& completions);
  [[nodiscard]] mission::MissionPart part(task_network::NodeContext& context,
                                          const mission::Globals& used) const;
  [[nodiscard]] mission::WorldView world(task_network::NodeContext& context) const;
  [[nodiscard]] mission::Units::Counts units(task_network::NodeContext& context) const;
  void start_subtree(task_network::NodeContext& context, task_network::Completions& completions);
  void occupy(mission::Engine* opaque_subtree);
  void hand_on(task_network::NodeContext& context, task_network::Completions& completions);
  void change_value(task_network::NodeContext& context, task_network::Completions& completions);
  void join(task_network::NodeContext& context, task_network::Completions& completions);
  void begin_container(task_network::NodeContext& context, task_network::Completions& completions);
  [[nodiscard]] type::Value value(task_network::NodeContext& context, const ValueSource& source) const;
  [[nodiscard]] type::Value newest(task_network::NodeContext& context,
                                   std::span<const ValueSource> sources) const;
  [[nodiscard]] std::vector<type::Value> inputs(task_network::NodeContext& context) const;
  [[nodiscard]] std::vector<type::Value> default_outputs(task_network::NodeId node,
                                                         const mission::Globals& globals) const;
  [[nodiscard]] mission::Place place(task_network::NodeId node) const;
  [[nodiscard]] bool may_be_discarded(task_network::NodeId node) const;
  [[nodiscard]] mission::Globals globals_of(task_network::NodeId node) const;
  std::shared_ptr<Reporter> reporter(task_network::NodeId node) const;
  std::shared_ptr<Reporter> reporter_with_passed_on(task_network::NodeContext& context) const;

  const MissionPlan& plan_;
  const mission::Runners& runners_;
  const std::vector<std::shared_ptr<mission::ActionRunner>> by_action_;
  const RunOptions options_;
  NodeJournal* const journal_;  ///< null: none
  RunEvents* const events_;     ///< null: nobody follows
  const std::shared_ptr<mission::Iterations> iterations_;
  std::shared_ptr<EndReceiver> receiver_ = std::make_shared<EndReceiver>();
  std::unordered_map<std::uint32_t, Running> running_;  ///< by node: what can be preempted
  std::unordered_map<std::uint32_t, std::shared_ptr<const PendingChanges>>
      unsure_;      ///< by node: what runs have used so far that may be discarded
  Mutex stopping_;  ///< guards the next two
  bool stopped_ SEGUE_GUARDED_BY(stopping_) = false;
  mission::Engine* subtree_ SEGUE_GUARDED_BY(stopping_) = nullptr;  ///< runs on the engine's thread
  std::vector<std::jthread> subtrees_;
};

}  // namespace segue::convert
