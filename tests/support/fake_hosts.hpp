// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/shared_mutex.hpp>
#include <segue/distributed/host_link.hpp>
#include <segue/distributed/local_host.hpp>
#include <support/fake_world.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

/// Computers with simulated deployment processes, and lines to their daemons that break and spoil calls on
/// request.
namespace segue::distributed::testing {

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
      const Lock lock(mutex_);
      ++calls_[what];
    }
    return ask(before_, what);
  }
  [[nodiscard]] std::optional<Error> after(const std::string& what) { return ask(after_, what); }

  /// How many calls of that name were made.
  [[nodiscard]] int calls(const std::string& what) const {
    const Lock lock(mutex_);
    const auto found = calls_.find(what);
    return found == calls_.end() ? 0 : found->second;
  }
  /// Sees the outcome of each call that was carried out.
  using Witness = std::function<void(const std::string& what, bool succeeded)>;
  void watch(Witness witness) { set(witness_, std::move(witness)); }
  void carried_out(const std::string& what, bool succeeded) {
    if (const auto witness = get(witness_)) witness(what, succeeded);
  }
  /// Calls without a result of which this is true succeed without being carried out.
  using Choice = std::function<bool(const std::string& what)>;
  void pretend(Choice which) { set(pretended_, std::move(which)); }
  [[nodiscard]] bool pretends(const std::string& what) {
    const auto which = get(pretended_);
    return which && which(what);
  }
  /// The order to commit waits where this is true, while its sender gives it up; deliver() gives its outcome.
  void delay_commit(Choice which) { set(delayed_, std::move(which)); }
  using Order = std::function<Result<void>()>;
  [[nodiscard]] bool delays(const Order& commit) {
    const auto which = get(delayed_);
    if (!which || !which("commit")) return false;
    set(late_, commit);
    return true;
  }
  [[nodiscard]] bool has_late_commit() { return get(late_) != nullptr; }
  std::optional<Result<void>> deliver() {
    const auto commit = get(late_);
    set(late_, Order());
    return commit ? std::optional(commit()) : std::nullopt;
  }
  /// Changes what the host says it holds.
  using Forgery = std::function<void(HostView&)>;
  void forge(Forgery forgery) { set(forgery_, std::move(forgery)); }
  [[nodiscard]] Result<HostView> forged(Result<HostView> view) {
    const auto forgery = get(forgery_);
    if (view && forgery) forgery(*view);
    return view;
  }

  /// Nobody can connect, and who is connected learns that it broke.
  void cut() {
    up_ = false;
    ++number_;
    const Lock lock(listening_);
    for (const auto& [who, gone] : std::exchange(gone_, {}))
      gone();
  }
  void mend() { up_ = true; }
  /// `see` is called before each attempt to connect.
  void on_attempt(std::function<void()> see) { set(attempted_, std::move(see)); }
  void attempt() {
    if (const auto see = get(attempted_)) see();
  }
  [[nodiscard]] bool up() const { return up_; }
  [[nodiscard]] int number() const { return number_; }
  void listen(const void* who, std::function<void()> gone) {
    const Lock lock(listening_);
    gone_[who] = std::move(gone);
  }
  /// It is not being told any more when this returns.
  void leave(const void* who) {
    const Lock lock(listening_);
    gone_.erase(who);
  }

 private:
  static Spoil once(const std::string& which, ErrorCode code) {
    return [which, code](const std::string& what) {
      return what == which ? std::optional<Error>(fail(code, "injected")) : std::nullopt;
    };
  }
  template <class Hook>
  void set(Hook& which, Hook hook) {
    const Lock lock(mutex_);
    which = std::move(hook);
  }
  template <class Hook>
  Hook get(const Hook& which) {
    const Lock lock(mutex_);
    return which;
  }
  std::optional<Error> ask(const Spoil& which, const std::string& what) {
    const Spoil spoil = get(which);
    return spoil ? spoil(what) : std::nullopt;
  }

  std::atomic<bool> up_{true};
  std::atomic<int> number_{0};
  mutable Mutex mutex_;  ///< protects everything below up to the next mutex
  std::map<std::string, int> calls_;
  Spoil before_;
  Spoil after_;
  Witness witness_;
  Choice pretended_;
  Choice delayed_;
  Order late_;
  Forgery forgery_;
  std::function<void()> attempted_;
  Mutex listening_;  ///< protects the member below; held while they are told
  std::map<const void*, std::function<void()>> gone_;
};

