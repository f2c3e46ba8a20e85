// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/file.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/process_server/process_log.hpp>
#include <segue/process_server/process_server.hpp>

#include <support/eventually.hpp>
#include <support/paths.hpp>
#include <support/sanitizers.hpp>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <set>
#include <thread>

namespace segue::process_server {
namespace {

namespace fs = std::filesystem;
using segue::testing::eventually;
using segue::testing::kPatience;
using std::chrono::milliseconds;
using std::chrono::seconds;
using ::testing::HasSubstr;

TimePoint soon(Duration duration = kPatience) {
  return RealClock::instance().now() + duration;
}

/// A zombie counts as gone.
bool lives(int pid) {
  const auto status = read_file("/proc/" + std::to_string(pid) + "/stat");
  if (!status) return false;
  const auto name_end = status->rfind(')');
  return name_end != std::string::npos && status->size() > name_end + 2 && (*status)[name_end + 2] != 'Z';
}

/// Records the events of a listener.
class Heard {
 public:
  void hear(const ProcessInfo& process) {
    const Lock lock(mutex_);
    told_.push_back(process);
    changed_.notify_all();
  }
  /// The first event of that process.
  std::optional<ProcessInfo> end_of(const std::string& process) {
    Lock lock(mutex_);
    const auto find = [&] {
      return std::ranges::find_if(told_, [&](const auto& each) { return each.key.process.str() == process; });
    };
    if (!changed_.wait_for(mutex_, kPatience, [&] { return find() != told_.end(); })) return std::nullopt;
    return *find();
  }
  std::size_t count() {
    const Lock lock(mutex_);
    return told_.size();
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::vector<ProcessInfo> told_;
};

class ProcessServerTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = "/tmp/segue-test-XXXXXX";
    folder_ = ::mkdtemp(pattern.data());
    ::setenv("XDG_RUNTIME_DIR", folder_.c_str(), 1);
  }

  void TearDown() override {
    for (const int pid : pids_)
      ::kill(-pid, SIGKILL);
    for (const int pid : pids_)
      EXPECT_TRUE(eventually([pid] { return !lives(pid); })) << pid;
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

  static ProcessServerOptions options() {
    ProcessServerOptions options;
    options.program = segue::paths::kTestProcess;
    return options;
  }

  static Launch launch(const std::string& process, const std::string& what = "") {
    Launch launch;
    launch.robot = "rover";
    launch.deployment.process = model::ProcessName(process);
    if (!what.empty()) launch.deployment.environment.emplace_back("TEST_DO", what);
    return launch;
  }

  static model::DeploymentKey key(const std::string& process) {
    return {model::kLocalHost, model::ProcessName(process)};
  }

  static std::unique_ptr<ProcessServer> server(const ProcessServerOptions& chosen = options()) {
    auto made = ProcessServer::create(chosen);
    EXPECT_TRUE(made.has_value()) << (made ? "" : to_string(made.error()));
    return made ? std::move(*made) : nullptr;
  }

  /// Starts a process and waits until it handles signals.
  ProcessInfo started(ProcessServer& server, const Launch& what) {
    auto process = server.start(what, soon());
    EXPECT_TRUE(process.has_value()) << (process ? "" : to_string(process.error()));
    if (!process) return {};
    pids_.push_back(process->pid);
    return *process;
  }
  ProcessInfo ready(ProcessServer& server, const Launch& what) {
    const auto process = started(server, what);
    EXPECT_TRUE(eventually([&] { return text_of(process.log).find("ready\n") != std::string::npos; }))
        << text_of(process.log);
    return process;
  }

  static std::string text_of(const fs::path& file) { return read_file(file).value_or(""); }

  /// File names in the robot's folder.
  [[nodiscard]] std::set<std::string> files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_ / "segue" / "rover"))
      names.insert(entry.path().filename());
    return names;
  }

  fs::path folder_;
  std::vector<int> pids_;
};

