// SPDX-License-Identifier: Apache-2.0
#include <segue/process_server/test_support.hpp>

namespace segue::process_server {
namespace {

TEST_F(ProcessServerTest, AProcessStartsAndStopsAndLeavesOnlyItsLog) {
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  EXPECT_TRUE(lives(process.pid));
  EXPECT_EQ(::getpgid(process.pid), process.pid);
  const auto reason = processes->stop("rover", key("drivers"), soon());
  ASSERT_TRUE(reason.has_value());
  EXPECT_EQ(reason->status, 0);
  EXPECT_TRUE(reason->requested);
  EXPECT_FALSE(reason->killed);
  EXPECT_FALSE(lives(process.pid));
  EXPECT_EQ(files(), std::set<std::string>{"drivers.log"});
}

TEST_F(ProcessServerTest, TheLogBeginsWithWhoStartsAndHoldsWhatIsPrinted) {
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  const std::string text = text_of(process.log);
  EXPECT_TRUE(text.starts_with("---- ")) << text;
  EXPECT_THAT(text, HasSubstr("rover/drivers starts: pid " + std::to_string(process.pid)));
  ASSERT_TRUE(processes->stop("rover", key("drivers"), soon()).has_value());
  EXPECT_THAT(text_of(process.log), HasSubstr("going\n"));
}

TEST_F(ProcessServerTest, PsShowsRobotAndProcess) {
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  std::string command = text_of("/proc/" + std::to_string(process.pid) + "/cmdline");
  std::ranges::replace(command, '\0', ' ');
  EXPECT_EQ(command, "segue-deployment rover/drivers ");
}

TEST_F(ProcessServerTest, AProcessThatDoesNotGoIsKilledAtTheDeadline) {
  const auto processes = server();
  const auto process = ready(*processes, launch("stubborn", "stay"));
  const auto reason = processes->stop("rover", key("stubborn"), soon(milliseconds(50)));
  ASSERT_TRUE(reason.has_value());
  EXPECT_TRUE(reason->killed);
  EXPECT_EQ(reason->signal, SIGKILL);
  EXPECT_FALSE(lives(process.pid));
}

TEST_F(ProcessServerTest, AHaltedProcessIsKilledToo) {
  const auto processes = server();
  const auto process = ready(*processes, launch("halted"));
  ASSERT_EQ(::kill(process.pid, SIGSTOP), 0);
  const auto reason = processes->stop("rover", key("halted"), soon(milliseconds(50)));
  ASSERT_TRUE(reason.has_value());
  EXPECT_TRUE(reason->killed);
  EXPECT_FALSE(lives(process.pid));
}

TEST_F(ProcessServerTest, ExitReasonsAreTold) {
  const auto processes = server();
  Heard heard;
  processes->set_listener([&](const ProcessInfo& process) { heard.hear(process); });
  started(*processes, launch("aborts", "abort"));
  started(*processes, launch("segvs", "segv"));
  started(*processes, launch("leaves", "status"));
  EXPECT_EQ(heard.end_of("aborts").value().exit.value().signal, SIGABRT);
  EXPECT_EQ(heard.end_of("segvs").value().exit.value().signal, SIGSEGV);
  EXPECT_EQ(heard.end_of("leaves").value().exit.value().status, 3);
  EXPECT_EQ(to_string(*heard.end_of("aborts")->exit), "was ended by SIGABRT");
  EXPECT_EQ(heard.count(), 3U);
  EXPECT_TRUE(processes->processes("rover").value().empty());
}

TEST_F(ProcessServerTest, ACrashedProcessTakesItsChildrenAlong) {
  const auto processes = server();
  const auto process = ready(*processes, launch("parent", "child"));
  const std::string text = text_of(process.log);
  const int child = std::atoi(text.c_str() + text.find("child ") + 6);
  ASSERT_TRUE(lives(child)) << text;
  ::kill(process.pid, SIGSEGV);
  EXPECT_TRUE(eventually([&] { return !lives(child); }));
}

TEST_F(ProcessServerTest, AKilledProcessTakesItsChildrenAlong) {
  const auto processes = server();
  const auto process = ready(*processes, launch("parent", "child"));
  const std::string text = text_of(process.log);
  const int child = std::atoi(text.c_str() + text.find("child ") + 6);
  ASSERT_TRUE(lives(child)) << text;
  ::kill(process.pid, SIGSTOP);
  ASSERT_TRUE(processes->stop("rover", key("parent"), soon(milliseconds(20))).has_value());
  EXPECT_TRUE(eventually([&] { return !lives(child); }));
}

TEST_F(ProcessServerTest, ProcessesGoOnWithoutTheirServerAndAreAdoptedByTheNext) {
  auto first = server();
  const auto process = ready(*first, launch("drivers"));
  first.reset();
  EXPECT_TRUE(lives(process.pid));
  const auto second = server();
  const auto found = second->processes("rover");
  ASSERT_TRUE(found.has_value());
  ASSERT_EQ(found->size(), 1U);
  EXPECT_EQ(found->front().pid, process.pid);
  EXPECT_EQ(found->front().key, process.key);
  EXPECT_TRUE(found->front().adopted);
  Heard heard;
  second->set_listener([&](const ProcessInfo& each) { heard.hear(each); });
  ASSERT_TRUE(second->stop("rover", key("drivers"), soon()).has_value());
  EXPECT_TRUE(heard.end_of("drivers").has_value());
  EXPECT_FALSE(lives(process.pid));
}

/// The process has another parent, so the server under test cannot learn why it ended.
TEST_F(ProcessServerTest, OfAnAdoptedProcessTheReasonIsNotKnown) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  const pid_t other = ::fork();
  if (other == 0) {
    auto made = ProcessServer::create(options());
    const auto process = made ? (*made)->start(launch("drivers"), soon()) : made.error();
    const int pid = process ? process->pid : 0;
    [[maybe_unused]] const auto written = ::write(pipe[1], &pid, sizeof pid);
    std::_Exit(0);
  }
  int pid = 0;
  ASSERT_EQ(::read(pipe[0], &pid, sizeof pid), static_cast<ssize_t>(sizeof pid));
  ::close(pipe[0]);
  ::close(pipe[1]);
  ASSERT_GT(pid, 0);
  pids_.push_back(pid);
  const auto processes = server();
  Heard heard;
  processes->set_listener([&](const ProcessInfo& each) { heard.hear(each); });
  ASSERT_TRUE(eventually([&] { return processes->processes("rover").value().size() == 1; }));
  ::kill(pid, SIGKILL);
  const auto ending = heard.end_of("drivers");
  ASSERT_TRUE(ending.has_value());
  EXPECT_FALSE(ending->exit.value().known);
  EXPECT_FALSE(ending->exit.value().requested);
  EXPECT_FALSE(files().contains("drivers.sock"));
}

TEST_F(ProcessServerTest, OfTwoWithOneNameTheSecondIsRefused) {
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  const auto second = processes->start(launch("drivers"), soon());
  ASSERT_FALSE(second.has_value());
  EXPECT_EQ(second.error().code, ErrorCode::AlreadyExists);
  EXPECT_THAT(second.error().message, HasSubstr("pid " + std::to_string(process.pid)));
  const auto other = server();
  const auto third = other->start(launch("drivers"), soon());
  ASSERT_FALSE(third.has_value());
  EXPECT_EQ(third.error().code, ErrorCode::AlreadyExists);
  EXPECT_TRUE(lives(process.pid));
}

TEST_F(ProcessServerTest, AProcessOfAnotherVersionIsReplaced) {
  auto first = server();
  Launch old = launch("drivers");
  old.deployment.environment.emplace_back("TEST_SOFTWARE", "0.0.7");
  const auto before = ready(*first, old);
  first.reset();
  const auto second = server();
  const auto after = started(*second, launch("drivers"));
  EXPECT_NE(after.pid, before.pid);
  EXPECT_FALSE(lives(before.pid));
  EXPECT_TRUE(lives(after.pid));
}

TEST_F(ProcessServerTest, AProcessThatIsEndingIsWaitedFor) {
  auto first = server();
  const auto ending = ready(*first, launch("drivers", "end slowly"));
  EXPECT_TRUE(eventually([&] { return !lives(ending.pid); }));
  first.reset();
  const auto second = server();
  EXPECT_EQ(second->start(launch("drivers"), soon(milliseconds(5))).error().code, ErrorCode::AlreadyExists);
  std::jthread end([&] { ::kill(ending.pid, SIGTERM); });
  const auto process = started(*second, launch("drivers"));
  EXPECT_NE(process.pid, ending.pid);
  EXPECT_TRUE(lives(process.pid));
}

TEST_F(ProcessServerTest, WhatADeadProcessLeftIsReplaced) {
  const auto processes = server();
  ASSERT_TRUE(process_folder("rover").has_value());
  const fs::path socket = process_socket("rover", key("drivers")).value();
  ASSERT_TRUE(write_file(socket, "").has_value());
  ASSERT_TRUE(write_file(fs::path(socket) += ".lock", "pid 1\nsoftware 0.1.0\n").has_value());
  EXPECT_TRUE(processes->processes("rover").value().empty());
  EXPECT_FALSE(fs::exists(socket));
  ASSERT_TRUE(write_file(socket, "").has_value());
  started(*processes, launch("drivers"));
}

TEST_F(ProcessServerTest, ManyServersOfOneNameStartItOnce) {
  std::vector<std::unique_ptr<ProcessServer>> servers;
  for (int i = 0; i < 4; ++i)
    servers.push_back(server());
  std::atomic<int> started{0};
  std::atomic<int> pid{0};
  {
    std::vector<std::jthread> threads;
    for (const auto& each : servers) {
      threads.emplace_back([&] {
        const auto process = each->start(launch("drivers"), soon());
        if (!process) return;
        ++started;
        pid = process->pid;
      });
    }
  }
  if (pid > 0) pids_.push_back(pid);
  EXPECT_EQ(started, 1);
}

TEST_F(ProcessServerTest, StartAndStopFromManyThreadsLeaveNothing) {
  const auto processes = server();
  Mutex mutex;
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 4; ++i) {
      threads.emplace_back([&, i] {
        for (int turn = 0; turn < 10; ++turn) {
          const auto process = processes->start(launch(i % 2 == 0 ? "a" : "b"), soon());
          if (process) {
            const Lock lock(mutex);
            pids_.push_back(process->pid);
          }
          static_cast<void>(processes->stop("rover", key(i < 2 ? "a" : "b"), soon()));
        }
      });
    }
  }
  for (const auto* name : {"a", "b"})
    static_cast<void>(processes->stop("rover", key(name), soon()));
  for (const int pid : pids_)
    EXPECT_FALSE(lives(pid));
  pids_.clear();
  EXPECT_EQ(files(), (std::set<std::string>{"a.log", "b.log"}));
}