/// One connection. Calls after its line was cut are Unavailable.
class Wire {
 public:
  explicit Wire(Line& line) : line_(line), number_(line.number()) {}

  template <class Ask>
  auto pass(const std::string& what, Ask ask) const -> decltype(ask()) {
    if (auto error = lost_on_the_way(what)) return *error;
    if constexpr (std::is_same_v<decltype(ask()), Result<void>>) {
      if (line_.pretends(what)) return {};
    }
    auto answer = ask();
    line_.carried_out(what, answer.has_value());
    if (auto error = lost_on_the_way_back(what)) return *error;
    return answer;
  }
  [[nodiscard]] std::optional<Error> lost_on_the_way(const std::string& what) const {
    if (broken()) return fail(ErrorCode::Unavailable, "the line is cut");
    return line_.before(what);
  }
  [[nodiscard]] std::optional<Error> lost_on_the_way_back(const std::string& what) const {
    if (auto error = line_.after(what)) return error;
    return broken() ? std::optional(fail(ErrorCode::Unavailable, "the line is cut")) : std::nullopt;
  }
  [[nodiscard]] Line& line() const { return line_; }
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
  Result<HostView> snapshot() override {
    return wire_.line().forged(wire_.pass("snapshot", [&] { return robot_->snapshot(); }));
  }
  Result<void> expect(const model::Network& target) override {
    return wire_.pass("expect", [&] { return robot_->expect(target); });
  }
  Result<void> begin_transition(const model::Network& before, const model::Network& target) override {
    return wire_.pass("begin_transition", [&] { return robot_->begin_transition(before, target); });
  }
  void begin_in_order(std::vector<model::Action> actions, Duration action_deadline,
                      task_host::Completion completed) override {
    begin("begin_in_order", actions.size(), completed, [&](task_host::Completion report) {
      robot_->begin_in_order(std::move(actions), action_deadline, std::move(report));
    });
  }
  void begin_no_more() override {
    if (!wire_.broken()) robot_->begin_no_more();
  }
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
    const auto commit = [robot = robot_, number] { return robot->commit(number); };
    if (wire_.line().delays(commit)) return fail(ErrorCode::DeadlineExceeded, "no answer in time");
    return wire_.pass("commit", commit);
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
  void set_listener(task_host::TaskHost::Listener listener) override {
    robot_->set_listener(std::move(listener));
  }

  void begin_all(std::vector<model::Action> actions, TimePoint deadline,
                 task_host::Completion completed) override {
    begin("begin_all", actions.size(), completed, [&](task_host::Completion report) {
      robot_->begin_all(std::move(actions), deadline, std::move(report));
    });
  }
  Result<std::optional<task::SavedState>> save_state(const model::TaskId& task, TimePoint deadline) override {
    return wire_.pass("save_state", [&] { return robot_->save_state(task, deadline); });
  }
  Result<void> restore_state(const model::TaskId& task, const task::SavedState& state,
                             TimePoint deadline) override {
    return wire_.pass("restore_state", [&] { return robot_->restore_state(task, state, deadline); });
  }
  Result<model::ComponentModel> describe(const model::TaskId& task) const override {
    return wire_.pass("describe", [&] { return robot_->describe(task); });
  }
  Result<type::Value> properties(const model::TaskId& task) const override {
    return wire_.pass("properties", [&] { return robot_->properties(task); });
  }
  void watch(const task_host::LevelQuestion& question, const Wait& wait,
             task_host::LevelAnswer answered) override {
    const auto asked = wire_.pass("watch", [&]() -> Result<void> {
      robot_->watch(question, wait, answered);
      return {};
    });
    if (!asked) answered(asked.error());
  }
  Result<task_host::TaskDetails> details(const model::TaskId& task) const override {
    return wire_.pass("details", [&] { return robot_->details(task); });
  }
  Result<void> set_property(const model::TaskId& task, std::string_view path, const type::Value& value,
                            TimePoint deadline) override {
    return wire_.pass("set_property", [&] { return robot_->set_property(task, path, value, deadline); });
  }
  Result<type::Value> call(const model::TaskId& task, std::string_view operation,
                           const type::Value& arguments, TimePoint deadline) override {
    return wire_.pass("call", [&] { return robot_->call(task, operation, arguments, deadline); });
  }
  Result<void> write(const model::PortRef& port, const type::Value& value, TimePoint deadline) override {
    return wire_.pass("write", [&] { return robot_->write(port, value, deadline); });
  }
  Result<std::unique_ptr<task_host::PortReader>> open_reader(const model::PortRef& port,
                                                             std::size_t buffer) override {
    return wire_.pass("open_reader", [&] { return robot_->open_reader(port, buffer); });
  }

