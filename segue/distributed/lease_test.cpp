// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/lease.hpp>

#include <segue/base/file.hpp>

#include <support/eventually.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <future>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

namespace segue::distributed {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;
using segue::testing::eventually;

class SettableClock final : public Clock {
 public:
  [[nodiscard]] TimePoint now() const override { return TimePoint(now_.load()); }
  void sleep_until(TimePoint when) override { now_ = when.time_since_epoch(); }
  void pass(Duration duration) { now_ = now_.load() + duration; }

 private:
  std::atomic<Duration> now_{Duration(1h)};
};

TimePoint before_long() {
  return RealClock::instance().now() + 30s;
}
TimePoint at_once() {
  return RealClock::instance().now();
}

class LeaseTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-lease-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    lease_.emplace("spot", file(), clock_);
  }
  void TearDown() override {
    lease_.reset();
    fs::remove_all(folder_);
  }
  [[nodiscard]] fs::path file() const { return folder_ / "spot.epoch"; }

  /// Who takes it over has seen what has gone before.
  [[nodiscard]] Claim claim(const std::string& holder, bool take_over = false) const {
    return {holder, "key of " + holder, take_over, false, take_over ? lease_->highest_term() + 1 : 0};
  }
  [[nodiscard]] static Claim of_term(const std::string& holder, std::uint64_t term) {
    return {holder, "key of " + holder, true, false, term};
  }
  /// The daemon is started again.
  void restart() { lease_.emplace("spot", file(), clock_); }

  /// The epoch that the holder got; 0 where it was refused.
  std::uint64_t acquire(const std::string& holder, bool take_over = false) {
    return lease_->acquire(claim(holder, take_over), before_long()).value_or(0);
  }
  ErrorCode refusal_of(const std::string& holder, bool take_over = false, TimePoint deadline = at_once()) {
    const auto got = lease_->acquire(claim(holder, take_over), deadline);
    EXPECT_FALSE(got);
    return got ? ErrorCode::Internal : got.error().code;
  }

  /// Why a holder that has had it before is refused; nothing where it gets it.
  std::optional<ErrorCode> code_of_again(const std::string& holder) {
    const auto got = lease_->acquire({holder, "key of " + holder, false, true}, before_long());
    return got ? std::nullopt : std::optional(got.error().code);
  }

  fs::path folder_;
  SettableClock clock_;
  std::optional<Lease> lease_;
};

TEST_F(LeaseTest, EpochsGrowAlsoOverARestart) {
  EXPECT_EQ(lease_->info().epoch, 0U);
  const auto first = acquire("a");
  EXPECT_GT(first, 0U);
  ASSERT_TRUE(lease_->release(first));
  const auto second = acquire("b");
  EXPECT_GT(second, first);
  restart();
  EXPECT_EQ(lease_->info().holder, "");
  EXPECT_EQ(lease_->info().epoch, second);
  EXPECT_FALSE(lease_->renew(second)) << "a restart of the daemon ends all leases";
  clock_.pass(Lease::kValidity);
  EXPECT_GT(acquire("c"), second);
}

TEST_F(LeaseTest, AfterARestartWhoHadItGetsItBeforeAllOthers) {
  const auto first = acquire("a");
  restart();
  EXPECT_EQ(refusal_of("b"), ErrorCode::AlreadyExists);
  EXPECT_GT(acquire("a"), first);
  restart();
  clock_.pass(Lease::kValidity);
  EXPECT_GT(acquire("b"), first) << "but not for ever";
  restart();
  EXPECT_GT(acquire("c", true), first) << "and who takes it over waits for nobody";
}

TEST_F(LeaseTest, AfterAReleaseARestartKeepsNobodyWaiting) {
  ASSERT_TRUE(lease_->release(acquire("a")));
  restart();
  EXPECT_GT(acquire("b"), 0U);
}

TEST_F(LeaseTest, WhoWasSupersededDoesNotGetItBackByARestart) {
  ASSERT_GT(acquire("a"), 0U);
  ASSERT_GT(acquire("b", true), 0U);
  restart();
  EXPECT_EQ(refusal_of("a"), ErrorCode::AlreadyExists);
  EXPECT_GT(acquire("b"), 0U);
  EXPECT_EQ(refusal_of("a"), ErrorCode::AlreadyExists);
}