TEST_F(ProcessServerTest, AProcessInheritsNothingButWhatItNeeds) {
  const int leak = ::open("/dev/zero", O_RDONLY);  // not close-on-exec
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  std::set<std::string> targets;
  for (const auto& entry : fs::directory_iterator("/proc/" + std::to_string(process.pid) + "/fd")) {
    std::error_code ignored;
    const std::string target = fs::read_symlink(entry.path(), ignored);
    if (target.starts_with("anon_inode:")) continue;  // it has opened these itself
    targets.insert(target.starts_with("socket:") ? "socket" : target);
  }
  ::close(leak);
  EXPECT_EQ(targets, (std::set<std::string>{"/dev/null", process.log.string(), "socket",
                                            process.socket.string() + ".lock"}));
}

TEST_F(ProcessServerTest, AProcessBeginsWithCleanSignals) {
  sigset_t blocked;
  sigemptyset(&blocked);
  sigaddset(&blocked, SIGUSR1);
  sigset_t before;
  pthread_sigmask(SIG_BLOCK, &blocked, &before);
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  const std::string status = text_of("/proc/" + std::to_string(process.pid) + "/status");
  const auto at = status.find("SigBlk:\t");
  ASSERT_NE(at, std::string::npos);
  const auto mask = std::stoull(status.substr(at + 8, 16), nullptr, 16);
  EXPECT_EQ(mask & (1U << (SIGUSR1 - 1)), 0U);
}

