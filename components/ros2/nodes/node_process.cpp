// SPDX-License-Identifier: Apache-2.0
#include "node_process.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/error.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/pipe.hpp>
#include <segue/concurrent/thread.hpp>

#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <string_view>

namespace ros2 {
namespace {

namespace fs = std::filesystem;
using segue::ErrorCode;
using segue::fail;
using segue::Result;

constexpr const char* kGuard = "lib/segue/segue-process-guard";
/// Between the steps by which the guard ends a program, in milliseconds.
constexpr const char* kGrace = "3000";
/// The descriptors of the guard; the program has the second one.
constexpr int kOwner = 3;
constexpr int kParameters = 4;
constexpr const char* kParametersPath = "/proc/self/fd/4";

Result<fs::path> find_guard() {
  std::error_code ignored;
  for (const fs::path& prefix : segue::install_prefixes()) {
    if (fs::is_regular_file(prefix / kGuard, ignored)) return prefix / kGuard;
  }
  return fail(ErrorCode::NotFound, std::string("cannot find ") + kGuard +
                                       " in the folder where Segue is installed; install segue-ros2 again");
}

/// A file without a name that holds the text.
Result<segue::Descriptor> file_of(std::string_view text) {
  segue::Descriptor file(::memfd_create("parameters", MFD_CLOEXEC));
  if (!file.valid()) return segue::system_error("cannot make a parameter file", errno);
  while (!text.empty()) {
    const ssize_t written = ::write(file.get(), text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return segue::system_error("cannot write a parameter file", errno);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return file;
}

/// How a process has ended, which is reaped.
std::string reap(int descriptor) {
  siginfo_t ended{};
  if (::waitid(P_PIDFD, static_cast<id_t>(descriptor), &ended, WEXITED) != 0) return "has ended";
  if (ended.si_code == CLD_EXITED) return "ended with exit status " + std::to_string(ended.si_status);
  const char* name = ::sigdescr_np(ended.si_status);
  return "was killed by signal " + std::to_string(ended.si_status) +
         (name == nullptr ? "" : std::string(" (") + name + ")");
}

}  // namespace

Result<std::unique_ptr<NodeProcess>> NodeProcess::start(const NodeProgram& program) {
  auto guard = find_guard();
  if (!guard) return guard.error();
  auto owner = segue::make_pipe();
  if (!owner) return owner.error();
  segue::ChildProcess child(kParameters + 1);
  child.set_environment(program.environment);
  std::vector<std::string> words = {guard->string(), kGrace, program.program.string()};
  words.insert(words.end(), program.arguments.begin(), program.arguments.end());
  if (auto done = child.open_null(STDIN_FILENO); !done) return done.error();
  for (const auto& [source, number] :
       {std::pair(STDOUT_FILENO, STDOUT_FILENO), std::pair(STDERR_FILENO, STDERR_FILENO),
        std::pair(owner->read.get(), kOwner)}) {
    if (auto done = child.hand_over(source, number); !done) return done.error();
  }
  if (!program.parameters.empty()) {
    auto file = file_of(program.parameters);
    if (!file) return file.error();
    if (auto done = child.hand_over(file->get(), kParameters); !done) return done.error();
    words.insert(words.end(), {"--ros-args", "--params-file", kParametersPath});
  }
  auto pid = child.start(guard->string(), std::move(words));
  if (!pid) return pid.error();
  segue::Descriptor descriptor(static_cast<int>(::syscall(SYS_pidfd_open, *pid, 0)));
  if (!descriptor.valid()) {
    ::kill(*pid, SIGTERM);
    ::waitpid(*pid, nullptr, 0);
    return segue::system_error("cannot watch a process", errno);
  }
  std::unique_ptr<NodeProcess> made(new NodeProcess(*pid, std::move(descriptor), std::move(owner->write)));
  made->thread_ =
      segue::concurrent::start_thread("ros2-process", [process = made.get()] { process->wait(); });
  return made;
}

NodeProcess::NodeProcess(pid_t guard, segue::Descriptor descriptor, segue::Descriptor owner)
    : guard_(guard), descriptor_(std::move(descriptor)), owner_(std::move(owner)) {}

NodeProcess::~NodeProcess() {
  {
    const segue::Lock lock(mutex_);
    if (end_.empty()) ::kill(guard_, SIGTERM);
  }
  thread_.join();
}

void NodeProcess::wait() {
  siginfo_t waited{};
  while (::waitid(P_PIDFD, static_cast<id_t>(descriptor_.get()), &waited, WEXITED | WNOWAIT) != 0 &&
         errno == EINTR) {
  }
  const segue::Lock lock(mutex_);
  end_ = reap(descriptor_.get());
  for (const auto& [owner, ended] : watchers_)
    ended();
}

void NodeProcess::watch(const void* owner, std::function<void()> ended) {
  const segue::Lock lock(mutex_);
  if (!end_.empty()) ended();
  watchers_[owner] = std::move(ended);
}

void NodeProcess::stop_watching(const void* owner) {
  const segue::Lock lock(mutex_);
  watchers_.erase(owner);
}

std::string NodeProcess::end() const {
  const segue::Lock lock(mutex_);
  return end_;
}

Result<void> NodeProcess::finish(segue::TimePoint deadline) {
  owner_ = segue::Descriptor();
  if (segue::wait_for_input(descriptor_.get(), deadline)) return {};
  const segue::Lock lock(mutex_);
  if (end_.empty()) ::kill(guard_, SIGTERM);
  return fail(ErrorCode::DeadlineExceeded, "it has not ended in time, and is killed");
}

}  // namespace ros2
