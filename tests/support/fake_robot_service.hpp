// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/control/robot_service.hpp>
#include <segue/control/server.hpp>
#include <segue/task_host/watches.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>

namespace segue::control {

inline constexpr auto kLong = std::chrono::seconds(20);

inline TimePoint soon() {
  return RealClock::instance().now() + kLong;
}

/// Opens once; tests wait for it with a time limit.
class Gate {
 public:
  void open() {
    const Lock lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  bool wait_until(TimePoint deadline) {
    Lock lock(mutex_);
    return changed_.wait_until(mutex_, deadline, [this] { return open_; });
  }
  bool wait() { return wait_until(soon()); }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  bool open_ = false;
};

/// Echoes its arguments, so that tests see what was transferred.
class FakeRobotService : public RobotService {
 public:
  Gate entered;  ///< a blocking call has begun
  Gate release;  ///< releases blocking calls
  Gate dropped;  ///< the caller of a blocking call waits no longer
  std::atomic<int> open_streams{0};
  std::atomic<bool> asked_to_end{false};
  std::atomic<int> leases{0};              ///< that are held
  std::atomic<bool> is_taken_over{false};  ///< by "somebody"
  std::atomic<bool> is_stopped{false};     ///< its mission
  std::atomic<bool> lease_blocks{false};   ///< whoever looks at it calls a blocking function

