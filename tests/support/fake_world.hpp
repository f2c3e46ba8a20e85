// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/fleet/deployed_task_host.hpp>

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

/// Simulated deployment processes for tests of DeployedTaskHost. They keep the state that actions give them,
/// and fail on request.
namespace segue::deploy::testing {

enum class FaultKind { Fail, LoseAnswer, Hang, Die, DieAfterwards };

/// A fault that is injected into one call: the call with number `at`, counted from 1 since set_fault().
struct Fault {
  int at = 0;
  FaultKind kind = FaultKind::Fail;
};

/// Output ports of this name have no type.
inline constexpr const char* kPortWithoutType = "any";

struct FakeProcess {
  process_server::ProcessInfo info;
  model::Deployment deployment;
  sample_link::Incarnation incarnation = 0;
  bool alive = true;
  bool hangs = false;
  int crashed_by = 0;  ///< the signal by which it ends before it can be asked to; 0: none
  bool other_version = false;
  std::map<model::TaskId, model::Task> tasks;
  std::set<model::TaskId> hanging;
  std::map<model::TaskId, task::SavedState> states;  ///< states saved by tasks
  std::vector<model::Connection> connections;
  std::vector<model::Connection> dormant;  ///< among `connections`
  std::vector<EndpointReport> endpoints;
  std::shared_ptr<task::CommitGate> gate;  ///< of the transition that dormant connections wait for
  [[nodiscard]] bool committed() const { return gate != nullptr && gate->open(); }
  std::vector<model::Connection> ended;  ///< among `connections`: by an earlier commit
  ArmCommit ending;                      ///< what ends with the transition
  [[nodiscard]] bool carries(const model::Connection& connection) const {
    const auto is_in = [&](const std::vector<model::Connection>& some) {
      return std::find(some.begin(), some.end(), connection) != some.end();
    };
    return !is_in(ended) && !is_in(committed() ? ending.within : dormant);
  }
  [[nodiscard]] bool carries(const EndpointReport& endpoint) const {
    const auto ends = [&](const ArmCommit::Endpoint& one) {
      return one.connection == endpoint.connection && one.side == endpoint.side && one.peer == endpoint.peer;
    };
    return committed() ? std::none_of(ending.endpoints.begin(), ending.endpoints.end(), ends)
                       : endpoint.carries;
  }
  std::set<sample_link::Incarnation> admitted;
  DeploymentService::Listener listener;
  std::function<void()> gone;
};
using FakePtr = std::shared_ptr<FakeProcess>;

/// All simulated processes and the faults to inject. Thread safe.
class FakeWorld {
 public:
  FakeWorld();
  ~FakeWorld();

  /// Interface for tests.
  void set_fault(Fault fault);
  void clear_fault();
  [[nodiscard]] bool fault_happened() const;
  [[nodiscard]] int calls(const std::string& what) const;
  /// The network that TaskHost::observe() has to show.
  [[nodiscard]] model::Network truth() const;
  [[nodiscard]] std::size_t orphaned_endpoints() const;
  /// Which those are, for messages.
  [[nodiscard]] std::vector<std::string> orphans() const;
  [[nodiscard]] FakePtr find(const std::string& process) const;  ///< the first of that name
  [[nodiscard]] FakePtr find(const model::DeploymentKey& key) const;
  FakePtr own() { return own_; }
  /// The process ends; by itself, unless its process server was asked to end it (`requested`).
  void kill(const FakePtr& process, int signal = 9, bool requested = false);
  /// Breaks the connection to the process, which lives on.
  void cut(const FakePtr& process);
  /// Adds a process that runs already.
  FakePtr add_running(const std::string& process);
  void change(const std::function<void()>& what);
  void tell(const FakePtr& process, const task_host::TaskEvent& event);
  /// `see` is called before each call with its name and process, without a lock held.
  void on_call(std::function<void(const std::string& what, const FakePtr& process)> see);
  /// The call to perform actions that is the `count`th from now on is not carried out, but answered as if it
  /// had been.
  void pretend_actions(int count) { pretended_ = count; }
  [[nodiscard]] bool pretends() { return pretended_ > 0 && --pretended_ == 0; }
  /// The process that is ended next lives on unseen: whoever asked is told that it has ended.
  void next_survives() { survives_ = true; }
  [[nodiscard]] bool survives() { return survives_.exchange(false); }
  /// The next process that start() starts dies at once.
  void next_dies_at_once() { next_dies_ = true; }

