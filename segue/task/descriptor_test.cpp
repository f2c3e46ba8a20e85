// SPDX-License-Identifier: Apache-2.0
//
// Tasks that are driven by file descriptors.
#include <segue/task/probe_component.hpp>

#include <gmock/gmock.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <semaphore>

namespace segue::task {
namespace {

using namespace std::chrono_literals;
using test::soon;
using ::testing::HasSubstr;

class Descriptor : public ::testing::Test {
 protected:
  ~Descriptor() override { close(event); }
  int event = eventfd(0, EFD_NONBLOCK);
};

TEST_F(Descriptor, ReadableDescriptorUpdatesOnAThread) {
  auto component = std::make_unique<test::Probe>();
  test::Probe* probe = component.get();
  std::counting_semaphore<> updated(0);
  probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook == "start") return probe->trigger_fd(event);
    if (hook != "update") return {};
    eventfd_t value = 0;
    eventfd_read(event, &value);
    updated.release();
    return {};
  };
  const Activity activity = fd_driven();
  auto task = Task::create("fd", std::move(component), &activity);
  ASSERT_TRUE(task);
  ASSERT_TRUE((*task)->configure(soon()));
  for (int round = 0; round < 3; ++round) {
    ASSERT_TRUE((*task)->start(soon()));
    for (int i = 0; i < 5; ++i) {
      eventfd_write(event, 1);
      ASSERT_TRUE(updated.try_acquire_for(60s));
    }
    ASSERT_TRUE((*task)->stop(soon()));
  }
  EXPECT_EQ((*task)->timing().cycles, 5U);
}

/// A component that gives a descriptor for each of two devices.
class TwoDevices : public test::TaskTest {
 protected:
  ~TwoDevices() override {
    close(event);
    close(other);
  }

  std::unique_ptr<Task> make(std::set<std::string> triggers, const std::string& name_of_event = "left") {
    auto component =
        std::make_unique<test::Probe>(ComponentOptions{.descriptors = {"left", "right", "spare"}});
    test::Probe* both = component.get();
    both->act = [this, both, name_of_event](const std::string& hook) -> Result<void> {
      if (hook == "start") {
        auto given = both->trigger_fd(event, name_of_event);
        return given ? both->trigger_fd(other, "right") : given;
      }
      if (hook != "update") return {};
      eventfd_t value = 0;
      if (eventfd_read(event, &value) == 0) ++left;
      if (eventfd_read(other, &value) == 0) ++right;
      return {};
    };
    Activity activity = fd_driven();
    activity.triggers = std::move(triggers);
    auto made = Task::create("devices", std::move(component), activity, executor);
    EXPECT_TRUE(made);
    EXPECT_TRUE((*made)->configure(soon()));
    return std::move(*made);
  }

  int event = eventfd(0, EFD_NONBLOCK);
  int other = eventfd(0, EFD_NONBLOCK);
  int left = 0;
  int right = 0;
};

TEST_F(TwoDevices, OfWhichTheNetworkChoosesOne) {
  const auto driven = make({"right"});
  ASSERT_TRUE(driven->start(soon()));
  eventfd_write(event, 1);
  executor->run_ready();
  EXPECT_EQ(left, 0);
  eventfd_write(other, 1);
  executor->run_ready();
  EXPECT_EQ(right, 1);
}

TEST_F(TwoDevices, BothDriveATaskWhoseNetworkChoosesNone) {
  const auto driven = make({});
  ASSERT_TRUE(driven->start(soon()));
  eventfd_write(event, 1);
  executor->run_ready();
  eventfd_write(other, 1);
  executor->run_ready();
  EXPECT_EQ(left, 1);
  EXPECT_EQ(right, 1);
}

TEST_F(TwoDevices, MustBeKnownAndGiven) {
  const auto missing = make({"spare"})->start(soon());
  ASSERT_FALSE(missing);
  EXPECT_THAT(missing.error().message, HasSubstr("on_start gave no file descriptor 'spare'"));
  const auto unknown = make({}, "lefd")->start(soon());
  ASSERT_FALSE(unknown);
  EXPECT_THAT(to_string(unknown.error()),
              HasSubstr("do not name the descriptor 'lefd', did you mean 'left'?"));
}

class PortAndDescriptor : public test::TaskTest {
 protected:
  ~PortAndDescriptor() override { close(event); }
  int event = eventfd(0, EFD_NONBLOCK);
};

TEST_F(PortAndDescriptor, DriveAPortDrivenTask) {
  Activity activity;
  activity.triggers = {"input"};
  make(activity);
  ASSERT_TRUE(task->configure(soon()));
  int updates = 0;
  probe->act = [&](const std::string& hook) -> Result<void> {
    if (hook == "start") return probe->trigger_fd(event);
    eventfd_t value = 0;
    if (hook == "update" && eventfd_read(event, &value) == 0) ++updates;
    return {};
  };
  ASSERT_TRUE(task->start(soon()));
  executor->run_ready();
  EXPECT_EQ(updates, 0);
  eventfd_write(event, 1);
  executor->run_ready();
  EXPECT_EQ(updates, 1);
}

TEST_F(PortAndDescriptor, OfWhichTheLatterDoesNotDriveAPeriodicTask) {
  make(periodic(10ms));
  ASSERT_TRUE(task->configure(soon()));
  probe->act = [&](const std::string& hook) -> Result<void> {
    return hook == "start" ? probe->trigger_fd(event) : Result<void>{};
  };
  const Result<void> started = task->start(soon());
  ASSERT_FALSE(started);
  EXPECT_THAT(to_string(started.error()), HasSubstr("driven by file descriptors or by ports"));
}

TEST_F(Descriptor, DescriptorThatCannotBeWatchedRefusesTheStart) {
  auto component = std::make_unique<test::Probe>();
  test::Probe* probe = component.get();
  probe->act = [&](const std::string& hook) -> Result<void> {
    return hook == "start" ? probe->trigger_fd(-1) : Result<void>{};
  };
  const Activity activity = fd_driven();
  auto task = Task::create("fd", std::move(component), &activity);
  ASSERT_TRUE(task);
  ASSERT_TRUE((*task)->configure(soon()));
  const Result<void> started = (*task)->start(soon());
  ASSERT_FALSE(started);
  EXPECT_THAT(started.error().message, HasSubstr("file descriptor -1"));
  EXPECT_EQ((*task)->state(), TaskState::Stopped);
}

}  // namespace
}  // namespace segue::task