/// Sanitizers reserve terabytes of address space, which no limit of memory permits.
constexpr std::uint64_t kMemoryLimit = kSanitized ? std::uint64_t{1} << 50 : std::uint64_t{512} << 20;

TEST_F(ProcessServerTest, LimitsAndVariablesReachTheProcess) {
  const auto processes = server();
  Launch limited = launch("drivers");
  limited.deployment.limits = {kMemoryLimit, 100, seconds(60), 0};
  limited.deployment.environment.emplace_back("PLACE", "the moon");
  const auto process = ready(*processes, limited);
  const std::string proc = "/proc/" + std::to_string(process.pid);
  const std::string limits = text_of(proc + "/limits");
  const std::string memory = std::to_string(kMemoryLimit);
  EXPECT_THAT(limits, ::testing::ContainsRegex("Max data size +" + memory + " +" + memory));
  EXPECT_THAT(limits, ::testing::ContainsRegex("Max open files +100 +100"));
  EXPECT_THAT(limits, ::testing::ContainsRegex("Max cpu time +60 +60"));
  EXPECT_THAT(limits, ::testing::ContainsRegex("Max core file size +0 +0"));
  EXPECT_THAT(text_of(proc + "/environ"), HasSubstr("PLACE=the moon"));
}

TEST_F(ProcessServerTest, AProgramThatCannotRunIsRefusedAndLeavesNothing) {
  const fs::path broken = folder_ / "broken";
  ASSERT_TRUE(write_file(broken, "no program").has_value());
  ::chmod(broken.c_str(), 0755);
  ProcessServerOptions chosen;
  chosen.program = broken;
  const auto processes = server(chosen);
  const auto process = processes->start(launch("drivers"), soon());
  ASSERT_FALSE(process.has_value());
  EXPECT_THAT(process.error().message, HasSubstr("broken"));
  EXPECT_FALSE(files().contains("drivers.sock"));
  EXPECT_FALSE(files().contains("drivers.sock.lock"));
  EXPECT_EQ(processes->start(launch("drivers"), soon()).error().code, process.error().code);
}

