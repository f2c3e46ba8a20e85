// SPDX-License-Identifier: Apache-2.0
#include <segue/base/lock_file.hpp>
#include <segue/base/log.hpp>
#include <segue/process_server/assignment.hpp>
#include <segue/process_server/inherited_process.hpp>

#include <fcntl.h>
#include <poll.h>
#include <pthread.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <string>

namespace segue::process_server {

namespace {

Descriptor take(int descriptor) {
  if (::fcntl(descriptor, F_SETFD, FD_CLOEXEC) != 0) return Descriptor();
  return Descriptor(descriptor);
}

sigset_t end_signals() {
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGTERM);
  ::sigaddset(&signals, SIGINT);
  return signals;
}

/// "2026-03-01T12:00:00Z"
std::string time_now() {
  // Not gmtime(), which reads the file of the local time zone first.
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto today = std::chrono::floor<std::chrono::days>(now);
  const std::chrono::year_month_day date(today);
  const std::chrono::hh_mm_ss time(now - today);
  std::array<char, 64> text{};
  const int size =
      std::snprintf(text.data(), text.size(), "%04d-%02u-%02uT%02d:%02d:%02dZ", int{date.year()},
                    unsigned{date.month()}, unsigned{date.day()}, static_cast<int>(time.hours().count()),
                    static_cast<int>(time.minutes().count()), static_cast<int>(time.seconds().count()));
  return {text.data(), static_cast<std::size_t>(size)};
}

std::string own_program() {
  std::error_code failed;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", failed);
  return failed ? "segue-deployment" : program.string();
}

}  // namespace

InheritedProcess::InheritedProcess()
    : listener_(take(kListener)), lock_(take(kLock)), output_changes_(take(kOutputChanges)) {
  ::fcntl(kAssignment, F_SETFD, FD_CLOEXEC);
  const sigset_t signals = end_signals();
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  signals_ = Descriptor(::signalfd(-1, &signals, SFD_CLOEXEC | SFD_NONBLOCK));
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
  // A write beyond the limit of file sizes shall fail instead of ending the robot.
  std::signal(SIGXFSZ, SIG_IGN);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
}

void InheritedProcess::begin(const std::filesystem::path& socket, std::string_view software) {
  socket_ = socket;
  const std::string title = socket.parent_path().filename().string() + '/' + socket.stem().string();
  std::fprintf(stderr, "---- %s %s starts: pid %d, %s (segue %s)\n", time_now().c_str(), title.c_str(),
               ::getpid(), own_program().c_str(), std::string(software).c_str());
  if (!write_record(lock_.get(), {::getpid(), std::string(software)})) {
    log(LogLevel::Error, "segue-deployment",
        "cannot write its lock file, so no other process server will find this process");
  }
  ::close(kAssignment);
}

bool InheritedProcess::wait_for_end(Duration most, int readable) {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(most);
  const timespec limit{seconds.count(), (most - seconds).count()};
  std::array<pollfd, 2> waited{pollfd{signals_.get(), POLLIN, 0}, pollfd{readable, POLLIN, 0}};
  if (::ppoll(waited.data(), waited.size(), &limit, nullptr) <= 0) return false;
  signalfd_siginfo asked{};
  return ::read(signals_.get(), &asked, sizeof asked) == sizeof asked;
}

void InheritedProcess::leave() {
  // These files are this process's own as long as it holds the lock.
  if (socket_.empty() || !lock_.valid()) return;
  ::unlink(socket_.c_str());
  ::unlink(lock_of(socket_).c_str());
}

}  // namespace segue::process_server