  using RobotService::conflicts;
  using RobotService::open_port;
  using RobotService::status;
  using RobotService::task;
  Result<type::Value> status(const Wait& /*wait*/) override { return type::Value::map({{"robot", "fake"}}); }
  Result<type::Value> task(std::string_view id, const Wait& /*wait*/) override {
    if (id == "throws") throw std::runtime_error("a defect");
    if (id != "huge" && id != "large") return type::Value::map({{"id", id}});
    return type::Value(std::string(std::size_t{id == "huge" ? 200U : 20U} << 20, 'x'));
  }
  void watch(const task_host::LevelQuestion& question, const Wait& wait,
             control::RobotLevelAnswer answered) override {
    watches_.add(wait, [this, question, answered](task_host::detail::Watches::End end) {
      using End = task_host::detail::Watches::End;
      if (end == End::Stop) {
        dropped.open();
        answered(no_longer_wanted());
      } else if (end == End::No && question.seen) {
        entered.open();
        return false;
      } else {
        answered(control::RobotLevel{{TaskState::Running, question.task.str(), 7}, 3});
      }
      return true;
    });
  }
  Result<type::Value> running(std::uint64_t lease, const Wait& /*wait*/) override {
    return type::Value::map({{"controller", "fake"}, {"lease", lease}});
  }
  void changes(std::uint64_t seen, const Wait& wait, ChangesAnswer answered) override {
    watches_.add(wait, [seen, answered](task_host::detail::Watches::End end) {
      constexpr std::uint64_t kCount = 3;
      if (end == task_host::detail::Watches::End::No && seen == kCount) return false;
      answered(kCount);
      return true;
    });
  }
  Result<type::Value> switch_to(std::string_view controller, const control::RequestOptions& options,
                                const Wait& wait) override {
    return requested(controller, false, options, wait);
  }
  Result<type::Value> diff(std::string_view controller, const control::RequestOptions& options,
                           const Wait& wait) override {
    return requested(controller, true, options, wait);
  }
  Result<type::Value> switch_to_network(std::string_view text, std::string_view file,
                                        const control::RequestOptions& options, TimePoint) override {
    return sent(text, file, false, options);
  }
  Result<type::Value> diff_to_network(std::string_view text, std::string_view file,
                                      const control::RequestOptions& options, TimePoint) override {
    return sent(text, file, true, options);
  }
  Result<type::Value> plan(std::string_view controller, const control::RequestOptions& options,
                           TimePoint) override {
    return type::Value::map(
        {{"to", controller}, {"force", options.force}, {"order", to_string(options.order)}});
  }
  Result<type::Value> apply(const control::RequestOptions& options, TimePoint) override {
    return type::Value::map({{"force", options.force},
                             {"order", to_string(options.order)},
                             {"who", options.who},
                             {"lease", options.lease},
                             {"take_over", options.take_over}});
  }
  Result<type::Value> repair(const control::RequestOptions& options, const Wait& /*wait*/) override {
    return type::Value::map({{"repaired", options.force && options.order == model::Order::Paper},
                             {"who", options.who},
                             {"lease", options.lease},
                             {"take_over", options.take_over}});
  }
  Result<type::Value> prepare(const std::vector<std::string>& controllers, std::uint64_t /*lease*/,
                              const Wait& /*wait*/) override {
    type::Value::List list;
    for (const auto& name : controllers)
      list.emplace_back(name);
    return type::Value(std::move(list));
  }
  Result<type::Value> conflicts(const std::vector<std::string>& controllers, const Wait& /*wait*/) override {
    return prepare(controllers, 0, {});
  }
  Result<std::unique_ptr<RobotLease>> lease(std::string_view holder) override {
    if (leases > 0) return fail(ErrorCode::InvalidState, std::string(holder) + " is late");
    return std::make_unique<Lease>(*this);
  }
  Result<void> report(std::uint64_t lease, const type::Value& doing) override {
    return set_property("lease " + std::to_string(lease), "doing", doing, {}, {});
  }
  Result<type::Value> mission(std::uint64_t after, bool with_plan) override {
    return type::Value::map({{"after", after}, {"with_plan", with_plan}});
  }
  Result<std::uint64_t> send_command(std::string_view what, const type::Value& arguments) override {
    const Lock lock(mutex_);
    asked_.push_back({++asked_so_far_, std::string(what), arguments});
    return asked_so_far_;
  }
  Result<type::Value> give_back(std::uint64_t lease, bool keep, TimePoint deadline) override {
    return type::Value::map({{"lease", lease},
                             {"keep", keep},
                             {"left_s", std::chrono::duration<double>(deadline - now()).count()}});
  }
  Result<type::Value> stop(std::string_view who, TimePoint deadline) override {
    return type::Value::map(
        {{"who", who}, {"left_s", std::chrono::duration<double>(deadline - now()).count()}});
  }
  Result<void> release_stop(std::string_view who) override {
    return set_property("stop", "released", who, {}, {});
  }
  Result<type::Value> cancel(std::uint64_t request, std::string_view who, TimePoint deadline) override {
    return type::Value::map({{"request", request},
                             {"who", who},
                             {"left_s", std::chrono::duration<double>(deadline - now()).count()}});
  }
  Result<type::Value> apply_transition(const control::GivenTransition& transition,
                                       const control::RequestOptions& options, TimePoint) override {
    return type::Value::map({{"name", transition.name},
                             {"text", transition.text},
                             {"file", transition.file},
                             {"who", options.who}});
  }
  Result<void> reset_belief(std::string_view network, std::string_view file) override {
    {
      const Lock lock(mutex_);
      set_ = type::Value::map({{"network", network}, {"file", file}});
    }
    Error inner = fail(ErrorCode::IoError, "the innermost", "disk", {"inner.yaml", 3, 4});
    Error middle = Error(fail(ErrorCode::HookFailed, "the middle")).because_of(std::move(inner));
    return Error(fail(ErrorCode::InvalidState, "the outermost", "task_a", {"outer.yaml", 1, 2}))
        .because_of(std::move(middle));
  }
  Result<type::Value> units() override {
    return type::Value::list({type::Value::map({{"name", "screws"}, {"count", 40}})});
  }
  Result<std::uint32_t> set_units(std::string_view name, std::uint32_t count, std::string_view who) override {
    if (auto set = set_property(who, name, std::int64_t{count}, {}, {}); !set) return set.error();
    return 40;
  }
  Result<void> set_property(std::string_view task, std::string_view property, const type::Value& value,
                            const Sender& sender, const Wait& /*wait*/) override {
    const Lock lock(mutex_);
    set_ = type::Value::map({{"task", task}, {"property", property}, {"value", value}});
    sender_ = sender;
    set_text_ = value.source_text();
    return {};
  }
  Result<void> write(std::string_view task, std::string_view port, const type::Value& value,
                     const Sender& sender, const Wait& wait) override {
    return set_property(task, "port " + std::string(port), value, sender, wait);
  }
  Result<type::Value> call(std::string_view, std::string_view operation, const type::Value& arguments,
                           const Sender&, const Wait& wait) override {
    if (operation == "echo") return arguments;
    const std::stop_callback given_up(wait.stop, [this] { dropped.open(); });
    entered.open();
    if (!release.wait_until(wait.deadline)) return fail(ErrorCode::DeadlineExceeded, "nobody let me go");
    return type::Value("released");
  }
  void take_instance(const model::InstanceQuestion& what, const Wait& /*wait*/,
                     model::InstanceAnswer answered) override {
    answered(model::TakenInstance{what.pool + "_1 rather than " + what.lost.task, what.lost.pid + 1});
  }
  Result<std::unique_ptr<SampleStream>> open_port(std::string_view, std::string_view port, std::size_t,
                                                  const Wait& /*wait*/) override {
    if (port != "out") return fail(ErrorCode::NotFound, "no port");
    return std::make_unique<Numbers>(open_streams);
  }
  Result<type::Value> events(std::uint64_t after, const Wait& wait) override {
    if (after < 10) return type::Value::list({type::Value::map({{"number", after + 1}})});
    entered.open();
    const std::stop_callback given_up(wait.stop, [this] { dropped.open(); });
    release.wait_until(wait.deadline);
    return type::Value(type::Value::List{});
  }
  Result<type::Value> history() override { return type::Value(type::Value::List{}); }
  Result<type::Value> past(const type::Value& question) override { return question; }
  Result<void> shut_down() override {
    asked_to_end = true;
    return {};
  }

