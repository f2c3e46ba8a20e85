// SPDX-License-Identifier: Apache-2.0
#include "network_test.hpp"

#include <support/paths.hpp>

#include <fcntl.h>
#include <sys/mount.h>
#include <unistd.h>

#include <fstream>

namespace segue::testing {

using type::Value;

void NetworkTest::SetUp() {
  const auto& obstacle = TestNetwork::obstacle();
  if (!obstacle.empty()) GTEST_SKIP() << obstacle;
  DisturbedChainTest::SetUp();
  network_ = std::make_unique<TestNetwork>(std::vector<std::string>{"a", "b", "c", "runtime"});
  ASSERT_EQ(segue({"host", "init", "--authority", "ca", "--no-host", "--out", "me"}).status, 0);
}

void NetworkTest::TearDown() {
  if (!network_) return;
  network_->say("clear");
  DisturbedChainTest::TearDown();
  network_.reset();
  if (disk_.empty()) return;
  ::umount2(disk_.c_str(), MNT_DETACH);
  std::filesystem::remove(disk_);
}

Surroundings NetworkTest::surroundings_of(const std::string& host) {
  const std::string keys = "keys_" + host;
  EXPECT_EQ(segue({"host", "enrol", host, "--host", "--authority", "ca", "--out", keys}).status, 0);
  return {.launcher = launcher(host),
          .options = {"--listen", "0.0.0.0", "--credentials", (folder_ / keys).string()},
          .environment = {},
          .address = "tcp://" + network_->address(host) + ":7447",
          .credentials = (folder_ / "me").string()};
}

std::vector<std::string> NetworkTest::runtime_launcher() const {
  return launcher("runtime");
}

std::vector<std::string> NetworkTest::launcher(const std::string& station) const {
  auto command = TestNetwork::launcher(station);
  if (!has_clocks_) return command;
  const char* sanitizer = std::getenv("ASAN_OPTIONS");
  command.insert(command.end(), {"/usr/bin/env", std::string("LD_PRELOAD=") + segue::paths::kShiftedClock,
                                 "SEGUE_TEST_CLOCK=" + (folder_ / ("clock_" + station)).string(),
                                 "ASAN_OPTIONS=" + std::string(sanitizer == nullptr ? "" : sanitizer) +
                                     ":verify_asan_link_order=0"});
  return command;
}

void NetworkTest::give_clocks() {
  has_clocks_ = true;
  for (const char* station : {"a", "b", "runtime"})
    set_clock(station, 0);
}

void NetworkTest::set_clock(const std::string& station, std::int64_t seconds) const {
  // In place, since processes have mapped it.
  const std::int64_t nanoseconds = seconds * 1'000'000'000;
  const auto file = folder_ / ("clock_" + station);
  const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  EXPECT_EQ(::pwrite(opened, &nanoseconds, sizeof nanoseconds, 0), static_cast<ssize_t>(sizeof nanoseconds));
  ::close(opened);
}

void NetworkTest::give_b_a_disk() {
  std::string pattern = ::testing::TempDir() + "segue-disk-XXXXXX";
  ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
  disk_ = pattern;
  ASSERT_EQ(::mount("tmpfs", disk_.c_str(), "tmpfs", 0, "size=4m"), 0);
  std::filesystem::create_directory_symlink(disk_, folder_ / "b");
}

void NetworkTest::fill_disk() const {
  std::ofstream file(disk_ / "full", std::ios::binary);
  const std::string page(4096, 'x');
  while (file.write(page.data(), static_cast<std::streamsize>(page.size())).flush()) {
  }
}

void NetworkTest::empty_disk() const {
  std::filesystem::remove(disk_ / "full");
}

bool NetworkTest::try_switch(const std::string& controller) {
  const auto result = switch_disturbed(controller, 0, [] {});
  const std::string runs = text_in(status(), "controller");
  const bool is_done = text_in(result, "outcome") == "done";
  if (is_done) {
    EXPECT_EQ(runs, controller);
  }
  EXPECT_EQ(what_stays_wrong(HostsTest::network(runs)), "") << type::to_json(result);
  return is_done;
}

void NetworkTest::expect_all_accounted_for() {
  const std::uint64_t lost = expect_each_once_and_in_order();
  const std::uint64_t dropped =
      flow("producer.out", "relay.in").dropped + flow("relay.out", "consumer.in").dropped;
  EXPECT_LE(lost, dropped) << segue({"status"}).output;
}

}  // namespace segue::testing
