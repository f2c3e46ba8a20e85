// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/test_support.hpp>

namespace segue::process_server {
namespace {

ProcessServerOptions with_zygote(ProcessServerOptions options) {
  options.zygote = true;
  return options;
}

int parent_of(int pid) {
  const std::string status = read_file("/proc/" + std::to_string(pid) + "/status").value_or("");
  const auto at = status.find("PPid:\t");
  return at == std::string::npos ? 0 : std::atoi(status.c_str() + at + 6);
}

TEST_F(ProcessServerTest, AZygoteMakesProcessesThatAreLikeOthers) {
  const auto processes = server(with_zygote(options()));
  Launch what = launch("drivers");
  what.deployment.environment.emplace_back("PLACE", "the moon");
  const auto process = ready(*processes, what);
  const int zygote = parent_of(process.pid);
  EXPECT_EQ(parent_of(zygote), ::getpid());
  EXPECT_EQ(::getpgid(process.pid), process.pid);
  const std::string command = text_of("/proc/" + std::to_string(process.pid) + "/cmdline");
  EXPECT_STREQ(command.c_str(), "segue-deployment");
  EXPECT_STREQ(command.c_str() + sizeof "segue-deployment", "rover/drivers");
  std::set<std::string> numbers;
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(process.pid) + "/fd")) {
    std::error_code ignored;
    const bool own = fs::read_symlink(entry.path(), ignored).native().starts_with("anon_inode:");
    if (!own) numbers.insert(entry.path().filename());
  }
  EXPECT_EQ(numbers, (std::set<std::string>{"0", "1", "2", "4", "5"}));
  const auto reason = processes->stop("rover", key("drivers"), soon());
  ASSERT_TRUE(reason.has_value());
  EXPECT_TRUE(reason->known);
  EXPECT_EQ(reason->status, 0);
  EXPECT_EQ(files(), std::set<std::string>{"drivers.log"});
}

TEST_F(ProcessServerTest, WhyAChildOfTheZygoteEndedIsTold) {
  const auto processes = server(with_zygote(options()));
  Heard heard;
  processes->set_listener([&](const ProcessInfo& process) { heard.hear(process); });
  started(*processes, launch("aborts", "abort"));
  started(*processes, launch("leaves", "status"));
  EXPECT_EQ(heard.end_of("aborts").value().exit.value().signal, SIGABRT);
  EXPECT_EQ(heard.end_of("leaves").value().exit.value().status, 3);
}

TEST_F(ProcessServerTest, AZygoteThatDoesNotAnswerHoldsUpNoOtherRequest) {
  const auto processes = server(with_zygote(options()));
  Heard heard;
  processes->set_listener([&](const ProcessInfo& process) { heard.hear(process); });
  const auto victim = ready(*processes, launch("victim"));
  const auto other = ready(*processes, launch("other"));
  const int zygote = parent_of(victim.pid);
  ::kill(zygote, SIGSTOP);
  ::kill(victim.pid, SIGKILL);
  // Once its death has been noticed, the answer of the zygote is waited for.
  ASSERT_TRUE(eventually([&] { return !lives(victim.pid); }));
  for (int i = 0; i < 100; ++i)
    EXPECT_GE(processes->processes("rover").value().size(), 1U);
  ::kill(zygote, SIGCONT);
  // If a request had waited for the zygote, its answer would have come too late to be used.
  EXPECT_EQ(heard.end_of("victim").value().exit.value().signal, SIGKILL);
  EXPECT_TRUE(lives(other.pid));
}

TEST_F(ProcessServerTest, WithoutItsZygoteProcessesGoOnAndOthersStart) {
  const auto processes = server(with_zygote(options()));
  const auto before = ready(*processes, launch("before"));
  const int zygote = parent_of(before.pid);
  ::kill(zygote, SIGKILL);
  ASSERT_TRUE(eventually([&] { return !lives(zygote); }));
  EXPECT_TRUE(lives(before.pid));
  const auto after = ready(*processes, launch("after"));
  EXPECT_EQ(parent_of(after.pid), ::getpid());
  EXPECT_TRUE(processes->stop("rover", key("before"), soon()).has_value());
  EXPECT_FALSE(lives(before.pid));
}

