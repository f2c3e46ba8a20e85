// SPDX-License-Identifier: Apache-2.0
#include <segue/base/child_process.hpp>
#include <segue/base/pipe.hpp>
#include <support/eventually.hpp>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include <gmock/gmock.h>

namespace segue {
namespace {

/// The output of a shell command to descriptor 3, the only one that it has besides the standard three.
std::string said(const std::string& command) {
  auto pipe = make_pipe().value();
  pid_t pid = 0;
  {
    ChildProcess shell(4);
    for (const int number : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
      EXPECT_TRUE(shell.open_null(number));
    EXPECT_TRUE(shell.hand_over(pipe.write.get(), 3));
    shell.set_environment({{"SEGUE_TEST", "given"}});
    const auto started = shell.start("sh", {"sh", "-c", command});
    EXPECT_TRUE(started) << to_string(started.error());
    pid = *started;
  }
  pipe.write = Descriptor();
  const auto text = read_to_end(pipe.read, segue::testing::kPatience);
  EXPECT_EQ(::waitpid(pid, nullptr, 0), pid);
  return text.value();
}

TEST(ChildProcess, HasTheDescriptorsAndTheEnvironmentThatItIsGiven) {
  const Descriptor null(::open("/dev/null", O_RDONLY | O_CLOEXEC));
  const Descriptor own(::fcntl(null.get(), F_DUPFD, 50));  // nobody would close it
  const std::string number = std::to_string(own.get());
  EXPECT_EQ(said("echo $SEGUE_TEST $HOME >&3; [ -e /proc/$$/fd/" + number + " ] || echo closed >&3"),
            "given " + std::string(std::getenv("HOME") == nullptr ? "" : std::getenv("HOME")) + "\nclosed\n");
}

TEST(ChildProcess, LeadsAGroupOfItsOwnWithCleanSignals) {
  EXPECT_EQ(said("cut -d' ' -f5 /proc/$$/stat | grep -qx $$ && echo leads >&3"), "leads\n");
  sigset_t blocked;
  sigset_t before;
  ::sigemptyset(&blocked);
  ::sigaddset(&blocked, SIGTERM);
  ::sigprocmask(SIG_BLOCK, &blocked, &before);
  EXPECT_EQ(said("kill -TERM $$; echo still here >&3"), "");
  ::sigprocmask(SIG_SETMASK, &before, nullptr);
}

TEST(ChildProcess, TellsWhatCannotBeStarted) {
  const auto started = ChildProcess(3).start("/nowhere/program", {"program"}, "the program ");
  ASSERT_FALSE(started);
  EXPECT_EQ(started.error().message,
            "cannot start the program '/nowhere/program': No such file or directory");
}

TEST(ChildProcess, IsKilledWhereItDoesNotEnd) {
  for (const auto& [command, patience] : {std::pair<std::string, Duration>("exit 0", std::chrono::minutes(1)),
                                          {"while :; do sleep 1; done", std::chrono::milliseconds(1)}}) {
    ChildProcess shell(3);
    const auto started = shell.start("sh", {"sh", "-c", command});
    ASSERT_TRUE(started) << to_string(started.error());
    wait_for_end(*started, patience);
    EXPECT_EQ(::kill(*started, 0), -1) << command;
  }
}

}  // namespace
}  // namespace segue
