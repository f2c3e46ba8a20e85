// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/type/json.hpp>
#include <segue/web/hub.hpp>
#include <support/eventually.hpp>
#include <support/fake_robot_service.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// For tests of this folder only.
namespace segue::web {

using segue::testing::eventually;

/// A robot whose status tests set, and which counts how often it is asked.
class ShownRobot final : public control::FakeRobotService {
 public:
  std::atomic<int> questions{0};
  std::atomic<int> task_questions{0};  ///< among them
  std::atomic<int> opened{0};          ///< ports
  std::atomic<bool> is_silent{false};  ///< the ports that are opened from now on
  std::atomic<bool> is_gone{false};    ///< the task whose ports are opened

  void show(type::Value status) {
    const Lock lock(mutex_);
    status_ = std::move(status);
  }
  Result<type::Value> status(const Wait& /*wait*/) override {
    ++questions;
    const Lock lock(mutex_);
    return status_;
  }
  /// Answers with the question; where that is for the clock, it is the year 2027.
  Result<type::Value> past(const type::Value& question) override {
    const type::Value* ask = question.find("ask");
    if (ask != nullptr && *ask == type::Value("clock")) return type::Value::map({{"now_s", 1.8e9}});
    return question;
  }
  Result<type::Value> task(std::string_view id, const Wait& /*wait*/) override {
    ++questions;
    ++task_questions;
    if (id == "gone") return fail(ErrorCode::NotFound, "no task 'gone' runs");
    return type::Value::map({{"id", id}});
  }
  /// The mission of the last show_mission(); null at first.
  Result<type::Value> mission(std::uint64_t after, bool with_plan) override {
    ++questions;
    const Lock lock(mutex_);
    type::Value::List entries;
    for (std::uint64_t i = after + 1; i <= mission_entries_ && entries.size() < 2000; ++i)
      entries.push_back(type::Value::map({{"number", i}, {"kind", "began"}}));
    if (mission_state_.empty()) return type::Value();
    auto shown =
        type::Value::map({{"run", mission_run_}, {"state", mission_state_}, {"entries", std::move(entries)}});
    if (with_plan) shown.as_map().set("plan", mission_plan_);
    return shown;
  }
  void show_mission(std::uint64_t run, const std::string& state, std::uint64_t entries, type::Value plan) {
    const Lock lock(mutex_);
    mission_run_ = run;
    mission_state_ = state;
    mission_entries_ = entries;
    mission_plan_ = std::move(plan);
  }
  Result<type::Value> events(std::uint64_t after, const Wait& wait) override {
    ++questions;
    const TimePoint soon = monotonic_now() + std::chrono::milliseconds(20);
    return control::FakeRobotService::events(after, Wait(std::min(wait.deadline, soon), wait.stop));
  }
  Result<std::unique_ptr<control::SampleStream>> open_port(std::string_view task, std::string_view port,
                                                           std::size_t buffer, const Wait& wait) override {
    ++opened;
    if (is_gone) return fail(ErrorCode::NotFound, "no such task runs");
    if (is_silent) return std::make_unique<Silent>();
    return control::FakeRobotService::open_port(task, port, buffer, wait);
  }

 private:
  class Silent final : public control::SampleStream {
   public:
    Result<std::vector<type::Value>> read(std::size_t /*limit*/, const Wait& /*wait*/) override {
      return std::vector<type::Value>();
    }
    void next(std::size_t /*limit*/, const Wait& /*wait*/, task_host::SamplesAnswer answered) override {
      answered(std::vector<type::Value>());
    }
    [[nodiscard]] std::string type_name() const override { return "/int32_t"; }
  };

  Mutex mutex_;
  std::uint64_t mission_run_ = 0;
  std::string mission_state_;
  std::uint64_t mission_entries_ = 0;
  type::Value mission_plan_;
  type::Value status_ = type::Value::map({{"robot", "fake"}});
};

/// A robot behind a real socket.
class WebTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-web-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    serve();
  }
  void TearDown() override {
    robot_.release.open();
    serving_.reset();
    std::filesystem::remove_all(folder_);
  }
  void serve() {
    auto server = control::Server::listen(folder_ / "robot", &robot_);
    ASSERT_TRUE(server) << to_string(server.error());
    serving_ = std::move(*server);
  }
  [[nodiscard]] Connect connection() const {
    return [socket = folder_ / "robot"] { return control::connect(socket, control::kLong); };
  }

  std::filesystem::path folder_;
  ShownRobot robot_;
  std::unique_ptr<control::Server> serving_;
};

}  // namespace segue::web