  /// Interface for the fakes.
  struct Verdict {
    std::optional<Error> answer;  ///< instead of the real answer
    bool take_effect = true;
    bool die_afterwards = false;
  };
  Verdict judge(const std::string& what, const FakePtr& process);
  FakePtr start(const process_server::Launch& launch);
  [[nodiscard]] std::vector<FakePtr> running() const;
  [[nodiscard]] FakePtr of(sample_link::Incarnation incarnation) const;  ///< with the lock held
  std::uint64_t next_place() { return ++places_; }                       ///< likewise
  mutable Mutex mutex;
  process_server::ProcessService::Listener exit_listener;

 private:
  void later(std::function<void()> what);

  FakePtr own_;
  std::map<model::DeploymentKey, FakePtr> processes_;
  std::optional<Fault> fault_;
  int count_ = 0;
  bool happened_ = false;
  std::atomic<bool> next_dies_ = false;
  std::atomic<int> pretended_ = 0;
  std::atomic<bool> survives_ = false;
  std::map<std::string, int> calls_;
  std::uint64_t places_ = 0;
  int lives_ = 0;
  std::function<void(const std::string&, const FakePtr&)> see_;
  std::vector<std::future<void>> later_;
};

class FakeService final : public DeploymentService {
 public:
  FakeService(FakeWorld& world, FakePtr process) : world_(world), process_(std::move(process)) {}

  Result<DeploymentInfo> info() override;
  Result<Snapshot> snapshot() override;
  Result<void> expect(const model::Network& network) override;
  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override;
  Result<void> arm_commit(const ArmCommit& what, TimePoint deadline) override;
  Result<void> settle(TimePoint deadline) override;
  Result<void> conclude(const model::Transition& transition, TimePoint deadline) override;
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override;
  Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                             TimePoint deadline) override;
  Result<model::ComponentModel> describe(const model::TaskId& task) const override;
  Result<type::Value> properties(const model::TaskId& task) const override;
  void watch(const task_host::LevelQuestion& question, const Wait& wait,
             task_host::LevelAnswer answered) override;
  Result<task_host::TaskDetails> details(const model::TaskId& task) const override;
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override;
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override;
  Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) override;
  Result<std::unique_ptr<task_host::PortReader>> open_reader(const model::PortRef& port,
                                                             std::size_t buffer) override;
  Result<sample_link::MemoryOffer> memory(TimePoint deadline) override;
  Result<void> admit(const sample_link::MemoryOffer& peer, TimePoint deadline) override;
  Result<void> forget(sample_link::Incarnation peer) override;
  std::vector<Result<sample_link::OutputOrigin>> describe_outputs(std::span<const model::PortRef> ports,
                                                                  TimePoint deadline) override;
  std::vector<Result<sample_link::InputPlace>> open_inputs(std::span<const OpenInput> inputs,
                                                           TimePoint deadline) override;
  std::vector<Result<void>> attach_outputs(std::span<const AttachOutput> outputs,
                                           TimePoint deadline) override;
  std::vector<Result<void>> close_endpoints(std::span<const CloseEndpoint> endpoints,
                                            TimePoint deadline) override;
  void set_listener(Listener listener) override;

 private:
  template <class T, class Effect>
  Result<T> answer(const std::string& what, Effect effect) const;
  template <class T, class Question, class Effect>
  std::vector<Result<T>> answer_all(const std::string& what, std::span<const Question> questions,
                                    Effect effect);
  Result<void> act(const model::Action& action);
  Result<void> act_on_task(const model::Action& action, model::Task& task);
  Result<void> act_on_connection(const model::Action& action);
  void forget_connections_of(const model::TaskId& task);

  FakeWorld& world_;
  FakePtr process_;
};

class FakeProcesses final : public process_server::ProcessService {
 public:
  explicit FakeProcesses(FakeWorld& world) : world_(world) {}
  Result<process_server::ProcessInfo> start(const process_server::Launch& launch,
                                            TimePoint deadline) override;
  Result<process_server::ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override;
  Result<process_server::ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint deadline) override;
  Result<std::vector<process_server::ProcessInfo>> processes(const std::string& robot) override;
  void set_listener(Listener listener) override;

 private:
  Result<process_server::ExitReason> end(const std::string& how, const model::DeploymentKey& key, int signal);

  FakeWorld& world_;
};

/// Connects to the simulated process that has the socket.
fleet::Connector connector(FakeWorld& world);

}  // namespace segue::deploy::testing