 private:
  /// Every action is reported once, also where that is lost on the way.
  template <class Begin>
  void begin(const std::string& what, std::size_t count, const task_host::Completion& completed,
             Begin begin) {
    if (const auto error = wire_.lost_on_the_way(what)) {
      std::vector<task_host::Completed> refused;
      for (std::size_t i = 0; i < count; ++i)
        refused.push_back({i, *error});
      return completed(std::move(refused));
    }
    begin([wire = wire_, what, completed](std::vector<task_host::Completed> ended) {
      if (const auto error = wire.lost_on_the_way_back(what)) {
        for (auto& one : ended)
          one.outcome = *error;
      }
      completed(std::move(ended));
    });
  }

  Wire wire_;
  const std::shared_ptr<HostedRobot> robot_;
};

/// Goes on like the real one, and jumps ahead on request.
class AdvancingClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override { return RealClock::instance().now() + ahead_.load(); }
  void sleep_until(TimePoint when) override { RealClock::instance().sleep_until(when - ahead_.load()); }
  void advance(Duration duration) { ahead_ = ahead_.load() + duration; }

 private:
  std::atomic<Duration> ahead_{Duration(0)};
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
    const WriteLock alone(booting);
    local.reset();
    auto made = LocalHost::create(processes, deploy::testing::connector(world),
                                  {model::HostName(name), folder, clock});
    EXPECT_TRUE(made) << to_string(made.error());
    local = std::move(*made);
  }

  HostPlace place(bool optional = false) { return place_over(line, optional); }
  /// Over lines of somebody else, which outlive whoever connects.
  HostPlace place_over(Line& lines, bool optional = false) {
    return {model::HostName(name), "fake://" + name, optional,
            [this, &lines](TimePoint, std::function<void()> gone) -> Result<std::unique_ptr<HostService>> {
              lines.attempt();
              if (!lines.up()) return fail(ErrorCode::Unavailable, "nobody answers");
              auto daemon = std::make_unique<Daemon>(*this, lines);
              lines.listen(daemon.get(), std::move(gone));
              return daemon;
            }};
  }

  const std::string name;
  std::filesystem::path folder;
  deploy::testing::FakeWorld world;
  deploy::testing::FakeProcesses processes{world};
  AdvancingClock clock;
  SharedMutex booting;  ///< protects the member below, which boot() replaces
  std::unique_ptr<LocalHost> local;
  std::vector<LibraryInfo> libraries;  ///< what the daemon says that it has
  std::string architecture = "x86_64";
  Line line;

 private:
  class Daemon final : public HostService {
   public:
    Daemon(Computer& computer, Line& line) : computer_(computer), wire_(line) {}
    ~Daemon() override { wire_.line().leave(this); }
    Daemon(const Daemon&) = delete;
    Daemon& operator=(const Daemon&) = delete;
    Result<HostInfo> info() override {
      return wire_.pass("info", [&]() -> Result<HostInfo> {
        return HostInfo{model::HostName(computer_.name), "0.1.0", computer_.architecture, 1,
                        computer_.libraries};
      });
    }
    Result<std::chrono::system_clock::time_point> clock() override {
      return wire_.pass("clock", [&] {
        const ReadLock running(computer_.booting);
        return computer_.local->clock();
      });
    }
    Result<std::vector<LeaseInfo>> robots() override {
      return wire_.pass("robots", [&] {
        const ReadLock running(computer_.booting);
        return computer_.local->robots();
      });
    }
    Result<std::uint64_t> highest_term(const std::string& robot) override {
      return wire_.pass("highest_term", [&] {
        const ReadLock running(computer_.booting);
        return computer_.local->highest_term(robot);
      });
    }
    Result<process_server::LogPart> log(const LogRequest& request) override {
      return wire_.pass("log", [&] { return computer_.local->log(request); });
    }
    Result<std::shared_ptr<HostedRobot>> acquire(const RobotRequest& request, TimePoint deadline) override {
      return wire_.pass("acquire", [&]() -> Result<std::shared_ptr<HostedRobot>> {
        const ReadLock running(computer_.booting);
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
  request.secret = "secret of " + holder;
  request.launch.robot = "robot";
  request.launch.stand_in = true;
  request.take_over = take_over;
  return request;
}

}  // namespace segue::distributed::testing
