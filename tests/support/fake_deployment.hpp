// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/control/deployment_client.hpp>
#include <segue/control/server.hpp>
#include <segue/model/component_model.hpp>
#include <segue/task_host/action_pool.hpp>
#include <segue/task_host/watches.hpp>
#include <support/eventually.hpp>
#include <support/fake_robot_service.hpp>

#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

/// Services that echo their arguments or return preset results, so that tests see what was transferred.
namespace segue::control {

inline Descriptor memory_with(std::string_view text) {
  Descriptor memory(::memfd_create("test", MFD_CLOEXEC));
  EXPECT_EQ(::write(memory.get(), text.data(), text.size()), static_cast<ssize_t>(text.size()));
  return memory;
}

inline std::string content_of(const Descriptor& memory) {
  std::string text(64, '\0');
  const auto size = ::pread(memory.get(), text.data(), text.size(), 0);
  text.resize(size > 0 ? static_cast<std::size_t>(size) : 0);
  return text;
}

inline std::size_t open_descriptors() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator("/proc/self/fd"))
    ++count;
  return count;
}

using testing::eventually;

inline model::Action action_of(model::ActionKind kind, const std::string& task) {
  return {1, kind, model::TaskAction{model::TaskId(task)}, model::Phase::Commit, {}};
}

/// Lock for fields that calls write: the socket orders the threads, but the sanitizer does not know that.
template <class Fake>
class Seen {
 public:
  Seen(const Fake& fake, Mutex& fields) : fake_(fake), lock_(fields) {}
  const Fake* operator->() const { return &fake_; }

 private:
  const Fake& fake_;
  Lock lock_;
};

class FakeDeployment final : public deploy::DeploymentService {
 public:
  Gate entered;  ///< a blocking call has begun
  Gate release;  ///< releases blocking calls
  Gate dropped;  ///< whoever waited for a change of a task waits no longer
  std::atomic<int> open_readers{0};
  std::atomic<int> listeners_set{0};

  // Preset results and last arguments; set before and read after the call.
  deploy::DeploymentInfo who{};
  deploy::Snapshot now{};
  model::Network expected{};
  model::Transition concluded{};
  deploy::ArmCommit armed{};
  int settled = 0;
  type::Value wrote{};
  std::vector<model::Action> performed{};
  model::ComponentModel component{};
  task_host::TaskDetails task_details{};
  std::string state_name{};
  type::Value value{};
  std::optional<task::SavedState> state{};
  std::string written{};
  sample_link::Incarnation forgotten = 0;
  std::vector<std::string> admitted{};
  sample_link::InputPlace place{};
  std::vector<deploy::OpenInput> opened{};
  std::vector<deploy::AttachOutput> attached{};
  std::vector<deploy::CloseEndpoint> closed{};
  Duration left{0};