TEST_F(LeaseTest, WhoAsksAgainIsSupersededBySomebodyWhoHasHadItSince) {
  ASSERT_GT(acquire("a"), 0U);
  const auto since = acquire("b", true);
  EXPECT_EQ(code_of_again("a"), ErrorCode::Superseded);
  ASSERT_TRUE(lease_->release(since));
  EXPECT_EQ(code_of_again("a"), ErrorCode::Superseded) << "although nobody has it any more";
  restart();
  EXPECT_EQ(code_of_again("a"), ErrorCode::Superseded);
}

TEST_F(LeaseTest, WhoAsksAgainGetsItWhereNobodyElseHasHadItSince) {
  const auto first = acquire("a");
  EXPECT_EQ(code_of_again("a"), std::nullopt);
  clock_.pass(1h);
  EXPECT_EQ(code_of_again("a"), std::nullopt);
  restart();
  EXPECT_EQ(code_of_again("a"), std::nullopt);
  fs::remove(file());
  restart();
  EXPECT_EQ(code_of_again("a"), std::nullopt) << "the host has lost everything";
  EXPECT_GT(first, 0U);
}

TEST_F(LeaseTest, WhoTakesItOverGetsItAlthoughSomebodyElseHasHadItSince) {
  ASSERT_GT(acquire("a"), 0U);
  ASSERT_GT(acquire("b", true), 0U);
  EXPECT_TRUE(lease_->acquire({"a", "key of a", true, true, 2}, before_long()));
}

TEST_F(LeaseTest, OfTwoThatTakeItOverAtOnceTheHigherTermWinsInBothOrders) {
  ASSERT_GT(acquire("a"), 0U);
  ASSERT_TRUE(lease_->acquire(of_term("low", 6), before_long()));
  ASSERT_TRUE(lease_->acquire(of_term("high", 7), before_long()));
  const auto refused = lease_->acquire(of_term("low", 6), before_long());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::Superseded);
  EXPECT_NE(refused.error().message.find("'high'"), std::string::npos) << refused.error().message;
  EXPECT_EQ(lease_->info().holder, "high");
}

TEST_F(LeaseTest, OfTwoWithTheSameTermTheGreaterNameWins) {
  ASSERT_TRUE(lease_->acquire(of_term("m", 1), before_long()));
  EXPECT_FALSE(lease_->acquire(of_term("l", 1), before_long()));
  EXPECT_TRUE(lease_->acquire(of_term("n", 1), before_long()));
  EXPECT_TRUE(lease_->acquire(of_term("n", 1), before_long())) << "it has it";
  EXPECT_TRUE(lease_->acquire({"n", "another run of the same name", true, false, 2}, before_long()));
}

TEST_F(LeaseTest, TheTermCountsWhoeverHadItBefore) {
  EXPECT_EQ(lease_->highest_term(), 0U);
  const auto first = lease_->acquire(of_term("a", 6), before_long());
  ASSERT_TRUE(first);
  EXPECT_EQ(lease_->highest_term(), 6U);
  ASSERT_TRUE(lease_->release(*first));
  EXPECT_GT(acquire("b"), 0U) << "nobody has it";
  EXPECT_EQ(lease_->highest_term(), 6U);
  EXPECT_TRUE(lease_->acquire(of_term("c", 1), before_long())) << "b has taken it over from nobody";
  restart();
  EXPECT_EQ(lease_->highest_term(), 6U);
  EXPECT_EQ(lease_->acquire(of_term("b", 1), before_long()).error().code, ErrorCode::Superseded)
      << "c gets it again before all others";
  clock_.pass(Lease::kValidity);
  EXPECT_TRUE(lease_->acquire(of_term("b", 1), before_long())) << "but not for ever";
}

TEST_F(LeaseTest, WhoWaitsForTheEndOfWorkIsNotTakenOverByALowerTerm) {
  const auto first = acquire("a");
  std::optional<Lease::Work> work(std::in_place, *lease_, first);
  auto high =
      std::async(std::launch::async, [&] { return lease_->acquire(of_term("high", 7), before_long()); });
  ASSERT_TRUE(eventually([&] { return lease_->info().epoch != first; }));
  EXPECT_EQ(lease_->acquire(of_term("low", 6), before_long()).error().code, ErrorCode::Superseded);
  work.reset();
  EXPECT_TRUE(high.get());
  EXPECT_EQ(lease_->info().holder, "high");
}

