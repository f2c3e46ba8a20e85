// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/hosts/host_link.hpp>
#include <segue/hosts/local_host.hpp>
#include <support/fake_world.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

/// Computers with simulated deployment processes, and lines to their daemons that break and spoil calls on
/// request.
namespace segue::hosts::testing {

/// The lines to one computer. Thread safe.
class Line {
 public:
  /// An error that a call has instead of its effect, or instead of its answer; nothing where all is well.
  using Spoil = std::function<std::optional<Error>(const std::string& what)>;

  void spoil_calls(Spoil spoil) { set(before_, std::move(spoil)); }
  void spoil_answers(Spoil spoil) { set(after_, std::move(spoil)); }
  void spoil_call(const std::string& which, ErrorCode code) { spoil_calls(once(which, code)); }
  void spoil_answer(const std::string& which, ErrorCode code) { spoil_answers(once(which, code)); }
  [[nodiscard]] std::optional<Error> before(const std::string& what) {
    {
      const std::lock_guard lock(mutex_);
      ++calls_[what];
    }
    return ask(before_, what);
  }
  [[nodiscard]] std::optional<Error> after(const std::string& what) { return ask(after_, what); }

  /// How many calls of that name were made.
  [[nodiscard]] int calls(const std::string& what) const {
    const std::lock_guard lock(mutex_);
    const auto found = calls_.find(what);
    return found == calls_.end() ? 0 : found->second;
  }

  /// Nobody can connect, and who is connected learns that it broke.
  void cut() {
    up_ = false;
    ++number_;
    const std::lock_guard lock(listening_);
    for (const auto& [who, gone] : std::exchange(gone_, {}))
      gone();
  }
  void mend() { up_ = true; }
  [[nodiscard]] bool up() const { return up_; }
  [[nodiscard]] int number() const { return number_; }
  void listen(const void* who, std::function<void()> gone) {
    const std::lock_guard lock(listening_);
    gone_[who] = std::move(gone);
  }
  /// It is not being told any more when this returns.
  void leave(const void* who) {
    const std::lock_guard lock(listening_);
    gone_.erase(who);
  }

 private:
  static Spoil once(const std::string& which, ErrorCode code) {
    return [which, code](const std::string& what) {
      return what == which ? std::optional<Error>(fail(code, "injected")) : std::nullopt;
    };
  }
  void set(Spoil& which, Spoil spoil) {
    const std::lock_guard lock(mutex_);
    which = std::move(spoil);
  }
  std::optional<Error> ask(const Spoil& which, const std::string& what) {
    Spoil spoil;
    {
      const std::lock_guard lock(mutex_);
      spoil = which;
    }
    return spoil ? spoil(what) : std::nullopt;
  }

  std::atomic<bool> up_{true};
  std::atomic<int> number_{0};
  mutable std::mutex mutex_;  ///< protects the three below
  std::map<std::string, int> calls_;
  Spoil before_;
  Spoil after_;
  std::mutex listening_;  ///< protects the member below; held while they are told
  std::map<const void*, std::function<void()>> gone_;
};

/// One connection. Calls after its line was cut are Unavailable.
class Wire {
 public:
  explicit Wire(Line& line) : line_(line), number_(line.number()) {}

  template <class Ask>
  auto pass(const std::string& what, Ask ask) -> decltype(ask()) {
    if (broken()) return fail(ErrorCode::Unavailable, "the line is cut");
    if (auto error = line_.before(what)) return *error;
    auto answer = ask();
    if (auto error = line_.after(what)) return *error;
    if (broken()) return fail(ErrorCode::Unavailable, "the line is cut");
    return answer;
  }
  [[nodiscard]] bool broken() const { return !line_.up() || line_.number() != number_; }

 private:
  Line& line_;
  const int number_;
};

class WiredRobot final : public HostedRobot {
 public:
  WiredRobot(Wire wire, std::shared_ptr<HostedRobot> robot) : wire_(wire), robot_(std::move(robot)) {}
  ~WiredRobot() override { robot_->set_listener({}); }