  Result<deploy::DeploymentInfo> info() override { return who; }
  Result<deploy::Snapshot> snapshot() override {
    const Lock lock(fields_);
    return now;
  }
  Result<void> expect(const model::Network& network) override {
    const Lock lock(fields_);
    expected = network;
    return {};
  }
  /// A stop of "wait" blocks, one of "bad" fails; a batch with one of "throws" throws.
  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override {
    note(deadline);
    {
      const Lock lock(fields_);
      performed = actions;
    }
    for (const model::Action& action : actions) {
      if (action.task() != nullptr && action.task()->str() == "throws") throw std::runtime_error("a defect");
    }
    actions_.begin(std::move(actions), deadline, std::move(completed));
  }
  Result<void> arm_commit(const deploy::ArmCommit& what, TimePoint /*deadline*/) override {
    const Lock lock(fields_);
    armed = what;
    return {};
  }
  Result<void> settle(TimePoint /*deadline*/) override {
    const Lock lock(fields_);
    ++settled;
    return {};
  }
  Result<void> conclude(const model::Transition& transition, TimePoint /*deadline*/) override {
    const Lock lock(fields_);
    concluded = transition;
    return {};
  }
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override {
    note(deadline);
    if (task.str() == "no") return fail(ErrorCode::NotFound, "no task");
    const Lock lock(fields_);
    return state;
  }
  Result<void> restore_state(const model::TaskId& task, const task::SavedState& given,
                             TimePoint deadline) override {
    note(deadline);
    if (task.str() == "no") return fail(ErrorCode::NotFound, "no task");
    const Lock lock(fields_);
    state = given;
    return {};
  }
  Result<model::ComponentModel> describe(const model::TaskId& task) const override {
    if (task.str() == "throws") throw std::runtime_error("a defect");
    return component;
  }
  Result<type::Value> properties(const model::TaskId& task) const override {
    if (task.str() == "no") return fail(ErrorCode::NotFound, "no task");
    const Lock lock(fields_);
    return value;
  }
  /// Keeps a question whose asker has seen the level, until become() or its stop.
  void watch(const task_host::LevelQuestion& question, const Wait& wait,
             task_host::LevelAnswer answered) override {
    if (question.task.str() == "no") return answered(fail(ErrorCode::NotFound, "no task"));
    watches_.add(wait, [this, question, answered](task_host::detail::Watches::End end) {
      if (end == task_host::detail::Watches::End::Stop) {
        dropped.open();
        answered(no_longer_wanted());
        return true;
      }
      Lock lock(fields_);
      const task_host::TaskLevel level{TaskState::Running, state_name, 7};
      lock.unlock();
      if (end == task_host::detail::Watches::End::No && !question.is_news(level)) return false;
      answered(level);
      return true;
    });
  }
  void become(std::string name) {
    {
      const Lock lock(fields_);
      state_name = std::move(name);
    }
    watches_.ring();
  }
  Result<task_host::TaskDetails> details(const model::TaskId& task) const override {
    if (task.str() == "no") return fail(ErrorCode::NotFound, "no task");
    const Lock lock(fields_);
    return task_details;
  }
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& set,
                            TimePoint deadline) override {
    note(deadline);
    const Lock lock(fields_);
    written = task.str() + "." + std::string(path);
    value = set;
    return {};
  }
  Result<type::Value> call(const model::TaskId&, std::string_view operation, const type::Value& arguments,
                           TimePoint deadline) override {
    if (operation == "echo") return arguments;
    // A hook that never returns ignores deadlines.
    if (auto done = wait(operation == "hang" ? deadline + kLong : deadline); !done) return done.error();
    return type::Value("released");
  }
  Result<void> write(const model::PortRef& port, const type::Value& sample, TimePoint /*deadline*/) override {
    const Lock lock(fields_);
    wrote = type::Value::map({{"port", to_string(port)}, {"value", sample}});
    return {};
  }
  Result<std::unique_ptr<task_host::PortReader>> open_reader(const model::PortRef& port,
                                                             std::size_t buffer) override {
    if (port.port != "out") return fail(ErrorCode::NotFound, "no port");
    return std::make_unique<Numbers>(open_readers, static_cast<int>(buffer));
  }
  Result<sample_link::MemoryOffer> memory(TimePoint /*deadline*/) override {
    return sample_link::MemoryOffer{7, memory_with("payload"), memory_with("control")};
  }
  Result<void> admit(const sample_link::MemoryOffer& peer, TimePoint /*deadline*/) override {
    const Lock lock(fields_);
    admitted = {std::to_string(peer.incarnation), content_of(peer.payload), content_of(peer.control)};
    return {};
  }
  Result<void> forget(sample_link::Incarnation peer) override {
    const Lock lock(fields_);
    forgotten = peer;
    return {};
  }
  std::vector<Result<sample_link::OutputOrigin>> describe_outputs(std::span<const model::PortRef> ports,
                                                                  TimePoint deadline) override {
    note(deadline);
    std::vector<Result<sample_link::OutputOrigin>> origins;
    for (const auto& port : ports) {
      if (port.port == "no")
        origins.push_back(fail(ErrorCode::NotFound, "no port"));
      else
        origins.push_back(sample_link::OutputOrigin{7, port.port.size(), true});
    }
    return origins;
  }
  std::vector<Result<sample_link::InputPlace>> open_inputs(std::span<const deploy::OpenInput> inputs,
                                                           TimePoint deadline) override {
    note(deadline);
    const Lock lock(fields_);
    opened.assign(inputs.begin(), inputs.end());
    return {inputs.size(), Result<sample_link::InputPlace>(place)};
  }
  std::vector<Result<void>> attach_outputs(std::span<const deploy::AttachOutput> outputs,
                                           TimePoint deadline) override {
    note(deadline);
    const Lock lock(fields_);
    attached.assign(outputs.begin(), outputs.end());
    return std::vector<Result<void>>(outputs.size());
  }
  std::vector<Result<void>> close_endpoints(std::span<const deploy::CloseEndpoint> endpoints,
                                            TimePoint deadline) override {
    note(deadline);
    const Lock lock(fields_);
    closed.assign(endpoints.begin(), endpoints.end());
    return std::vector<Result<void>>(endpoints.size());
  }
  void set_listener(Listener listener) override {
    const Lock lock(mutex_);
    listener_ = std::move(listener);
    ++listeners_set;
  }

  void hold(const model::Network& network) {
    const Lock lock(fields_);
    now.network = network;
  }
  Seen<FakeDeployment> seen() { return {*this, fields_}; }

  void tell(const task_host::TaskEvent& event) {
    const Lock lock(mutex_);
    if (listener_) listener_(event);
  }

 private:
  void note(TimePoint deadline) {
    const Lock lock(fields_);
    left = deadline - RealClock::instance().now();
  }
  Result<void> wait(TimePoint deadline) {
    entered.open();
    if (!release.wait_until(deadline)) return fail(ErrorCode::DeadlineExceeded, "nobody let me go");
    return {};
  }

  class Numbers final : public task_host::PortReader {
   public:
    Numbers(std::atomic<int>& open, int first) : open_(open), last_(first) { ++open_; }
    ~Numbers() override { --open_; }
    std::vector<type::Value> read(std::size_t limit) override {
      std::vector<type::Value> samples;
      while (samples.size() < limit)
        samples.emplace_back(++last_);
      return samples;
    }
    void next(std::size_t limit, const Wait& /*wait*/, task_host::SamplesAnswer answered) override {
      answered(read(limit));
    }
    [[nodiscard]] std::string type_name() const override { return "/int32_t"; }

   private:
    std::atomic<int>& open_;
    int last_;
  };

  mutable Mutex fields_;
  Mutex mutex_;
  Listener listener_;
  concurrent::ThreadPool threads_{"fake", task_host::kActionThreads};
  task_host::ActionPool actions_{
      threads_, [this](const model::Action& action, TimePoint deadline) -> Result<void> {
        const std::string task = action.task() != nullptr ? action.task()->str() : "";
        if (task == "wait") return wait(deadline);
        if (task == "bad") return fail(ErrorCode::HookFailed, "it is bad", "bad");
        return {};
      }};
  task_host::detail::Watches watches_;
};

