// SPDX-License-Identifier: Apache-2.0
// The memory that a process shares is overwritten with garbage, as each of its peers can do,
// SEGUE_HOSTILE_ROUNDS times (3).
#include <segue/base/descriptor.hpp>
#include <segue/sample_link/mapping.hpp>

#include <fcntl.h>
#include <sys/stat.h>

#include <atomic>
#include <cstdlib>
#include <optional>
#include <random>

#include "deployed_robot.hpp"
#include "disturbed_transition.hpp"

namespace segue::testing {
namespace {

class OverwrittenMemory : public DeployedRobotTest {
 protected:
  /// The memory of a process into which its peers write.
  static std::optional<sample_link::Mapping> control_memory_of(pid_t process) {
    const auto folder = std::filesystem::path("/proc") / std::to_string(process) / "fd";
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      std::error_code gone;
      const auto target = std::filesystem::read_symlink(entry.path(), gone).string();
      if (target.find("segue-control") == std::string::npos) continue;
      const Descriptor file(::open(entry.path().c_str(), O_RDWR | O_CLOEXEC));
      struct stat found {};
      if (::fstat(file.get(), &found) != 0) continue;
      auto mapped = sample_link::Mapping::of_file(file.get(), static_cast<std::size_t>(found.st_size),
                                                  sample_link::Mapping::Access::ReadWrite);
      if (mapped) return std::move(*mapped);
    }
    return std::nullopt;
  }
  void spoil(const std::string& deployment) {
    constexpr std::size_t kUsed = std::size_t{1} << 21;  // its rings lie there
    const auto memory = control_memory_of(pid_of(deployment));
    ASSERT_TRUE(memory);
    auto* words = reinterpret_cast<std::atomic<std::uint64_t>*>(memory->data());
    for (int i = 0; i < 30'000; ++i)
      words[random_() % (kUsed / 8)] = random_() >> random_() % 64;
  }
  std::string differences() {
    std::string all;
    for (const auto& sentence : runtime().observed_differences())
      all += sentence + '\n';
    return all;
  }
  static bool is_told_of(const std::string& connection, const std::string& told) {
    return told.find(
               "connection " + connection +
               " (buffer of 4000) is missing: its shared memory was overwritten by one of the processes ") !=
           std::string::npos;
  }
  bool hears_more() {
    const auto before = sight().beats;
    return eventually([&] { return sight().beats > before + 20; });
  }
  static int rounds() {
    const char* rounds = std::getenv("SEGUE_HOSTILE_ROUNDS");
    return rounds == nullptr ? 3 : std::atoi(rounds);
  }

 private:
  std::mt19937_64 random_{20261126};
};

TEST_F(OverwrittenMemory, IsToldWithThoseWhoCanHaveDoneItAndMadeAgain) {
  const auto plain = network("plain");
  const auto more =
      network("more", std::string(kRelay), kWork, std::string(kFlow) + "  - relay.out -> watcher.in\n");
  switch_to(plain);
  for (int round = 0; round < rounds(); ++round) {
    SCOPED_TRACE(round);
    ASSERT_TRUE(hears_more());
    spoil("eye");
    // Both connections into that memory are overwritten; each is told when it shows.
    std::string told;
    ASSERT_TRUE(eventually([&] {
      told = differences();
      return is_told_of("beater.out -> watcher.in", told) &&
             is_told_of("beater.words -> watcher.words", told);
    })) << told;
    EXPECT_NE(told.find("'localhost/heart'"), std::string::npos) << told;
    EXPECT_NE(told.find("'localhost/eye'"), std::string::npos) << told;
    switch_to(plain);
    EXPECT_EQ(differences(), "");
    ASSERT_TRUE(hears_more());
    switch_to(more);  // a new process maps the memory
    switch_to(plain);
    ASSERT_TRUE(hears_more());
    EXPECT_EQ(sight().torn, 0U);
  }
  expect_undisturbed("witness");
}

}  // namespace
}  // namespace segue::testing
