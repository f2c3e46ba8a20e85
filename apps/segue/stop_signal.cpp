// SPDX-License-Identifier: Apache-2.0
#include "stop_signal.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdint>

namespace segue::cli {

namespace {

constexpr int kEndedBySignal = 130;
/// A process group often gets the same signal twice at once; only a later signal counts as the second.
constexpr auto kSameRequest = std::chrono::milliseconds(200);

/// Takes what there is to read; whether that was the end.
bool has_ended(int input) {
  std::array<char, 4096> ignored{};
  return ::read(input, ignored.data(), ignored.size()) <= 0;
}

sigset_t stop_signals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  return signals;
}

}  // namespace

StopSignal::StopSignal(int input) : wake_(::eventfd(0, EFD_CLOEXEC)) {
  const sigset_t signals = stop_signals();
  pthread_sigmask(SIG_BLOCK, &signals, &before_);
  thread_ = std::thread([this, input] { listen(input); });
}

StopSignal::~StopSignal() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_, &one, sizeof one);
  thread_.join();
  ::close(wake_);
  if (signalled_) return;
  const sigset_t signals = stop_signals();
  const timespec at_once{};
  while (::sigtimedwait(&signals, nullptr, &at_once) > 0) {
  }
  pthread_sigmask(SIG_SETMASK, &before_, nullptr);
}

void StopSignal::listen(int input) {
  const sigset_t signals = stop_signals();
  const int descriptor = ::signalfd(-1, &signals, SFD_CLOEXEC);
  std::optional<TimePoint> first;
  std::array<pollfd, 3> waited = {{{descriptor, POLLIN, 0}, {wake_, POLLIN, 0}, {input, POLLIN, 0}}};
  for (;;) {
    if (::poll(waited.data(), waited.size(), -1) < 0) continue;
    if (waited[1].revents != 0) break;
    if (waited[2].revents != 0 && has_ended(input)) {
      waited[2].fd = -1;
      request("the input has ended");
    }
    if (waited[0].revents == 0) continue;
    signalfd_siginfo signal{};
    if (::read(descriptor, &signal, sizeof signal) != sizeof signal) continue;
    const TimePoint now = RealClock::instance().now();
    if (requested() && now - first.value_or(now) > kSameRequest) ::_exit(kEndedBySignal);
    if (!first) first = now;
    signalled_ = true;
    request(signal.ssi_signo == SIGINT ? "interrupted" : "terminated");
  }
  ::close(descriptor);
}

void StopSignal::request(const std::string& reason) {
  {
    const Lock lock(mutex_);
    if (!reason_) reason_ = reason;
    changed_.notify_all();
  }
  stop_.request_stop();  // its callbacks may take locks of their own
}

bool StopSignal::requested() {
  const Lock lock(mutex_);
  return reason_.has_value();
}

std::optional<std::string> StopSignal::wait(std::optional<TimePoint> deadline) {
  Lock lock(mutex_);
  const auto stopped = [this]() SEGUE_REQUIRES(mutex_) { return reason_.has_value(); };
  if (deadline) {
    changed_.wait_until(mutex_, *deadline, stopped);
  } else {
    changed_.wait(mutex_, stopped);
  }
  return reason_;
}

}  // namespace segue::cli
