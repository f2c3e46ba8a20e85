// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/test_support.hpp>

namespace segue::process_server {
namespace {

using ProcessServerWherePossible = ProcessServerTest;

TEST_F(ProcessServerWherePossible, AControlGroupTakesAlongWhatLeftTheProcessGroup) {
  fs::path parent;
  for (const fs::path place : {"/sys/fs/cgroup", "/sys/fs/cgroup/unified"}) {
    if (fs::exists(place / "cgroup.procs") && ::access(place.c_str(), W_OK) == 0) parent = place;
  }
  if (parent.empty()) GTEST_SKIP() << "there is no control group of version 2 to write to";
  ProcessServerOptions chosen = options();
  chosen.cgroup = parent / ("segue-test-" + std::to_string(::getpid()));
  if (::mkdir(chosen.cgroup.c_str(), 0755) != 0) GTEST_SKIP() << "a control group cannot be made";
  const auto processes = server(chosen);
  const auto process = ready(*processes, launch("drivers"));
  const fs::path group = chosen.cgroup / "segue.rover.drivers";
  EXPECT_EQ(text_of(group / "cgroup.procs"), std::to_string(process.pid) + "\n");
  EXPECT_TRUE(processes->stop("rover", key("drivers"), soon()).has_value());
  EXPECT_FALSE(fs::exists(group));
  ::rmdir(chosen.cgroup.c_str());
}

TEST_F(ProcessServerWherePossible, OnAFullDiskAProcessRunsOn) {
  const fs::path disk = folder_ / "segue";
  fs::create_directory(disk);
  ::chmod(disk.c_str(), 0700);
  if (::mount("none", disk.c_str(), "tmpfs", 0, "size=256k,mode=0700") != 0) {
    GTEST_SKIP() << "a small disk cannot be made";
  }
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers", "chatter always"));
  {
    std::ofstream filler(disk / "filler");
    for (int i = 0; i < 1024 && filler.flush(); ++i)
      filler << std::string(1024, 'x');
  }
  EXPECT_TRUE(lives(process.pid));
  const auto reason = processes->stop("rover", key("drivers"), soon());
  EXPECT_TRUE(reason.has_value() && reason->status == 0 && !reason->killed);
  EXPECT_EQ(::umount2(disk.c_str(), MNT_DETACH), 0);
}

TEST_F(ProcessServerTest, OutputIsRotated) {
  ProcessServerOptions chosen = options();
  chosen.log_size = 1000;
  chosen.log_files = 2;
  const auto processes = server(chosen);
  const auto process = started(*processes, launch("drivers", "chatter"));
  const fs::path older = fs::path(process.log) += ".1";
  ASSERT_TRUE(eventually([&] { return fs::exists(older) && fs::exists(process.log); }));
  ASSERT_TRUE(processes->stop("rover", key("drivers"), soon()).has_value());
  EXPECT_THAT(text_of(older), HasSubstr("line 1999"));
  EXPECT_THAT(text_of(process.log), HasSubstr("going\n"));
  const auto tail = log_tail(process.log, 4);
  ASSERT_TRUE(tail.has_value());
  EXPECT_EQ(std::ranges::count(tail->text, '\n'), 4);
  EXPECT_TRUE(tail->text.ends_with("going\n"));
}

TEST_F(ProcessServerTest, ALogIsFollowedAcrossItsRotation) {
  const fs::path log = folder_ / "p.log";
  const auto newer = [&](LogPosition& at) {
    auto part = log_after(log, at);
    EXPECT_TRUE(part) << to_string(part.error());
    at = part->end;
    return part->text;
  };
  EXPECT_EQ(log_after(log, {}).error().code, ErrorCode::NotFound);
  ASSERT_TRUE(write_file(log, "one\ntwo\n"));
  LogPosition at = log_tail(log, 1)->end;
  EXPECT_EQ(newer(at), "");
  std::ofstream(log, std::ios::app) << "three\n";
  EXPECT_EQ(newer(at), "three\n");
  std::ofstream(log, std::ios::app) << "four\n";
  fs::rename(log, fs::path(log) += ".1");
  std::ofstream(log) << "five\n";
  EXPECT_EQ(newer(at), "four\n") << "what was printed before it was rotated";
  EXPECT_EQ(newer(at), "five\n");
  EXPECT_EQ(newer(at), "");
  at = LogPosition{1, 7};
  EXPECT_EQ(newer(at), "five\n") << "of a file that is gone";
}

TEST_F(ProcessServerTest, OutputIsRotatedWhenThereIsTooMuchNotOnlyNowAndThen) {
  ProcessServerOptions chosen = options();
  chosen.log_size = 1000;
  chosen.log_files = 1;
  const auto processes = server(chosen);
  const auto process = started(*processes, launch("drivers", "print once"));  // looks once an hour
  const fs::path older = fs::path(process.log) += ".1";
  EXPECT_TRUE(eventually([&] { return fs::exists(older) && fs::exists(process.log); }));
  ASSERT_TRUE(processes->stop("rover", key("drivers"), soon()).has_value());
  EXPECT_TRUE(text_of(process.log).ends_with("going\n"));
}

}  // namespace
}  // namespace segue::process_server