TEST_F(LeaseTest, TheNameOfWhoHasItIsNoKey) {
  ASSERT_GT(acquire("a"), 0U);
  for (const std::string key : {"", "a", "key of b"}) {
    const auto stolen = lease_->acquire({"a", key, false}, before_long());
    EXPECT_FALSE(stolen) << key;
  }
  restart();
  EXPECT_FALSE(lease_->acquire({"a", "", false}, before_long()));
}

TEST_F(LeaseTest, NobodyElseGetsItBeforeItHasRunOut) {
  ASSERT_GT(acquire("a"), 0U);
  EXPECT_EQ(lease_->info().holder, "a");
  EXPECT_EQ(lease_->info().left, Lease::kValidity);
  clock_.pass(Lease::kValidity - 1ms);
  const auto refused = lease_->acquire(claim("b"), before_long());
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::AlreadyExists);
  EXPECT_NE(refused.error().message.find("'a'"), std::string::npos) << refused.error().message;
  EXPECT_EQ(lease_->info().holder, "a");
  clock_.pass(1ms);
  EXPECT_EQ(lease_->info().left, 0ms);
  EXPECT_GT(acquire("b"), 0U);
}

TEST_F(LeaseTest, RenewingExtendsIt) {
  const auto epoch = acquire("a");
  clock_.pass(Lease::kValidity - 1ms);
  ASSERT_TRUE(lease_->renew(epoch));
  clock_.pass(Lease::kValidity - 1ms);
  EXPECT_EQ(refusal_of("b"), ErrorCode::AlreadyExists);
  clock_.pass(1h);
  EXPECT_TRUE(lease_->renew(epoch)) << "nobody else has got it";
  EXPECT_EQ(refusal_of("b"), ErrorCode::AlreadyExists);
}

TEST_F(LeaseTest, TheSameHolderGetsItAtOnce) {
  const auto first = acquire("a");
  const auto second = acquire("a");
  EXPECT_GT(second, first);
  EXPECT_EQ(lease_->renew(first).error().code, ErrorCode::Unavailable) << "nobody else has got it";
  EXPECT_FALSE(Lease::Work(*lease_, first));
  EXPECT_TRUE(Lease::Work(*lease_, second));
}

TEST_F(LeaseTest, WhoTakesItOverEndsWhatWentBefore) {
  const auto first = acquire("a");
  const auto second = acquire("b", true);
  ASSERT_GT(second, first);
  EXPECT_EQ(lease_->renew(first).error().code, ErrorCode::Superseded);
  EXPECT_EQ(lease_->release(first).error().code, ErrorCode::Superseded);
  EXPECT_EQ(lease_->info().holder, "b") << "the former one cannot give it up";
  EXPECT_FALSE(Lease::Work(*lease_, first));
  EXPECT_EQ(lease_->refusal(first).code, ErrorCode::Superseded);
  EXPECT_NE(lease_->refusal(first).message.find("'b'"), std::string::npos);
  EXPECT_EQ(refusal_of("a"), ErrorCode::AlreadyExists);
}

TEST_F(LeaseTest, WhoReleasesItCanDoNothingAnyMore) {
  const auto epoch = acquire("a");
  ASSERT_TRUE(lease_->release(epoch));
  EXPECT_EQ(lease_->info().left, 0ms);
  EXPECT_FALSE(Lease::Work(*lease_, epoch));
  EXPECT_EQ(lease_->renew(epoch).error().code, ErrorCode::Unavailable);
  EXPECT_TRUE(lease_->release(epoch)) << "twice does no harm";
  EXPECT_GT(acquire("b"), epoch);
}

TEST_F(LeaseTest, AnEpochThatNeverWasHasNoWork) {
  EXPECT_FALSE(Lease::Work(*lease_, 0));
  const auto epoch = acquire("a");
  EXPECT_FALSE(Lease::Work(*lease_, 0));
  EXPECT_FALSE(Lease::Work(*lease_, epoch + 1));
}