  Result<void> renew() override {
    return wire_.pass("renew", [&] { return robot_->renew(); });
  }
  Result<void> release() override {
    return wire_.pass("release", [&] { return robot_->release(); });
  }
  Result<HostView> look() override {
    return wire_.pass("look", [&] { return robot_->look(); });
  }
  Result<void> expect(const model::Network& target) override {
    return wire_.pass("expect", [&] { return robot_->expect(target); });
  }
  Result<void> begin_transition(const model::Network& before, const model::Network& target) override {
    return wire_.pass("begin_transition", [&] { return robot_->begin_transition(before, target); });
  }
  void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                      host::Completion completed) override {
    const std::size_t count = actions.size();
    const auto passed = wire_.pass("begin_in_order", [&]() -> Result<void> {
      robot_->begin_in_order(std::move(actions), action_deadline, completed);
      return {};
    });
    if (!passed) refuse(count, passed.error(), completed);
  }
  void halt() override { robot_->halt(); }
  Result<void> get_ready(const model::Network& target, const std::vector<LinkWait>& links,
                         TimePoint deadline) override {
    return wire_.pass("get_ready", [&] { return robot_->get_ready(target, links, deadline); });
  }
  Result<void> arm_commit(const model::Transition& transition, std::uint64_t number,
                          TimePoint deadline) override {
    return wire_.pass("arm_commit", [&] { return robot_->arm_commit(transition, number, deadline); });
  }
  Result<void> vote(std::uint64_t number, Duration validity) override {
    return wire_.pass("vote", [&] { return robot_->vote(number, validity); });
  }
  Result<void> commit(std::uint64_t number) override {
    return wire_.pass("commit", [&] { return robot_->commit(number); });
  }
  Result<void> conclude(const model::Transition& transition) override {
    return wire_.pass("conclude", [&] { return robot_->conclude(transition); });
  }
  Result<void> withdraw() override {
    return wire_.pass("withdraw", [&] { return robot_->withdraw(); });
  }
  Result<void> end_processes(TimePoint deadline) override {
    return wire_.pass("end_processes", [&] { return robot_->end_processes(deadline); });
  }
  void set_listener(host::TaskHost::Listener listener) override { robot_->set_listener(std::move(listener)); }

  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 host::Completion completed) override {
    const std::size_t count = actions.size();
    const auto passed = wire_.pass("begin_all", [&]() -> Result<void> {
      robot_->begin_all(std::move(actions), deadline, completed);
      return {};
    });
    if (!passed) refuse(count, passed.error(), completed);
  }
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override {
    return wire_.pass("save_state", [&] { return robot_->save_state(task, deadline); });
  }
  Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                             TimePoint deadline) override {
    return wire_.pass("restore_state", [&] { return robot_->restore_state(task, state, deadline); });
  }
  Result<model::ComponentModel> describe(const model::TaskId& task) override {
    return wire_.pass("describe", [&] { return robot_->describe(task); });
  }
  Result<type::Value> properties(const model::TaskId& task) override {
    return wire_.pass("properties", [&] { return robot_->properties(task); });
  }
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override {
    return wire_.pass("set_property", [&] { return robot_->set_property(task, path, value, deadline); });
  }
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override {
    return wire_.pass("call", [&] { return robot_->call(task, operation, arguments, deadline); });
  }
  Result<std::unique_ptr<host::PortReader>> open_reader(const model::PortRef& port,
                                                        std::size_t buffer) override {
    return wire_.pass("open_reader", [&] { return robot_->open_reader(port, buffer); });
  }

 private:
  static void refuse(std::size_t count, const Error& why, const host::Completion& completed) {
    std::vector<host::Completed> refused;
    for (std::size_t i = 0; i < count; ++i)
      refused.push_back({i, why});
    completed(std::move(refused));
  }

  Wire wire_;
  const std::shared_ptr<HostedRobot> robot_;
};

/// A computer with a daemon. Its name is that of the first host in its libraries' answers.
class Computer {
 public:
  explicit Computer(std::string called) : name(std::move(called)) {
    std::string pattern = ::testing::TempDir() + "segue-host-XXXXXX";
    EXPECT_NE(::mkdtemp(pattern.data()), nullptr);
    folder = pattern;
    boot();
  }
  ~Computer() {
    local.reset();
    std::filesystem::remove_all(folder);
  }
  Computer(const Computer&) = delete;
  Computer& operator=(const Computer&) = delete;

  /// The daemon starts; processes that run already are adopted.
  void boot() {
    local.reset();
    auto made =
        LocalHost::create(processes, deploy::testing::connector(world), {model::HostName(name), folder});
    EXPECT_TRUE(made) << to_string(made.error());
    local = std::move(*made);
  }

  HostPlace place(bool optional = false) {
    return {model::HostName(name), "fake://" + name, optional,
            [this](TimePoint, std::function<void()> gone) -> Result<std::unique_ptr<HostService>> {
              if (!line.up()) return fail(ErrorCode::Unavailable, "nobody answers");
              auto daemon = std::make_unique<Daemon>(*this);
              line.listen(daemon.get(), std::move(gone));
              return daemon;
            }};
  }

  const std::string name;
  std::filesystem::path folder;
  deploy::testing::FakeWorld world;
  deploy::testing::FakeProcesses processes{world};
  std::unique_ptr<LocalHost> local;
  std::vector<LibraryInfo> libraries;  ///< what the daemon says that it has
  std::string architecture = "x86_64";
  Line line;

 private:
  class Daemon final : public HostService {
   public:
    explicit Daemon(Computer& computer) : computer_(computer), wire_(computer.line) {}
    ~Daemon() override { computer_.line.leave(this); }
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;
    Result<HostInfo> info() override {
      return wire_.pass("info", [&]() -> Result<HostInfo> {
        return HostInfo{model::HostName(computer_.name), "0.1.0", computer_.architecture, 1,
                        computer_.libraries};
      });
    }
    Result<std::chrono::system_clock::time_point> clock() override {
      return wire_.pass("clock", [&] { return computer_.local->clock(); });
    }
    Result<std::vector<LeaseInfo>> robots() override {
      return wire_.pass("robots", [&] { return computer_.local->robots(); });
    }
    Result<process::LogPart> log(const LogRequest& request) override {
      return wire_.pass("log", [&] { return computer_.local->log(request); });
    }
    Result<std::shared_ptr<HostedRobot>> acquire(const RobotRequest& request, TimePoint deadline) override {
      return wire_.pass("acquire", [&]() -> Result<std::shared_ptr<HostedRobot>> {
        auto robot = computer_.local->acquire(request, deadline);
        if (!robot) return robot.error();
        return std::make_shared<WiredRobot>(wire_, std::move(*robot));
      });
    }

   private:
    Computer& computer_;
    Wire wire_;
  };
};

inline RobotRequest request_of(const std::string& holder, bool take_over = false) {
  RobotRequest request;
  request.holder = holder;
  request.launch.robot = "robot";
  request.launch.stand_in = true;
  request.take_over = take_over;
  return request;
}

}  // namespace segue::hosts::testing
