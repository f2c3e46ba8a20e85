// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/remote_robot/served_robot.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <future>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace segue::remote_robot {

using type::Value;

inline TimePoint soon() {
  return RealClock::instance().now() + std::chrono::seconds(60);
}

/// How a lease answers.
struct LeaseAnswer {
  std::optional<Error> error;
  std::atomic<int> looks = 0;           ///< at who took it
  std::promise<void>* begun = nullptr;  ///< it was asked
  std::promise<void>* wait = nullptr;   ///< for that
};

class FakeLease final : public control::RobotLease {
 public:
  FakeLease(const control::LeaseStanding& standing, LeaseAnswer& answer)
      : standing_(standing), answer_(answer) {}
  [[nodiscard]] std::uint64_t number() const override { return 7; }
  Result<control::LeaseStanding> standing(const Wait& /*wait*/) override {
    if (!answer_.error) return standing_;
    ++answer_.looks;
    return *answer_.error;
  }
  Result<std::vector<control::HolderRequest>> asked() override {
    if (answer_.begun) answer_.begun->set_value();
    if (answer_.wait) answer_.wait->get_future().wait();
    if (answer_.error) return *answer_.error;
    return std::vector<control::HolderRequest>{{1, "pause", {}}};
  }

 private:
  const control::LeaseStanding& standing_;
  LeaseAnswer& answer_;
};

inline Error until_stopped(const Wait& wait) {
  std::promise<void> stopped;
  const std::stop_callback wake(wait.stop, [&] { stopped.set_value(); });
  EXPECT_EQ(stopped.get_future().wait_until(wait.deadline), std::future_status::ready);
  return no_longer_wanted();
}

/// Answers what it is told to.
class FakeService final : public control::RobotService {
 public:
  Value status_answer = Value::map({{"controller", "explore"}, {"unresolved", Value::List{}}});
  Value switch_answer = Value::map({{"outcome", "done"}});
  Result<control::RobotLevel> level_answer;
  task_host::LevelQuestion watched;
  Value conflicts_answer = Value::list({});
  Value kept_units = Value::list({});
  control::LeaseStanding standing;
  std::string requested;
  control::RequestOptions options;
  std::string lease_holder;
  std::vector<std::string> prepared;
  Value written;
  std::uint64_t sent_with = 0;
  Value reported;
  Value given_back;
  Result<void> report_answer;
  LeaseAnswer lease_answer;
  bool switch_waits = false;                   ///< until it is wanted no longer
  std::promise<void> switches;                 ///< it waits
  std::promise<void>* status_waits = nullptr;  ///< for the same, and says so
  std::optional<Error> running_error;
  std::stop_token changes_wait;
  control::ChangesAnswer changes_answered;