TEST_F(ProcessServerTest, AProgramThatIsMissingIsNamed) {
  ProcessServerOptions chosen;
  chosen.program = "/nowhere/segue-deployment";
  const auto made = ProcessServer::create(chosen);
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().code, ErrorCode::NotFound);
  EXPECT_THAT(made.error().message, HasSubstr("/nowhere"));
}

TEST_F(ProcessServerTest, WithoutDescriptorsNothingStartsAndNothingStays) {
  const auto processes = server();
  rlimit before{};
  ::getrlimit(RLIMIT_NOFILE, &before);
  const Descriptor next(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  for (rlim_t room = 0; room < 12; ++room) {
    const rlimit few{static_cast<rlim_t>(next.get()) + 1 + room, before.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &few);
    const auto process = processes->start(launch("drivers"), soon());
    ::setrlimit(RLIMIT_NOFILE, &before);
    if (process) {
      pids_.push_back(process->pid);
      ASSERT_TRUE(processes->stop("rover", key("drivers"), soon()).has_value());
      continue;
    }
    EXPECT_FALSE(files().contains("drivers.sock"));
    EXPECT_TRUE(processes->processes("rover").value().empty());
  }
  const auto process = processes->start(launch("drivers"), soon());
  ASSERT_TRUE(process.has_value());
  pids_.push_back(process->pid);
}

TEST_F(ProcessServerTest, AProcessRunsWhereItsLogCannotBeWritten) {
  const auto processes = server();
  const fs::path socket = process_socket("rover", key("drivers")).value();
  fs::create_directory(process_log(socket));
  const auto process = started(*processes, launch("drivers"));
  const auto reason = processes->stop("rover", key("drivers"), soon());
  ASSERT_TRUE(reason.has_value());
  EXPECT_FALSE(lives(process.pid));
}

TEST_F(ProcessServerTest, NamesThatArePathsAreRefused) {
  const auto processes = server();
  Launch wrong = launch("../drivers");
  EXPECT_EQ(processes->start(wrong, soon()).error().code, ErrorCode::InvalidArgument);
  wrong = launch("drivers");
  wrong.robot = "..";
  EXPECT_EQ(processes->start(wrong, soon()).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(processes->stop("rover", key("a/b"), soon()).error().code, ErrorCode::InvalidArgument);
  EXPECT_FALSE(processes->processes("/").has_value());
}

TEST_F(ProcessServerTest, WhatIsKilledIsNotAskedFirst) {
  const auto processes = server();
  const auto process = ready(*processes, launch("stubborn", "stay"));
  const auto reason = processes->kill("rover", key("stubborn"), soon());
  ASSERT_TRUE(reason.has_value()) << to_string(reason.error());
  EXPECT_EQ(reason->signal, SIGKILL);
  EXPECT_TRUE(reason->killed);
  EXPECT_TRUE(reason->requested);
  EXPECT_FALSE(lives(process.pid));
  EXPECT_EQ(processes->kill("rover", key("stubborn"), soon()).error().code, ErrorCode::NotFound);
}

TEST_F(ProcessServerTest, WhatDoesNotRunCannotBeStopped) {
  const auto processes = server();
  EXPECT_EQ(processes->stop("rover", key("drivers"), soon()).error().code, ErrorCode::NotFound);
}

TEST_F(ProcessServerTest, AFolderOfSomebodyElseIsRefused) {
  fs::create_directory(folder_ / "segue");
  fs::create_symlink("/tmp", folder_ / "segue" / "rover");
  const auto processes = server();
  const auto process = processes->start(launch("drivers"), soon());
  ASSERT_FALSE(process.has_value());
  EXPECT_EQ(process.error().code, ErrorCode::PermissionDenied);
}

}  // namespace
}  // namespace segue::process_server