TEST_F(ProcessServerTest, AZygoteGoesWithItsServerAndItsChildrenStay) {
  auto first = server(with_zygote(options()));
  const auto process = ready(*first, launch("drivers"));
  const int zygote = parent_of(process.pid);
  first.reset();
  EXPECT_FALSE(lives(zygote));
  EXPECT_TRUE(lives(process.pid));
  const auto second = server();
  EXPECT_EQ(second->processes("rover").value().size(), 1U);
  EXPECT_TRUE(second->stop("rover", key("drivers"), soon()).has_value());
}

/// The child that a zygote keeps ready; 0: there is none.
int spare_of(int zygote) {
  std::error_code failed;
  for (const auto& entry : fs::directory_iterator("/proc", failed)) {
    const int pid = std::atoi(entry.path().filename().c_str());
    if (pid == 0 || parent_of(pid) != zygote) continue;
    const std::string command = read_file(entry.path() / "cmdline").value_or("");
    if (command.find(std::string("\0spare\0", 7)) != std::string::npos) return pid;
  }
  return 0;
}

TEST_F(ProcessServerTest, AZygoteKeepsOneChildReadyWhichBecomesTheNextProcess) {
  const auto processes = server(with_zygote(options()));
  const int zygote = parent_of(ready(*processes, launch("first")).pid);
  int spare = 0;
  ASSERT_TRUE(eventually([&] { return (spare = spare_of(zygote)) != 0; }));
  const auto second = ready(*processes, launch("second"));
  EXPECT_EQ(second.pid, spare);
  EXPECT_EQ(::getpgid(second.pid), second.pid);
  EXPECT_TRUE(eventually([&] { return spare_of(zygote) != 0; }));
  EXPECT_EQ(processes->processes("rover").value().size(), 2U);
}

/// Whether all threads of a child that is not waited for have ended, and its sockets are closed with them. (A
/// sanitizer adds a thread, which may end after the first one.)
bool has_ended(int pid) {
  std::error_code failed;
  const fs::directory_iterator threads("/proc/" + std::to_string(pid) + "/task", failed);
  return !lives(pid) && (failed || std::distance(begin(threads), end(threads)) <= 1);
}

TEST_F(ProcessServerTest, ASpareThatWasKilledKeepsNoProcessFromStarting) {
  const auto processes = server(with_zygote(options()));
  const int zygote = parent_of(ready(*processes, launch("first")).pid);
  for (const char* name : {"second", "third"}) {
    int spare = 0;
    ASSERT_TRUE(eventually([&] { return (spare = spare_of(zygote)) != 0; }));
    ::kill(spare, SIGKILL);
    ASSERT_TRUE(eventually([&] { return has_ended(spare); }));
    EXPECT_TRUE(lives(ready(*processes, launch(name)).pid));
  }
  EXPECT_TRUE(lives(zygote));
}

TEST_F(ProcessServerTest, ASpareGoesWithItsZygote) {
  auto processes = server(with_zygote(options()));
  const int zygote = parent_of(ready(*processes, launch("drivers")).pid);
  int spare = 0;
  ASSERT_TRUE(eventually([&] { return (spare = spare_of(zygote)) != 0; }));
  ::kill(zygote, SIGKILL);
  EXPECT_TRUE(eventually([&] { return !lives(spare); }));
}

TEST_F(ProcessServerTest, ManyProcessesStartAndEndAtOnceThroughAZygote) {
  constexpr int kThreads = 8;
  constexpr int kRounds = 5;
  const auto processes = server(with_zygote(options()));
  Mutex mutex;  // of pids_
  std::vector<std::thread> threads;
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&, name = "process" + std::to_string(i)] {
      for (int round = 0; round < kRounds; ++round) {
        const auto process = processes->start(launch(name), soon());
        ASSERT_TRUE(process.has_value()) << to_string(process.error());
        {
          const Lock lock(mutex);
          pids_.push_back(process->pid);
        }
        ASSERT_TRUE(eventually([&] { return text_of(process->log).ends_with("ready\n"); }));
        const auto reason = processes->stop("rover", key(name), soon());
        ASSERT_TRUE(reason.has_value()) << to_string(reason.error());
        EXPECT_EQ(to_string(*reason), "ended with status 0");
      }
    });
  }
  for (std::thread& thread : threads)
    thread.join();
  EXPECT_TRUE(processes->processes("rover").value().empty());
}

}  // namespace
}  // namespace segue::process_server
