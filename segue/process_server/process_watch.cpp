// SPDX-License-Identifier: Apache-2.0
#include <segue/base/error.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/process_server/process_watch.hpp>

#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <array>
#include <cerrno>

namespace segue::process_server::detail {

namespace {

constexpr std::uint64_t kWake = 0;

bool watch(int epoll, int descriptor, std::uint64_t id) {
  epoll_event event{};
  event.events = EPOLLIN;
  event.data.u64 = id;
  return ::epoll_ctl(epoll, EPOLL_CTL_ADD, descriptor, &event) == 0;
}

}  // namespace

Result<std::unique_ptr<ProcessWatch>> ProcessWatch::create(Ended ended) {
  Descriptor epoll(::epoll_create1(EPOLL_CLOEXEC));
  Descriptor wake(::eventfd(0, EFD_CLOEXEC));
  if (!epoll.valid() || !wake.valid() || !watch(epoll.get(), wake.get(), kWake)) {
    return system_error("cannot watch processes", errno);
  }
  return std::unique_ptr<ProcessWatch>(new ProcessWatch(std::move(epoll), std::move(wake), std::move(ended)));
}

ProcessWatch::ProcessWatch(Descriptor epoll, Descriptor wake, Ended ended)
    : epoll_(std::move(epoll)), wake_(std::move(wake)), ended_(std::move(ended)) {
  thread_ = concurrent::start_thread("segue-processes", [this] { run(); });
}

ProcessWatch::~ProcessWatch() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto written = ::write(wake_.get(), &one, sizeof one);
  thread_.join();
}

Result<void> ProcessWatch::add(int pidfd, std::uint64_t id) {
  if (!watch(epoll_.get(), pidfd, id)) return system_error("cannot watch a process", errno);
  return {};
}

void ProcessWatch::remove(int pidfd) {
  ::epoll_ctl(epoll_.get(), EPOLL_CTL_DEL, pidfd, nullptr);
}

void ProcessWatch::run() {
  std::array<epoll_event, 16> events{};
  for (;;) {
    const int count = ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), -1);
    for (int i = 0; i < count; ++i) {
      const std::uint64_t id = events[static_cast<std::size_t>(i)].data.u64;
      if (id == kWake) return;
      ended_(id);
    }
  }
}

}  // namespace segue::process_server::detail
