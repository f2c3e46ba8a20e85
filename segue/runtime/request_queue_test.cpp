// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/request_queue.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <future>
#include <optional>
#include <string>
#include <thread>
#include <utility>

namespace segue::runtime::detail {
namespace {

constexpr auto kNow = Duration::zero();
const auto kAccept = [] { return true; };

PendingRequest request(const char* name, std::uint64_t lease = 0) {
  PendingRequest job{0, model::NetworkName(name), {}, {}};
  job.options.lease = lease;
  job.options.who = "ann";
  return job;
}

class RequestQueueTest : public ::testing::Test {
 protected:
  std::uint64_t put(const char* name, std::uint64_t lease = 0) {
    auto job = request(name, lease);
    return queue_.put(job, kAccept).number;
  }
  std::optional<RequestQueue::Turn> next() { return queue_.next(RealClock::instance().now() + kNow); }

  EventLog log_;
  RequestQueue queue_{log_};
};

RuntimeState after_failure(Outcome outcome, std::optional<Undo> undo = {}) {
  SwitchResult result;
  result.outcome = outcome;
  result.undo = std::move(undo);
  return state_after(result, RuntimeState::Failed);
}

TEST(StateAfter, ARefusalIsTheOneBefore) {
  EXPECT_EQ(after_failure(Outcome::Refused), RuntimeState::Failed);
  EXPECT_EQ(after_failure(Outcome::Done), RuntimeState::Idle);
  EXPECT_EQ(after_failure(Outcome::Superseded), RuntimeState::Idle);
}

TEST(StateAfter, AFailureDependsOnWhatRuns) {
  Undo restored;
  restored.restored = true;
  Undo fell_back;
  fell_back.fell_back = true;
  for (const Outcome outcome : {Outcome::Failed, Outcome::Cancelled}) {
    EXPECT_EQ(after_failure(outcome), RuntimeState::Failed);
    EXPECT_EQ(after_failure(outcome, Undo()), RuntimeState::Failed);
    EXPECT_EQ(after_failure(outcome, restored), RuntimeState::Idle);
    EXPECT_EQ(after_failure(outcome, fell_back), RuntimeState::Idle);
  }
}

TEST_F(RequestQueueTest, ANewerRequestTakesThePlaceOfAnOlderOne) {
  EXPECT_EQ(put("a"), 1U);
  auto newer = request("b");
  const auto place = queue_.put(newer, kAccept);
  EXPECT_EQ(place.number, 2U);
  ASSERT_TRUE(place.older);
  EXPECT_EQ(place.older->number, 1U);
  const auto turn = next();
  ASSERT_TRUE(turn && turn->job.request);
  EXPECT_EQ(turn->job.request->number, 2U);
  EXPECT_EQ(queue_.state(), RuntimeState::Executing);
}

TEST_F(RequestQueueTest, OneThatIsNotAdmittedHasANumberAndChangesNothing) {
  put("a");
  auto refused = request("b");
  EXPECT_EQ(queue_.put(refused, [] { return false; }).number, 2U);
  EXPECT_EQ(name_of(refused.request), model::NetworkName("b")) << "it is not moved from";
  EXPECT_EQ(next()->job.request->number, 1U);
}

TEST_F(RequestQueueTest, RequestsComeBeforeFilesAndFilesBeforeSupervision) {
  PendingApply files;
  EXPECT_FALSE(queue_.put(files, [](PendingApply* older) { return older == nullptr; }));
  put("a");
  queue_.wake();
  EXPECT_TRUE(next()->job.request);
  EXPECT_TRUE(next()->job.files);
  const auto turn = next();
  ASSERT_TRUE(turn);
  EXPECT_FALSE(turn->job.request || turn->job.files);
}

TEST_F(RequestQueueTest, WhatGoesBeforeAllDropsWhatWaits) {
  put("a");
  PendingApply files;
  queue_.put(files, [](PendingApply*) { return true; });
  std::uint64_t accepted = 0;
  const auto dropped =
      queue_.put_before_all(request("rest"), [&](std::uint64_t number) { accepted = number; });
  ASSERT_TRUE(dropped.request && dropped.files);
  EXPECT_EQ(dropped.request->number, 1U);
  EXPECT_EQ(accepted, 3U);
  EXPECT_EQ(next()->job.request->number, 3U);
  EXPECT_FALSE(next()->job.files);
}

TEST_F(RequestQueueTest, ARequestThatWaitsIsWithdrawnAndOneThatIsServedIsCancelled) {
  EXPECT_EQ(queue_.cancel(0, "bob").error().code, ErrorCode::NotFound);
  put("a");
  ASSERT_TRUE(next());
  put("b");
  EXPECT_EQ(queue_.open().size(), 2U);
  const auto withdrawn = queue_.cancel(2, "bob");
  ASSERT_TRUE(withdrawn && withdrawn->withdrawn);
  EXPECT_EQ(queue_.open().size(), 1U);
  auto ending = queue_.cancel(1, "bob");
  ASSERT_TRUE(ending && ending->ending);
  EXPECT_EQ(queue_.open().at(0).cancelled_by, "bob");
  SwitchResult result;
  result.request = 1;
  queue_.conclude(result);
  EXPECT_EQ(ending->ending->get().request, 1U);
  EXPECT_THAT(queue_.open(), ::testing::IsEmpty());
}

TEST_F(RequestQueueTest, ItKnowsTheOpenRequestsOfALease) {
  put("a", 7);
  ASSERT_TRUE(next());
  put("b", 7);
  EXPECT_THAT(queue_.open_with(7), ::testing::ElementsAre(1U, 2U));
  EXPECT_THAT(queue_.open_with(8), ::testing::IsEmpty());
}

TEST_F(RequestQueueTest, AResetWaitsUntilWhatIsExecutedHasEnded) {
  std::optional<model::Network> network = model::Network();
  network->name = model::NetworkName("given");
  EXPECT_FALSE(queue_.postpone_reset(network));
  put("a");
  const auto turn = next();
  EXPECT_TRUE(queue_.postpone_reset(network));
  const auto reset = queue_.settle(turn->before);
  ASSERT_TRUE(reset && *reset);
  EXPECT_EQ((*reset)->name, model::NetworkName("given"));
  EXPECT_EQ(queue_.state(), RuntimeState::Idle);
  EXPECT_FALSE(queue_.settle(RuntimeState::Idle));
}

TEST_F(RequestQueueTest, FilesGoBackToWhatWasBeforeTheFirstThatWait) {
  PendingApply first;
  first.before.fallback = model::NetworkName("old");
  queue_.put(first, [](PendingApply*) { return true; });
  auto taken = std::move(*next()->job.files);
  queue_.settle(RuntimeState::Idle);
  PendingApply second;
  second.before.fallback = model::NetworkName("new");
  queue_.put(second, [](PendingApply*) { return true; });
  queue_.take_back(taken, [](Definitions) { FAIL() << "newer files wait"; });
  EXPECT_EQ(next()->job.files->before.fallback, model::NetworkName("old"));
}

TEST_F(RequestQueueTest, TheEndWakesTheWorkerAndLeavesWhatWaits) {
  put("a");
  ASSERT_TRUE(next());
  auto worker = std::async(std::launch::async, [&] { return queue_.next(TimePoint::max()).has_value(); });
  const auto left = queue_.stop();
  EXPECT_FALSE(left.request);
  EXPECT_FALSE(worker.get());
  EXPECT_TRUE(queue_.is_stopped());
  EXPECT_FALSE(queue_.begin_unless_waiting());
}

}  // namespace
}  // namespace segue::runtime::detail
