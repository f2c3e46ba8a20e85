// SPDX-License-Identifier: Apache-2.0
// Tasks that are driven by descriptors, and by samples, too.
#include <segue/base/descriptor.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/sample_link/local.hpp>
#include <segue/task/component.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/task.hpp>

#include <gtest/gtest.h>
#include <sys/eventfd.h>

#include <memory>
#include <utility>

namespace segue::sample_link {
namespace {

/// Takes a sample in each update.
class Driver final : public task::Component {
 public:
  explicit Driver(bool by_samples) : Component({.activity = fd_driven(), .samples_trigger = by_samples}) {}

  task::InputPort<int> command{*this, "command"};
  const Descriptor event{::eventfd(0, EFD_NONBLOCK)};
  int updates = 0;
  int last = 0;

 protected:
  Result<void> on_start() override { return trigger_fd(event.get()); }
  void on_update() override {
    ++updates;
    eventfd_t count = 0;
    ::eventfd_read(event.get(), &count);
    if (const auto sample = command.take()) last = *sample;
  }
};

class Commander final : public task::Component {
 public:
  task::OutputPort<int> out{*this, "out"};
};

class SampleTrigger : public ::testing::TestWithParam<bool> {
 protected:
  SampleTrigger() {
    auto made = std::make_unique<Driver>(GetParam());
    driver = made.get();
    task = std::move(task::Task::create("driver", std::move(made), fd_driven(), executor).value());
    EXPECT_TRUE(connect(commander.out, driver->command, {BufferKind::Buffer, 10}));
    EXPECT_TRUE(task->configure(in_time()));
    EXPECT_TRUE(task->start(in_time()));
  }
  ~SampleTrigger() override { task.reset(); }
  static TimePoint in_time() { return RealClock::instance().now() + std::chrono::seconds(60); }

  VirtualClock clock;
  std::shared_ptr<task::ManualExecutor> executor = std::make_shared<task::ManualExecutor>(clock);
  Commander commander;
  Driver* driver = nullptr;
  std::unique_ptr<task::Task> task;
};

TEST_P(SampleTrigger, UpdatesATaskOfDescriptorsWhereItsComponentSaysSo) {
  for (int i = 1; i <= 3; ++i)
    commander.out.write(i);
  executor->run_ready();
  EXPECT_EQ(driver->last, GetParam() ? 3 : 0) << "it gets a turn for each sample";
  ::eventfd_write(driver->event.get(), 1);
  executor->run_ready();
  EXPECT_EQ(driver->updates, GetParam() ? 4 : 1);
  ASSERT_TRUE(task->stop(in_time()));
  commander.out.write(4);
  executor->run_ready();
  EXPECT_EQ(driver->updates, GetParam() ? 4 : 1);
  ASSERT_TRUE(task->start(in_time()));
  executor->run_ready();
  EXPECT_EQ(driver->last, GetParam() ? 4 : 1) << "it has waited";
}

INSTANTIATE_TEST_SUITE_P(, SampleTrigger, ::testing::Bool());

}  // namespace
}  // namespace segue::sample_link