  Result<Value> status(const Wait& /*wait*/) override { return status_answer; }
  Result<Value> task(std::string_view /*id*/, const Wait& /*wait*/) override { return no(); }
  void watch(const task_host::LevelQuestion& question, const Wait& /*wait*/,
             control::RobotLevelAnswer answered) override {
    watched = question;
    answered(level_answer);
  }
  Result<Value> running(std::uint64_t lease, const Wait& wait) override {
    if (status_waits) {
      status_waits->set_value();
      return until_stopped(wait);
    }
    if (running_error) return *running_error;
    Value answer = status_answer;
    if (lease == 0) return answer;
    answer.as_map().set("lost_to", standing.lost_to ? Value(*standing.lost_to) : Value());
    answer.as_map().set("stopped", standing.is_stopped);
    return answer;
  }
  void changes(std::uint64_t seen, const Wait& wait, control::ChangesAnswer answered) override {
    if (seen != 7) return answered(7);
    changes_wait = wait.stop;
    changes_answered = std::move(answered);
  }
  void take_instance(const model::InstanceQuestion& what, const Wait& /*wait*/,
                     model::InstanceAnswer answered) override {
    answered(model::TakenInstance{what.pool + "_1 rather than " + what.lost.task, what.lost.pid + 1});
  }
  Result<Value> switch_to(std::string_view controller, const control::RequestOptions& asked,
                          const Wait& wait) override {
    requested = controller;
    options = asked;
    if (!switch_waits) return switch_answer;
    switches.set_value();
    return until_stopped(wait);
  }
  Result<Value> diff(std::string_view /*controller*/, const control::RequestOptions& /*options*/,
                     const Wait& /*wait*/) override {
    return no();
  }
  Result<Value> diff_to_network(std::string_view /*text*/, std::string_view /*file*/,
                                const control::RequestOptions& /*options*/, TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> switch_to_network(std::string_view /*text*/, std::string_view /*file*/,
                                  const control::RequestOptions& /*options*/,
                                  TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> plan(std::string_view /*controller*/, const control::RequestOptions& /*options*/,
                     TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> apply(const control::RequestOptions& /*options*/, TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> prepare(const std::vector<std::string>& controllers, std::uint64_t lease,
                        const Wait& /*wait*/) override {
    prepared = controllers;
    sent_with = lease;
    return Value();
  }
  Result<Value> conflicts(const std::vector<std::string>& /*controllers*/, const Wait& /*wait*/) override {
    return conflicts_answer;
  }
  Result<std::unique_ptr<control::RobotLease>> lease(std::string_view holder) override {
    lease_holder = holder;
    return std::make_unique<FakeLease>(standing, lease_answer);
  }
  Result<void> report(std::uint64_t lease, const Value& doing) override {
    reported = Value::list({lease, doing});
    return report_answer;
  }
  Result<Value> mission(std::uint64_t /*after*/, bool /*with_plan*/) override { return no(); }
  Result<std::uint64_t> send_command(std::string_view /*what*/, const Value& /*arguments*/) override {
    return no();
  }
  Result<Value> give_back(std::uint64_t lease, bool keep, TimePoint /*deadline*/) override {
    return given_back = Value::list({lease, keep});
  }
  Result<Value> stop(std::string_view /*who*/, TimePoint /*deadline*/) override { return no(); }
  Result<void> release_stop(std::string_view /*who*/) override { return no(); }
  Result<Value> repair(const control::RequestOptions& /*options*/, const Wait& /*wait*/) override {
    return no();
  }
  Result<Value> cancel(std::uint64_t /*request*/, std::string_view /*who*/, TimePoint /*deadline*/) override {
    return no();
  }
  Result<Value> apply_transition(const control::GivenTransition& /*transition*/,
                                 const control::RequestOptions& /*options*/,
                                 TimePoint /*deadline*/) override {
    return no();
  }
  Result<void> reset_belief(std::string_view, std::string_view) override { return no(); }
  Result<Value> units() override { return kept_units; }
  Result<std::uint32_t> set_units(std::string_view, std::uint32_t, std::string_view) override { return no(); }
  Result<void> set_property(std::string_view /*task*/, std::string_view /*property*/, const Value& /*value*/,
                            const control::Sender& /*sender*/, const Wait& /*wait*/) override {
    return no();
  }
  Result<void> write(std::string_view task, std::string_view port, const Value& value,
                     const control::Sender& sender, const Wait& /*wait*/) override {
    written = Value::list({task, port, value});
    sent_with = sender.lease;
    return {};
  }
  Result<Value> call(std::string_view /*task*/, std::string_view /*operation*/, const Value& /*arguments*/,
                     const control::Sender& /*sender*/, const Wait& /*wait*/) override {
    return no();
  }
  Result<std::unique_ptr<control::SampleStream>> open_port(std::string_view /*task*/,
                                                           std::string_view /*port*/, std::size_t /*buffer*/,
                                                           const Wait& /*wait*/) override {
    return no();
  }
  Result<Value> events(std::uint64_t /*after*/, const Wait& /*wait*/) override { return no(); }
  Result<Value> history() override { return no(); }
  Result<Value> past(const Value& /*question*/) override { return no(); }
  Result<void> shut_down() override { return no(); }

 private:
  static Error no() { return fail(ErrorCode::Unsupported, "not in this test"); }
};

class ServedRobotTest : public ::testing::Test {
 protected:
  FakeService service_;
  ServedRobot robot_{service_, "a test"};
};

}  // namespace segue::remote_robot