  type::Value last_set() {
    const Lock lock(mutex_);
    return set_;
  }
  Sender last_sender() {
    const Lock lock(mutex_);
    return sender_;
  }
  std::string last_set_text() {
    const Lock lock(mutex_);
    return set_text_;
  }

 private:
  static TimePoint now() { return RealClock::instance().now(); }

  static Result<type::Value> requested(std::string_view controller, bool dry_run,
                                       const control::RequestOptions& options, const Wait& wait) {
    return type::Value::map({{"to", controller},
                             {"dry_run", dry_run},
                             {"force", options.force},
                             {"order", to_string(options.order)},
                             {"who", options.who},
                             {"lease", options.lease},
                             {"take_over", options.take_over},
                             {"properties", properties_of(options)},
                             {"action_s", std::chrono::duration<double>(options.action_deadline).count()},
                             {"left_s", std::chrono::duration<double>(wait.deadline - now()).count()}});
  }
  static Result<type::Value> sent(std::string_view text, std::string_view file, bool dry_run,
                                  const control::RequestOptions& options) {
    return type::Value::map({{"text", text},
                             {"file", file},
                             {"dry_run", dry_run},
                             {"force", options.force},
                             {"order", to_string(options.order)},
                             {"who", options.who},
                             {"lease", options.lease},
                             {"take_over", options.take_over},
                             {"properties", properties_of(options)}});
  }
  static type::Value properties_of(const control::RequestOptions& options) {
    type::Value::List list;
    for (const auto& one : options.properties)
      list.push_back(type::Value::list({one.task.str(), one.property, one.value}));
    return list;
  }

  class Numbers final : public SampleStream {
   public:
    explicit Numbers(std::atomic<int>& open) : open_(open) { ++open_; }
    ~Numbers() override { --open_; }
    Result<std::vector<type::Value>> read(std::size_t limit, const Wait& /*wait*/) override {
      std::vector<type::Value> samples;
      while (samples.size() < limit)
        samples.emplace_back(++last_);
      return samples;
    }
    void next(std::size_t limit, const Wait& wait, task_host::SamplesAnswer answered) override {
      answered(read(limit, wait));
    }
    [[nodiscard]] std::string type_name() const override { return "/int32_t"; }

   private:
    std::atomic<int>& open_;
    int last_ = 0;
  };

  class Lease final : public RobotLease {
   public:
    explicit Lease(FakeRobotService& robot) : robot_(robot) { ++robot_.leases; }
    ~Lease() override { --robot_.leases; }
    [[nodiscard]] std::uint64_t number() const override { return 7; }
    Result<LeaseStanding> standing(const Wait& /*wait*/) override {
      if (robot_.lease_blocks) {
        robot_.entered.open();
        robot_.release.wait();
      }
      return LeaseStanding{robot_.is_taken_over ? std::optional<std::string>("somebody") : std::nullopt,
                           robot_.is_stopped};
    }

    Result<std::vector<HolderRequest>> asked() override {
      const Lock lock(robot_.mutex_);
      return std::exchange(robot_.asked_, {});
    }

   private:
    FakeRobotService& robot_;
  };

  Mutex mutex_;
  std::uint64_t asked_so_far_ = 0;
  std::vector<HolderRequest> asked_;
  type::Value set_;
  Sender sender_;
  std::string set_text_;
  task_host::detail::Watches watches_;
};

/// A server in a runtime folder of its own.
class ControlTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-control-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    ::setenv("XDG_RUNTIME_DIR", pattern.c_str(), 1);
    socket_ = socket_path("fake").value();
  }
  void TearDown() override {
    robot_.release.open();
    server_.reset();
    std::filesystem::remove_all(folder_);
  }

  void serve() {
    auto server = Server::listen(socket_, &robot_);
    ASSERT_TRUE(server) << to_string(server.error());
    server_ = std::move(*server);
  }
  std::unique_ptr<RobotService> client() {
    auto connected = connect(socket_, kLong);
    EXPECT_TRUE(connected) << to_string(connected.error());
    return connected ? std::move(*connected) : nullptr;
  }

  std::filesystem::path folder_;
  std::filesystem::path socket_;
  FakeRobotService robot_;
  std::unique_ptr<Server> server_;
};

}  // namespace segue::control