TEST_F(LeaseTest, AcquiringWaitsForWorkInProgress) {
  const auto first = acquire("a");
  std::optional<Lease::Work> work(std::in_place, *lease_, first);
  Lease::Work moved(std::move(*work));
  work.reset();
  ASSERT_TRUE(moved);
  auto next = std::async(std::launch::async, [&] { return acquire("b", true); });
  EXPECT_EQ(next.wait_for(50ms), std::future_status::timeout);
  EXPECT_FALSE(Lease::Work(*lease_, first)) << "nothing more begins";
  { const Lease::Work ends(std::move(moved)); }
  const auto second = next.get();
  EXPECT_GT(second, first);
  EXPECT_TRUE(Lease::Work(*lease_, second));
}

TEST_F(LeaseTest, NobodyHasItWhereWorkDoesNotEnd) {
  const auto first = acquire("a");
  {
    const Lease::Work work(*lease_, first);
    EXPECT_EQ(refusal_of("b", true, RealClock::instance().now() + 20ms), ErrorCode::DeadlineExceeded);
    EXPECT_EQ(lease_->info().holder, "");
    EXPECT_FALSE(lease_->renew(first));
    EXPECT_FALSE(Lease::Work(*lease_, first));
    EXPECT_FALSE(Lease::Work(*lease_, lease_->info().epoch));
    EXPECT_EQ(refusal_of("c"), ErrorCode::DeadlineExceeded);
  }
  EXPECT_GT(acquire("a"), first) << "also the former one may try again";
}

TEST_F(LeaseTest, WhoWaitsIsSupersededByWhoComesLater) {
  const auto first = acquire("a");
  std::optional<Lease::Work> work(std::in_place, *lease_, first);
  auto early =
      std::async(std::launch::async, [&] { return lease_->acquire(claim("b", true), before_long()); });
  ASSERT_TRUE(eventually([&] { return lease_->info().epoch != first; }));
  auto late = std::async(std::launch::async, [&] { return lease_->acquire(claim("c"), before_long()); });
  ASSERT_TRUE(eventually([&] { return lease_->info().epoch != first + 1; }));
  work.reset();
  const auto b = early.get();
  const auto c = late.get();
  ASSERT_FALSE(b);
  EXPECT_EQ(b.error().code, ErrorCode::Superseded);
  ASSERT_TRUE(c) << to_string(c.error());
  EXPECT_EQ(lease_->info().holder, "c");
}

TEST_F(LeaseTest, NobodyGetsItWhereTheEpochCannotBeKept) {
  const auto first = acquire("a");
  fs::remove_all(folder_);
  EXPECT_EQ(refusal_of("b", true), ErrorCode::IoError);
  EXPECT_TRUE(lease_->renew(first)) << "nothing has changed";
  EXPECT_TRUE(Lease::Work(*lease_, first));
  fs::create_directory(folder_);
  EXPECT_GT(acquire("b", true), first);
}

TEST_F(LeaseTest, AFileThatIsNoEpochCountsAsNone) {
  ASSERT_TRUE(write_file(file(), "no number\n"));
  lease_.emplace("spot", file(), clock_);
  EXPECT_EQ(lease_->info().epoch, 0U);
  EXPECT_GT(acquire("a"), 0U);
}

TEST_F(LeaseTest, NoTwoHoldersWorkAtTheSameTime) {
  std::atomic<std::uint64_t> working{0};
  std::atomic<int> overlaps{0};
  std::atomic<int> done{0};
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) {
    threads.emplace_back([&, holder = "h" + std::to_string(i)] {
      for (int round = 0; round < 20; ++round) {
        const auto epoch = lease_->acquire(claim(holder, true), before_long());
        for (int call = 0; epoch && call < 20; ++call) {
          const Lease::Work work(*lease_, *epoch);
          if (!work) {
            break;
          }
          const auto other = working.exchange(*epoch);
          overlaps += other > *epoch ? 1 : 0;
          ++done;
        }
      }
    });
  }
  for (auto& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(overlaps, 0) << "an older epoch worked after a newer one";
  EXPECT_GT(done, 0);
}

}  // namespace
}  // namespace segue::distributed
