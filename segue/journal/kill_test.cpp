// SPDX-License-Identifier: Apache-2.0
#include <segue/journal/journal_test_support.hpp>

#include <support/paths.hpp>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>
#include <random>
#include <string>
#include <thread>

extern char** environ;

namespace segue::journal {
namespace {

using testing::all_of;
using testing::Folder;

/// A process that writes a journal, starting at a given number, and prints which entries are safe.
class Writer {
 public:
  Writer(const std::filesystem::path& path, std::uint64_t first) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::pipe2(ends.data(), O_CLOEXEC), 0);
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
    std::string program = segue::paths::kTestProcess;
    std::string file = path;
    std::string number = std::to_string(first);
    std::array<char*, 4> arguments = {program.data(), file.data(), number.data(), nullptr};
    EXPECT_EQ(::posix_spawn(&pid_, program.c_str(), &files, nullptr, arguments.data(), environ), 0);
    posix_spawn_file_actions_destroy(&files);
    ::close(ends[1]);
    reported_ = ::fdopen(ends[0], "r");
  }
  Writer(const Writer&) = delete;
  Writer& operator=(const Writer&) = delete;
  ~Writer() { std::fclose(reported_); }

  /// Reads the next safe number; 0 at the end.
  std::uint64_t next() {
    std::array<char, 32> line{};
    return std::fgets(line.data(), line.size(), reported_) == nullptr
               ? 0
               : std::strtoull(line.data(), nullptr, 10);
  }

  /// Waits until it has written that many more times, to any file: a transaction is several writes.
  bool wait_for_writes(std::uint64_t more) const {
    const std::uint64_t before = writes();
    const TimePoint limit = RealClock::instance().now() + std::chrono::seconds(60);
    while (writes() < before + more) {
      if (RealClock::instance().now() > limit) return false;
      std::this_thread::yield();
    }
    return true;
  }

  /// Kills the process; returns the last number that it printed.
  std::uint64_t kill(std::uint64_t safe) {
    ::kill(pid_, SIGKILL);
    while (const std::uint64_t later = next())
      safe = later;
    int status = 0;
    ::waitpid(pid_, &status, 0);
    EXPECT_TRUE(WIFSIGNALED(status));
    return safe;
  }

 private:
  /// The calls of the system with which it has written.
  [[nodiscard]] std::uint64_t writes() const {
    std::ifstream file("/proc/" + std::to_string(pid_) + "/io");
    std::string name;
    std::uint64_t count = 0;
    while (file >> name >> count) {
      if (name == "syscw:") return count;
    }
    ADD_FAILURE() << "the system does not say what process " << pid_ << " has written";
    return 0;
  }

  pid_t pid_ = -1;
  std::FILE* reported_ = nullptr;
};

TEST(JournalKill, NothingThatWasFlushedIsLostWheneverTheWriterIsKilled) {
  const Folder folder;
  const auto path = folder / "j";
  std::mt19937 random(1);  // NOLINT(cert-msc51-cpp): the same moments in each run, as far as possible
  std::uint64_t safe = 0;
  for (int life = 0; life < 40; ++life) {
    Writer writer(path, safe + 1);
    const auto flushes = std::uniform_int_distribution<int>(0, 8)(random);
    std::uint64_t last = safe;
    for (int i = 0; i < flushes; ++i)
      last = std::max(last, writer.next());
    ASSERT_TRUE(writer.wait_for_writes(std::uniform_int_distribution<std::uint64_t>(0, 40)(random)));
    last = writer.kill(last);
    if (!std::filesystem::exists(path)) continue;
    auto reader = JournalReader::open(path);
    if (!reader && reader.error().code == ErrorCode::NotFound && last == 0) continue;
    ASSERT_TRUE(reader) << to_string(reader.error());
    EXPECT_TRUE(reader->check());
    const auto entries = all_of(path);
    ASSERT_GE(entries.size(), last);
    for (std::size_t i = 0; i < entries.size(); ++i) {
      ASSERT_EQ(entries[i].request, i + 1);
      ASSERT_EQ(entries[i].actions.size(), 20U);
    }
    const auto times = reader->times();
    ASSERT_TRUE(times);
    if (!entries.empty()) {
      EXPECT_EQ(times->actions.begin()->second.count, 20 * entries.size());
    }
    safe = entries.size();
  }
  EXPECT_GT(safe, 50U);
}

}  // namespace
}  // namespace segue::journal
