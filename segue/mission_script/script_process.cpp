// SPDX-License-Identifier: Apache-2.0
#include <segue/base/child_process.hpp>
#include <segue/base/error.hpp>
#include <segue/base/file.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/text.hpp>
#include <segue/mission_script/script_process.hpp>

#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <thread>
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

/// The environment variable by which descendants of a worker are found; its value is unique.
constexpr const char* kMark = "SEGUE_SCRIPT_PROCESS";
/// How often descendants are looked for again; each time those that were born meanwhile are found.
constexpr int kSweeps = 100;

std::string new_mark() {
  static std::atomic<std::uint64_t> number{0};
  return std::to_string(::getpid()) + '.' + std::to_string(monotonic_now().time_since_epoch().count()) + '.' +
         std::to_string(++number);
}

/// The content of a file of a process, which may end meanwhile: reading fails then.
std::string content_of(const fs::path& file) {
  return read_file(file).value_or(std::string());
}

struct Process {
  pid_t pid = 0;
  pid_t parent = 0;
  bool marked = false;
  bool is_changing = false;  ///< it begins a program, or ends: whether it is marked cannot be seen
};
constexpr unsigned kKernelThread = 0x00200000;  // PF_KTHREAD, proc(5)

/// All processes but those that have ended.
std::vector<Process> running_processes(const std::string& mark) {
  std::vector<Process> found;
  const std::string variable = std::string(kMark) + '=' + mark + '\0';
  std::error_code failed;
  for (fs::directory_iterator each("/proc", failed), end; !failed && each != end; each.increment(failed)) {
    const std::string name = each->path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const std::string status = content_of(each->path() / "stat");
    const auto after_name = status.rfind(") ");
    if (after_name == std::string::npos) continue;
    char state = 'Z';
    Process process;
    std::string ignored;
    unsigned flags = 0;
    std::istringstream(status.substr(after_name + 2)) >> state >> process.parent >> ignored >> ignored >>
        ignored >> ignored >> flags;
    if (state == 'Z' || state == 'X' || (flags & kKernelThread) != 0) continue;
    process.pid = static_cast<pid_t>(std::strtol(name.c_str(), nullptr, 10));
    const std::string environment = content_of(each->path() / "environ");
    process.marked = environment.find(variable) != std::string::npos;
    process.is_changing = environment.empty() && content_of(each->path() / "cmdline").empty();
    found.push_back(process);
  }
  return found;
}

/// The descendants of `root`, whatever their process groups and sessions, and what else has the mark, since
/// their parents have ended.
std::vector<pid_t> descendants_of(pid_t root, const std::vector<Process>& all) {
  std::vector<pid_t> found;
  const auto is_found = [&](pid_t pid) { return std::ranges::find(found, pid) != found.end(); };
  for (std::size_t before = 1; before != found.size();) {
    before = found.size();
    for (const Process& each : all) {
      if (each.pid == root || is_found(each.pid)) continue;
      if (each.marked || each.parent == root || is_found(each.parent)) found.push_back(each.pid);
    }
  }
  return found;
}

void kill_descendants(pid_t root, const std::string& mark) {
  for (int i = 0; i < kSweeps; ++i) {
    const auto all = running_processes(mark);
    const auto found = descendants_of(root, all);
    for (const pid_t pid : found)
      ::kill(pid, SIGKILL);
    if (!found.empty()) continue;
    if (std::ranges::none_of(all, &Process::is_changing)) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

bool is_program(const fs::path& file) {
  std::error_code ignored;
  return fs::is_regular_file(file, ignored) && ::access(file.c_str(), X_OK) == 0;
}

/// A name without a slash is searched in PATH.
bool is_found(const std::string& program) {
  if (program.find('/') != std::string::npos) return is_program(program);
  const char* given = std::getenv("PATH");
  std::istringstream folders(given == nullptr ? "/bin:/usr/bin" : given);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (is_program(fs::path(folder.empty() ? "." : folder) / program)) return true;
  }
  return false;
}

Result<pid_t> start_python(const ScriptOptions& options, const fs::path& worker, const Descriptor& channel,
                           const Descriptor& output, const std::string& mark) {
  ChildProcess python(kChannel + 1);
  python.set_environment({{kMark, mark}});
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

Result<void> check_python(const ScriptOptions& options) {
  if (!is_found(options.python)) {
    return fail(ErrorCode::NotFound, "cannot find the Python interpreter " + quote(options.python) +
                                         "; install python3, or name another interpreter");
  }
  const auto worker = options.worker.empty() ? installed_worker() : Result<fs::path>(options.worker);
  if (!worker) return worker.error();
  std::error_code ignored;
  if (fs::is_regular_file(*worker, ignored)) return {};
  return fail(ErrorCode::NotFound, "the script worker " + quote(worker->string()) + " is missing");
}

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
  process.mark_ = new_mark();
  auto pid = start_python(options, *worker, channel, output, process.mark_);
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
  if (pid_ == 0) return;
  // Stopped first, so that it starts no more processes, and its children remain its own, until they are
  // found.
  ::kill(pid_, SIGSTOP);
  kill_descendants(pid_, mark_);
  ::kill(-pid_, SIGKILL);
}

std::string ScriptProcess::reap() {
  int status = 0;
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