class FakeProcesses final : public process_server::ProcessService {
 public:
  process_server::Launch launched{};
  process_server::ProcessInfo process{};
  process_server::ExitReason exit{};
  std::string asked{};

  Result<process_server::ProcessInfo> start(const process_server::Launch& launch, TimePoint) override {
    const Lock lock(fields_);
    launched = launch;
    if (launch.robot == "twice") return fail(ErrorCode::AlreadyExists, "it runs");
    return process;
  }
  Result<process_server::ExitReason> stop(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint) override {
    const Lock lock(fields_);
    asked = robot + ":" + to_string(key);
    return exit;
  }
  Result<process_server::ExitReason> kill(const std::string& robot, const model::DeploymentKey& key,
                                          TimePoint) override {
    const Lock lock(fields_);
    asked = "kill " + robot + ":" + to_string(key);
    return exit;
  }
  Result<std::vector<process_server::ProcessInfo>> processes(const std::string& robot) override {
    const Lock lock(fields_);
    asked = robot;
    return std::vector<process_server::ProcessInfo>{process, {}};
  }
  Seen<FakeProcesses> seen() { return {*this, fields_}; }
  void set_listener(Listener listener) override {
    const Lock lock(mutex_);
    listener_ = std::move(listener);
  }
  void tell(const process_server::ProcessInfo& event) {
    const Lock lock(mutex_);
    if (listener_) listener_(event);
  }

 private:
  Mutex fields_;
  Mutex mutex_;
  Listener listener_;
};

/// A deployment behind a socket.
class DeploymentTest : public ControlTest {
 protected:
  void TearDown() override {
    deployment_.release.open();
    ControlTest::TearDown();
  }
  void serve() {
    auto server = Server::listen(socket_, &deployment_);
    ASSERT_TRUE(server) << to_string(server.error());
    server_ = std::move(*server);
  }
  std::unique_ptr<deploy::DeploymentService> client(std::function<void()> gone = nullptr) {
    auto connected = connect_deployment(socket_, soon(), std::move(gone));
    EXPECT_TRUE(connected) << to_string(connected.error());
    return connected ? std::move(connected->service) : nullptr;
  }

  FakeDeployment deployment_;
};

}  // namespace segue::control
