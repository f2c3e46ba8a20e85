// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/process_limits.hpp>

#include <gmock/gmock.h>
#include <linux/capability.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <functional>
#include <thread>

namespace segue::process_server {
namespace {

using ::testing::HasSubstr;

/// Drops the capability by which this thread may choose a real-time scheduler.
void give_up_nice() {
  __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
  std::array<__user_cap_data_struct, 2> sets{};
  ASSERT_EQ(::syscall(SYS_capget, &header, sets.data()), 0);
  sets[CAP_TO_INDEX(CAP_SYS_NICE)].effective &= ~CAP_TO_MASK(CAP_SYS_NICE);
  ASSERT_EQ(::syscall(SYS_capset, &header, sets.data()), 0);
}

/// Keeps the resource limit from permitting any real-time priority, as long as it exists.
class NoPriorities {
 public:
  NoPriorities() {
    EXPECT_EQ(::getrlimit(RLIMIT_RTPRIO, &before_), 0);
    const rlimit none{0, before_.rlim_max};
    EXPECT_EQ(::setrlimit(RLIMIT_RTPRIO, &none), 0);
  }
  ~NoPriorities() { ::setrlimit(RLIMIT_RTPRIO, &before_); }
  NoPriorities(const NoPriorities&) = delete;
  NoPriorities& operator=(const NoPriorities&) = delete;

 private:
  rlimit before_{};
};

/// Runs in a thread of its own, with which its scheduler and capabilities end.
void in_a_thread_without_rights(const std::function<void()>& what) {
  const NoPriorities none;
  std::jthread([&] {
    give_up_nice();
    what();
  });
}

Launch with(Scheduler scheduler, int priority, bool optional) {
  Launch launch;
  launch.deployment.scheduler = scheduler;
  launch.deployment.priority = priority;
  launch.deployment.optional = optional;
  return launch;
}

TEST(ProcessLimits, TheProcessKnowsTheAddressesOfTheHosts) {
  Launch launch;
  launch.peers = {"10.0.0.1", "arm.local"};
  EXPECT_TRUE(apply_to_this_process(launch));
  EXPECT_STREQ(std::getenv("SEGUE_PEERS"), "10.0.0.1,arm.local");
  ::unsetenv("SEGUE_PEERS");
}

TEST(ProcessLimits, ASchedulerThatIsNotPermittedIsRefusedWithWhatToDo) {
  in_a_thread_without_rights([] {
    for (const Scheduler scheduler : {Scheduler::Fifo, Scheduler::RoundRobin}) {
      const auto applied = apply_to_this_process(with(scheduler, 5, false));
      ASSERT_FALSE(applied);
      EXPECT_EQ(applied.error().code, ErrorCode::PermissionDenied);
      EXPECT_THAT(applied.error().message, HasSubstr("with priority 5"));
      EXPECT_THAT(applied.error().message, HasSubstr("CAP_SYS_NICE"));
      EXPECT_THAT(applied.error().message, HasSubstr("optional: true"));
    }
    EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
  });
}

TEST(ProcessLimits, AnOptionalSchedulerThatIsNotPermittedLeavesTheNormalOne) {
  in_a_thread_without_rights([] {
    EXPECT_TRUE(apply_to_this_process(with(Scheduler::Fifo, 5, true)));
    EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
  });
}

TEST(ProcessLimits, APriorityThatDoesNotExistIsRefusedEvenIfItIsOptional) {
  in_a_thread_without_rights([] {
    EXPECT_FALSE(apply_to_this_process(with(Scheduler::Fifo, 1000, true)));
    EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
  });
}

TEST(ProcessLimitsWherePossible, ASchedulerThatIsPermittedIsChosen) {
  std::jthread([] {
    const sched_param parameters{3};
    if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0)
      GTEST_SKIP() << "a real-time scheduler is not permitted";
    EXPECT_TRUE(apply_to_this_process(with(Scheduler::RoundRobin, 4, false)));
    EXPECT_EQ(::sched_getscheduler(0), SCHED_RR);
    sched_param chosen{};
    ::sched_getparam(0, &chosen);
    EXPECT_EQ(chosen.sched_priority, 4);
  });
}

}  // namespace
}  // namespace segue::process_server
