// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/json.hpp>
#include <segue/web/hub.hpp>
#include <support/fake_robot.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

/// For tests of this folder only.
namespace segue::web {

/// A robot whose status tests set, and which counts how often it is asked.
class ShownRobot final : public control::FakeRobot {
 public:
  std::atomic<int> questions{0};

  void show(type::Value status) {
    const std::lock_guard lock(mutex_);
    status_ = std::move(status);
  }
  Result<type::Value> status() override {
    ++questions;
    const std::lock_guard lock(mutex_);
    return status_;
  }
  Result<type::Value> task(std::string_view id) override {
    ++questions;
    if (id == "gone") return fail(ErrorCode::NotFound, "no task 'gone' runs");
    return type::Value::map({{"id", id}});
  }
  Result<type::Value> events(std::uint64_t after, Duration wait) override {
    ++questions;
    return control::FakeRobot::events(after, std::min(wait, Duration(std::chrono::milliseconds(20))));
  }

 private:
  std::mutex mutex_;
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

/// Whether `holds` becomes true in time.
inline bool comes_true(const std::function<bool()>& holds) {
  const TimePoint end = control::soon();
  while (!holds()) {
    if (monotonic_now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return true;
}

}  // namespace segue::web
