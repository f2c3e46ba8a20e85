// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/convert/plan.hpp>
#include <segue/convert/run.hpp>
#include <segue/mission/engine.hpp>

#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <vector>

namespace segue::convert {

/// Carries out the nodes of a plan: actions by their runners, routines by an engine each, the rest by itself.
class ActionEnvironment final : public cdtn::Environment {
 public:
  ActionEnvironment(const Plan& plan, const mission::Runners& runners,
                    std::vector<std::shared_ptr<mission::ActionRunner>> by_action, RunOptions options);
  ~ActionEnvironment() override;

  void start(cdtn::Launch& launch, cdtn::Completions& completions) override;
  cdtn::ReportPtr refuse(cdtn::Launch& launch, std::string why) override;
  void cancel(cdtn::NodeId node, std::uint32_t attempt, cdtn::Completions& completions) override;
  void ended(cdtn::NodeId node, std::uint32_t attempt) override;
  [[nodiscard]] Duration patience() const override { return options_.preemption_grace; }
  /// From any thread: preempts a routine that keeps the engine's thread, as it does in virtual time.
  void stop();
  /// What ends from now on is told to nobody.
  void close();

  mission::Globals globals;

 private:
  class NodeCall;
  struct Reporter;
  /// Where ends are told, as long as the engine runs.
  struct Desk {
    std::mutex mutex;
    cdtn::Completions* completions = nullptr;
    void tell(cdtn::NodeId node, std::uint32_t attempt, cdtn::ReportPtr report);
  };
  struct Running {
    std::shared_ptr<Reporter> reporter;
    std::function<void()> preempt;
  };

  void start_action(cdtn::Launch& launch, cdtn::Completions& completions);
  void start_routine(cdtn::Launch& launch, cdtn::Completions& completions);
  void occupy(mission::Engine* routine);
  void join(cdtn::Launch& launch, cdtn::Completions& completions);
  [[nodiscard]] type::Value value(cdtn::Launch& launch, const Source& source) const;
  [[nodiscard]] std::vector<type::Value> inputs(cdtn::Launch& launch) const;
  [[nodiscard]] std::vector<type::Value> default_outputs(cdtn::NodeId node) const;
  std::shared_ptr<Reporter> reporter(cdtn::NodeId node) const;
  std::shared_ptr<Reporter> counting_reporter(cdtn::Launch& launch) const;

  const Plan& plan_;
  const mission::Runners& runners_;
  const std::vector<std::shared_ptr<mission::ActionRunner>> by_action_;
  const RunOptions options_;
  const std::shared_ptr<mission::Iterations> iterations_;
  std::shared_ptr<Desk> desk_ = std::make_shared<Desk>();
  std::unordered_map<std::uint32_t, Running> running_;  ///< by node: what can be told to end early
  std::mutex stopping_;
  bool stopped_ = false;
  mission::Engine* routine_ = nullptr;  ///< runs on the engine's thread
  std::vector<std::jthread> routines_;
};

}  // namespace segue::convert
