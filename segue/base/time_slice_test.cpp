// SPDX-License-Identifier: Apache-2.0
#include <segue/base/time_slice.hpp>

#include <gtest/gtest.h>

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <thread>

namespace segue {
namespace {

/// Of the calling thread, in nanoseconds, as the kernel says it; 0 where it does not know any.
std::uint64_t time_slice() {
  std::array<std::uint64_t, 6> attributes{};  // struct sched_attr in its first version: 48 bytes
  if (::syscall(SYS_sched_getattr, 0, attributes.data(), sizeof attributes, 0) != 0) return 0;
  return attributes[3];
}

TEST(TimeSlices, ThatAreShortChangeNothingElseOfTheScheduler) {
  std::thread([] {
    const auto me = static_cast<id_t>(::gettid());
    ASSERT_EQ(::setpriority(PRIO_PROCESS, me, 3), 0);
    ask_for_short_time_slices();
    EXPECT_EQ(::getpriority(PRIO_PROCESS, me), 3);
    EXPECT_EQ(::sched_getscheduler(0), SCHED_OTHER);
  }).join();
}

TEST(TimeSlices, AreThoseOfThreadsThatAreStartedLater) {
  std::thread([] {
    ask_for_short_time_slices();
    const std::uint64_t mine = time_slice();
    if (mine == 0) GTEST_SKIP() << "this kernel does not let threads choose their time slices";
    EXPECT_EQ(mine, std::chrono::nanoseconds(kTimeSlice).count());
    std::thread([mine] { EXPECT_EQ(time_slice(), mine); }).join();
  }).join();
}

}  // namespace
}  // namespace segue