TEST_F(ProcessServerTest, aProcessStartsAndStopsAndLeavesOnlyItsLog) {
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

TEST_F(ProcessServerTest, theLogBeginsWithWhoStartsAndHoldsWhatIsPrinted) {
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  const std::string text = text_of(process.log);
  EXPECT_TRUE(text.starts_with("---- ")) << text;
  EXPECT_THAT(text, HasSubstr("rover/drivers starts: pid " + std::to_string(process.pid)));
  ASSERT_TRUE(processes->stop("rover", key("drivers"), soon()).has_value());
  EXPECT_THAT(text_of(process.log), HasSubstr("going\n"));
}

TEST_F(ProcessServerTest, psShowsRobotAndProcess) {
  const auto processes = server();
  const auto process = ready(*processes, launch("drivers"));
  std::string command = text_of("/proc/" + std::to_string(process.pid) + "/cmdline");
  std::ranges::replace(command, '\0', ' ');
  EXPECT_EQ(command, "segue-deployment rover/drivers ");
}

TEST_F(ProcessServerTest, aProcessThatDoesNotGoIsKilledAtTheDeadline) {
  const auto processes = server();
  const auto process = ready(*processes, launch("stubborn", "stay"));
  const auto reason = processes->stop("rover", key("stubborn"), soon(milliseconds(50)));
  ASSERT_TRUE(reason.has_value());
  EXPECT_TRUE(reason->killed);
  EXPECT_EQ(reason->signal, SIGKILL);
  EXPECT_FALSE(lives(process.pid));
}

TEST_F(ProcessServerTest, aHaltedProcessIsKilledToo) {
  const auto processes = server();
  const auto process = ready(*processes, launch("halted"));
  ASSERT_EQ(::kill(process.pid, SIGSTOP), 0);
  const auto reason = processes->stop("rover", key("halted"), soon(milliseconds(50)));
  ASSERT_TRUE(reason.has_value());
  EXPECT_TRUE(reason->killed);
  EXPECT_FALSE(lives(process.pid));
}

TEST_F(ProcessServerTest, exitReasonsAreTold) {
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

TEST_F(ProcessServerTest, aCrashedProcessTakesItsChildrenAlong) {
  const auto processes = server();
  const auto process = ready(*processes, launch("parent", "child"));
  const std::string text = text_of(process.log);
  const int child = std::atoi(text.c_str() + text.find("child ") + 6);
  ASSERT_TRUE(lives(child)) << text;
  ::kill(process.pid, SIGSEGV);
  EXPECT_TRUE(eventually([&] { return !lives(child); }));
}

TEST_F(ProcessServerTest, aKilledProcessTakesItsChildrenAlong) {
  const auto processes = server();
  const auto process = ready(*processes, launch("parent", "child"));
  const std::string text = text_of(process.log);
  const int child = std::atoi(text.c_str() + text.find("child ") + 6);
  ASSERT_TRUE(lives(child)) << text;
  ::kill(process.pid, SIGSTOP);
  ASSERT_TRUE(processes->stop("rover", key("parent"), soon(milliseconds(20))).has_value());
  EXPECT_TRUE(eventually([&] { return !lives(child); }));
}

TEST_F(ProcessServerTest, processesGoOnWithoutTheirServerAndAreAdoptedByTheNext) {
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
TEST_F(ProcessServerTest, ofAnAdoptedProcessTheReasonIsNotKnown) {
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

TEST_F(ProcessServerTest, ofTwoWithOneNameTheSecondIsRefused) {
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

TEST_F(ProcessServerTest, aProcessOfAnotherVersionIsReplaced) {
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

TEST_F(ProcessServerTest, aProcessThatIsEndingIsWaitedFor) {
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

TEST_F(ProcessServerTest, whatADeadProcessLeftIsReplaced) {
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

TEST_F(ProcessServerTest, manyServersOfOneNameStartItOnce) {
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

TEST_F(ProcessServerTest, startAndStopFromManyThreadsLeaveNothing) {
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

TEST_F(ProcessServerTest, aProcessInheritsNothingButWhatItNeeds) {
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

TEST_F(ProcessServerTest, aProcessBeginsWithCleanSignals) {
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

TEST_F(ProcessServerTest, limitsAndVariablesReachTheProcess) {
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

ProcessServerOptions with_zygote(ProcessServerOptions options) {
  options.zygote = true;
  return options;
}

int parent_of(int pid) {
  const std::string status = read_file("/proc/" + std::to_string(pid) + "/status").value_or("");
  const auto at = status.find("PPid:\t");
  return at == std::string::npos ? 0 : std::atoi(status.c_str() + at + 6);
}

TEST_F(ProcessServerTest, aZygoteMakesProcessesThatAreLikeOthers) {
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

TEST_F(ProcessServerTest, whyAChildOfTheZygoteEndedIsTold) {
  const auto processes = server(with_zygote(options()));
  Heard heard;
  processes->set_listener([&](const ProcessInfo& process) { heard.hear(process); });
  started(*processes, launch("aborts", "abort"));
  started(*processes, launch("leaves", "status"));
  EXPECT_EQ(heard.end_of("aborts").value().exit.value().signal, SIGABRT);
  EXPECT_EQ(heard.end_of("leaves").value().exit.value().status, 3);
}

TEST_F(ProcessServerTest, aZygoteThatDoesNotAnswerHoldsUpNoOtherRequest) {
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

TEST_F(ProcessServerTest, withoutItsZygoteProcessesGoOnAndOthersStart) {
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

TEST_F(ProcessServerTest, aZygoteGoesWithItsServerAndItsChildrenStay) {
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

TEST_F(ProcessServerTest, aZygoteKeepsOneChildReadyWhichBecomesTheNextProcess) {
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

TEST_F(ProcessServerTest, aSpareThatWasKilledKeepsNoProcessFromStarting) {
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

TEST_F(ProcessServerTest, aSpareGoesWithItsZygote) {
  auto processes = server(with_zygote(options()));
  const int zygote = parent_of(ready(*processes, launch("drivers")).pid);
  int spare = 0;
  ASSERT_TRUE(eventually([&] { return (spare = spare_of(zygote)) != 0; }));
  ::kill(zygote, SIGKILL);
  EXPECT_TRUE(eventually([&] { return !lives(spare); }));
}

TEST_F(ProcessServerTest, manyProcessesStartAndEndAtOnceThroughAZygote) {
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

using ProcessServerWherePossible = ProcessServerTest;

TEST_F(ProcessServerWherePossible, aControlGroupTakesAlongWhatLeftTheProcessGroup) {
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

TEST_F(ProcessServerWherePossible, onAFullDiskAProcessRunsOn) {
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

TEST_F(ProcessServerTest, outputIsRotated) {
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

TEST_F(ProcessServerTest, aLogIsFollowedAcrossItsRotation) {
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

TEST_F(ProcessServerTest, outputIsRotatedWhenThereIsTooMuchNotOnlyNowAndThen) {
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

TEST_F(ProcessServerTest, aProgramThatCannotRunIsRefusedAndLeavesNothing) {
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

TEST_F(ProcessServerTest, aProgramThatIsMissingIsNamed) {
  ProcessServerOptions chosen;
  chosen.program = "/nowhere/segue-deployment";
  const auto made = ProcessServer::create(chosen);
  ASSERT_FALSE(made.has_value());
  EXPECT_EQ(made.error().code, ErrorCode::NotFound);
  EXPECT_THAT(made.error().message, HasSubstr("/nowhere"));
}

TEST_F(ProcessServerTest, withoutDescriptorsNothingStartsAndNothingStays) {
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

TEST_F(ProcessServerTest, aProcessRunsWhereItsLogCannotBeWritten) {
  const auto processes = server();
  const fs::path socket = process_socket("rover", key("drivers")).value();
  fs::create_directory(process_log(socket));
  const auto process = started(*processes, launch("drivers"));
  const auto reason = processes->stop("rover", key("drivers"), soon());
  ASSERT_TRUE(reason.has_value());
  EXPECT_FALSE(lives(process.pid));
}

TEST_F(ProcessServerTest, namesThatArePathsAreRefused) {
  const auto processes = server();
  Launch wrong = launch("../drivers");
  EXPECT_EQ(processes->start(wrong, soon()).error().code, ErrorCode::InvalidArgument);
  wrong = launch("drivers");
  wrong.robot = "..";
  EXPECT_EQ(processes->start(wrong, soon()).error().code, ErrorCode::InvalidArgument);
  EXPECT_EQ(processes->stop("rover", key("a/b"), soon()).error().code, ErrorCode::InvalidArgument);
  EXPECT_FALSE(processes->processes("/").has_value());
}

TEST_F(ProcessServerTest, whatIsKilledIsNotAskedFirst) {
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

TEST_F(ProcessServerTest, whatDoesNotRunCannotBeStopped) {
  const auto processes = server();
  EXPECT_EQ(processes->stop("rover", key("drivers"), soon()).error().code, ErrorCode::NotFound);
}

TEST_F(ProcessServerTest, aFolderOfSomebodyElseIsRefused) {
  fs::create_directory(folder_ / "segue");
  fs::create_symlink("/tmp", folder_ / "segue" / "rover");
  const auto processes = server();
  const auto process = processes->start(launch("drivers"), soon());
  ASSERT_FALSE(process.has_value());
  EXPECT_EQ(process.error().code, ErrorCode::PermissionDenied);
}

}  // namespace
}  // namespace segue::process_server
