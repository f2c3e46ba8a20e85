// SPDX-License-Identifier: Apache-2.0
#include <segue/base/child_process.hpp>
#include <segue/base/error.hpp>
#include <segue/base/folders.hpp>
#include <segue/mission/script_process.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>
#include <vector>

namespace segue::mission::detail {

namespace {

namespace fs = std::filesystem;

constexpr const char* kWorker = "share/segue/script_worker.py";
/// The descriptor of the socket in the child.
constexpr int kChannel = 3;

/// Finds the worker script of this build or installation.
Result<fs::path> installed_worker() {
  std::error_code ignored;
  for (const fs::path& prefix : install_prefixes()) {
    if (fs::is_regular_file(prefix / kWorker, ignored)) return prefix / kWorker;
  }
  return fail(ErrorCode::NotFound, std::string("cannot find ") + kWorker +
                                       ", which executes Python scripts, in the folder where Segue is "
                                       "installed; install Segue again");
}

ScriptProcess::Read read_some(ssize_t count, std::span<char> buffer, std::string_view& text) {
  if (count == 0) return ScriptProcess::Read::End;
  if (count < 0) {
    const bool later = errno == EAGAIN || errno == EINTR;
    return later ? ScriptProcess::Read::Nothing : ScriptProcess::Read::End;
  }
  text = {buffer.data(), static_cast<std::size_t>(count)};
  return ScriptProcess::Read::Some;
}

Result<pid_t> start_python(const ScriptOptions& options, const fs::path& worker, const Descriptor& channel,
                           const Descriptor& output) {
  ChildProcess python(kChannel + 1);
  const std::pair<const Descriptor*, int> handed[] = {
      {&output, STDOUT_FILENO}, {&output, STDERR_FILENO}, {&channel, kChannel}};
  if (auto opened = python.open_null(STDIN_FILENO); !opened) return opened.error();
  for (const auto& [source, number] : handed) {
    if (auto done = python.hand_over(source->get(), number); !done) return done.error();
  }
  auto pid =
      python.start(options.python, {options.python, worker.string(), std::to_string(options.largest_message)},
                   "the Python interpreter ");
  if (!pid) pid.error().message += "; install python3, or name another interpreter";
  return pid;
}

}  // namespace

Result<ScriptProcess> ScriptProcess::start(const ScriptOptions& options) {
  auto worker = options.worker.empty() ? installed_worker() : Result<fs::path>(options.worker);
  if (!worker) return worker.error();
  std::array<int, 2> socket{-1, -1};
  std::array<int, 2> pipe{-1, -1};
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, socket.data()) != 0)
    return system_error("cannot make a socket for Python", errno);
  ScriptProcess process;
  process.messages_ = Descriptor(socket[0]);
  const Descriptor channel(socket[1]);
  if (::pipe2(pipe.data(), O_CLOEXEC) != 0) return system_error("cannot make a pipe for Python", errno);
  process.output_ = Descriptor(pipe[0]);
  const Descriptor output(pipe[1]);
  ::fcntl(process.output_.get(), F_SETFL, O_NONBLOCK);
  auto pid = start_python(options, *worker, channel, output);
  if (!pid) return pid.error();
  process.pid_ = Pid(*pid);
  process.ended_ = Descriptor(static_cast<int>(::syscall(SYS_pidfd_open, *pid, 0)));
  if (!process.ended_.valid()) return system_error("cannot watch the Python interpreter", errno);
  return process;
}

ScriptProcess::~ScriptProcess() {
  if (pid_ == 0) return;
  kill();
  (void)reap();
}

ScriptProcess::Events ScriptProcess::wait(int wake, bool sending, std::optional<TimePoint> until) const {
  const short both = POLLIN | POLLOUT;
  std::array<pollfd, 4> waited{pollfd{messages_.get(), sending ? both : short{POLLIN}, 0},
                               {output_.get(), POLLIN, 0},
                               {ended_.get(), POLLIN, 0},
                               {wake, POLLIN, 0}};
  int limit = -1;
  if (until) {
    const auto left = std::chrono::ceil<std::chrono::milliseconds>(*until - RealClock::instance().now());
    limit = static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 3'600'000));
  }
  if (::poll(waited.data(), waited.size(), limit) <= 0) return {};
  return {(waited[0].revents & ~POLLOUT) != 0, waited[1].revents != 0, waited[2].revents != 0};
}

ScriptProcess::Read ScriptProcess::read_messages(std::span<char> buffer, std::string_view& text) {
  if (!messages_.valid()) return Read::End;
  const Read read =
      read_some(::recv(messages_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT), buffer, text);
  if (read == Read::End) messages_ = Descriptor();
  return read;
}

ScriptProcess::Read ScriptProcess::read_output(std::span<char> buffer, std::string_view& text) {
  if (!output_.valid()) return Read::End;
  const Read read = read_some(::read(output_.get(), buffer.data(), buffer.size()), buffer, text);
  if (read == Read::End) output_ = Descriptor();
  return read;
}

std::size_t ScriptProcess::send(std::string_view text) const {
  const ssize_t count = ::send(messages_.get(), text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
  return count < 0 ? 0 : static_cast<std::size_t>(count);
}

void ScriptProcess::end_messages() const {
  ::shutdown(messages_.get(), SHUT_WR);
}

void ScriptProcess::kill() const {
  if (pid_ != 0) ::kill(-pid_, SIGKILL);
}

std::string ScriptProcess::reap() {
  int status = 0;
  // Processes that it has started are in its group.
  kill();
  while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
  }
  pid_ = Pid();
  if (!WIFSIGNALED(status)) return "ended with exit status " + std::to_string(WEXITSTATUS(status));
  const int number = WTERMSIG(status);
  const char* name = ::sigdescr_np(number);
  return "was killed by signal " + std::to_string(number) + " (" + (name == nullptr ? "?" : name) + ")";
}

}  // namespace segue::mission::detail
