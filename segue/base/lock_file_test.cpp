// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/lock_file.hpp>
#include <segue/base/process_state.hpp>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <optional>
#include <thread>

#include "support/ending_process.hpp"

namespace segue {
namespace {

namespace fs = std::filesystem;

TEST(ProcessState, OnlyWhatIsThereCanBeEnding) {
  EXPECT_FALSE(is_ending(::getpid()));
  EXPECT_FALSE(is_ending(1));
  std::optional<testing::EndingProcess> process(std::in_place);
  const int pid = process->pid();
  EXPECT_TRUE(is_ending(pid));
  process.reset();
  EXPECT_FALSE(is_ending(pid));
}

class LockFileTest : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  static TimePoint in(Duration duration) { return RealClock::instance().now() + duration; }
  /// The lock, with the record of a holder.
  [[nodiscard]] Descriptor held(int pid) const {
    auto lock = try_lock(path_).value();
    EXPECT_TRUE(lock && write_record(lock->get(), {pid, "1.2.3"}));
    return std::move(*lock);
  }

  fs::path folder_ = fs::temp_directory_path() / ("segue_lock_test." + std::to_string(::getpid()));
  fs::path path_ = lock_of(folder_ / "x");
};

TEST_F(LockFileTest, StandsBesideItsFile) {
  EXPECT_EQ(path_, folder_ / "x.lock");
}

TEST_F(LockFileTest, HasOneOwnerAndEndsWithIt) {
  {
    const auto first = held(::getpid());
    EXPECT_FALSE(try_lock(path_).value());
  }
  EXPECT_TRUE(try_lock(path_).value());
}

// An owner may remove the file while another thread has opened it and not locked it yet.
TEST_F(LockFileTest, IsOfTheFileThatIsThere) {
  const auto lock_and_remove = [this] {
    for (int i = 0; i < 5000; ++i) {
      const auto lock = try_lock(path_).value();
      if (!lock) continue;
      struct stat held {};
      ASSERT_EQ(::fstat(lock->get(), &held), 0);
      ASSERT_EQ(held.st_nlink, 1U) << "only the owner removes it";
      fs::remove(path_);
    }
  };
  std::jthread other(lock_and_remove);
  lock_and_remove();
}

TEST_F(LockFileTest, TellsWhoHoldsIt) {
  EXPECT_FALSE(read_record(path_));
  const auto lock = held(12345678);
  EXPECT_EQ(read_record(path_)->pid, 12345678);
  EXPECT_EQ(read_record(path_)->software, "1.2.3");
  ASSERT_TRUE(write_record(lock.get(), {}));
  EXPECT_EQ(read_record(path_)->pid, 0);
  EXPECT_EQ(read_record(path_)->software, "");
}

TEST_F(LockFileTest, GarbageIsNoRecord) {
  for (const char* garbage :
       {"", "pid", "pid x\nsoftware 1\n", "pid -1\nsoftware 1\n", "pid 1", "pid 99999999999\nsoftware 1\n"}) {
    ASSERT_TRUE(write_file(path_, garbage));
    EXPECT_FALSE(read_record(path_)) << garbage;
  }
}

TEST_F(LockFileTest, WhoLivesIsNotWaitedFor) {
  const auto lock = held(::getpid());
  EXPECT_FALSE(lock_when_ended(path_, in(std::chrono::hours(1))).value());
}

TEST_F(LockFileTest, WhoIsOnlyStartingIsNotWaitedFor) {
  const auto lock = held(0);
  EXPECT_FALSE(lock_when_ended(path_, in(std::chrono::hours(1))).value());
}

TEST_F(LockFileTest, WhoIsEndingIsWaitedForUntilTheDeadline) {
  const testing::EndingProcess holder;
  const auto lock = held(holder.pid());
  EXPECT_FALSE(lock_when_ended(path_, in(std::chrono::milliseconds(5))).value());
}

TEST_F(LockFileTest, WhoIsEndingIsWaitedForUntilItHasEnded) {
  const testing::EndingProcess holder;
  std::optional<Descriptor> lock = held(holder.pid());
  std::jthread end([&] { lock.reset(); });
  EXPECT_TRUE(lock_when_ended(path_, in(std::chrono::minutes(1))).value());
}

}  // namespace
}  // namespace segue
