// SPDX-License-Identifier: Apache-2.0
#include <segue/base/question.hpp>
#include <segue/runtime/change_count.hpp>

#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <optional>
#include <stop_token>
#include <thread>

namespace segue::runtime::detail {
namespace {

class ChangeCountTest : public ::testing::Test {
 protected:
  static TimePoint soon() { return RealClock::instance().now() + std::chrono::seconds(60); }
  std::future<Result<std::uint64_t>> watch(std::uint64_t seen, const Wait& wait) {
    const auto answer = std::make_shared<std::promise<Result<std::uint64_t>>>();
    count_.watch(seen, wait, [answer](Result<std::uint64_t> now) { answer->set_value(std::move(now)); });
    return answer->get_future();
  }
  static bool waits(const std::future<Result<std::uint64_t>>& answer) {
    return answer.wait_for(std::chrono::milliseconds(0)) == std::future_status::timeout;
  }

  ChangeCount count_;
};

TEST_F(ChangeCountTest, AnswersAtOnceWhoHasNotSeenTheLastChange) {
  const auto first = *watch(0, soon()).get();
  EXPECT_GT(first, 0U);
  auto next = watch(first, soon());
  EXPECT_TRUE(waits(next));
  count_.add();
  EXPECT_EQ(*next.get(), first + 1);
  EXPECT_EQ(*watch(first, soon()).get(), first + 1) << "it came while nobody waited";
}

TEST_F(ChangeCountTest, AnswersAtTheEndOfTheWait) {
  const auto seen = *watch(0, soon()).get();
  EXPECT_EQ(*watch(seen, RealClock::instance().now()).get(), seen);
  std::stop_source stop;
  auto stopped = watch(seen, {soon(), stop.get_token()});
  auto other = watch(seen, soon());
  stop.request_stop();
  EXPECT_EQ(stopped.get().error().code, ErrorCode::Cancelled);
  EXPECT_TRUE(waits(other));
  count_.close();
  EXPECT_EQ(other.get().error().code, ErrorCode::Unavailable);
  EXPECT_EQ(watch(seen, soon()).get().error().code, ErrorCode::Unavailable);
}

TEST_F(ChangeCountTest, MissesNoChangeAmongMany) {
  constexpr std::uint64_t kChanges = 2'000;
  const auto first = *watch(0, soon()).get();
  std::jthread changing([&] {
    for (std::uint64_t i = 0; i < kChanges; ++i)
      count_.add();
  });
  auto seen = first;
  while (seen < first + kChanges) {
    const auto next = watch(seen, soon()).get();
    ASSERT_TRUE(next);
    ASSERT_GT(*next, seen);
    seen = *next;
  }
}

}  // namespace
}  // namespace segue::runtime::detail
