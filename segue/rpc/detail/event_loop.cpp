// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/rpc/detail/event_loop.hpp>

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <optional>
#include <system_error>
#include <utility>

namespace segue::control::detail {

kj::Duration to_kj(Duration duration) {
  constexpr Duration kLongest = std::chrono::hours(24 * 30);
  return std::clamp(duration, Duration(0), kLongest).count() * kj::NANOSECONDS;
}

namespace {

void run_guarded(const EventLoop::Work& work, kj::AsyncIoContext& io) {
  try {
    work(io);
  } catch (const kj::Exception& exception) {
    log(LogLevel::Error, "control", exception.getDescription().cStr());
  } catch (const std::exception& exception) {
    log(LogLevel::Error, "control", exception.what());
  }
}

/// Lets the events that a piece of work has caused, such as sending an answer, happen before the next piece,
/// which may look for them or destroy what they use.
void settle(kj::AsyncIoContext& io) {
  run_guarded([](kj::AsyncIoContext& context) { kj::evalLast([] {}).wait(context.waitScope); }, io);
}

/// One thread at a time: at its first use in a program, kj fills global tables.
kj::AsyncIoContext set_up() {
  static Mutex one_at_a_time;
  const Lock lock(one_at_a_time);
  return kj::setupAsyncIo();
}

}  // namespace

EventLoop::EventLoop() : event_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (event_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  const auto ready = std::make_shared<std::promise<void>>();
  auto started = ready->get_future();
  try {
    thread_ = concurrent::start_thread("segue-loop", [this, ready] { main(*ready); });
    started.get();
  } catch (...) {
    if (thread_.joinable()) thread_.join();
    ::close(event_);
    throw;
  }
}

EventLoop::~EventLoop() {
  stop();
  thread_.join();
  ::close(event_);
}

bool EventLoop::post(Work work) {
  {
    const Lock lock(mutex_);
    if (stopped_) return false;
    queue_.push_back(std::move(work));
  }
  wake();
  return true;
}

bool EventLoop::run(const Work& work) {
  // Shared, since the waiting thread may return before set_value() does.
  const auto done = std::make_shared<std::promise<void>>();
  auto future = done->get_future();
  const bool posted = post([&work, done](kj::AsyncIoContext& io) {
    run_guarded(work, io);
    done->set_value();
  });
  if (posted) future.wait();
  return posted;
}

void EventLoop::stop() {
  {
    const Lock lock(mutex_);
    stopped_ = true;
  }
  wake();
}

void EventLoop::wake() const {
  const std::uint64_t one = 1;
  // Fails only where the counter would overflow, and then the loop is awake anyway.
  [[maybe_unused]] const auto written = ::write(event_, &one, sizeof one);
}

void EventLoop::main(std::promise<void>& ready) {
  std::optional<kj::AsyncIoContext> io;
  try {
    io.emplace(set_up());
    timer_ = &io->provider->getTimer();
  } catch (...) {
    ready.set_exception(std::make_exception_ptr(
        std::system_error(std::make_error_code(std::errc::too_many_files_open), "event loop")));
    return;
  }
  ready.set_value();
  serve(*io);
}

void EventLoop::serve(kj::AsyncIoContext& io) {
  auto events = io.lowLevelProvider->wrapInputFd(event_, kj::LowLevelAsyncIoProvider::ALREADY_NONBLOCK);
  while (drain(io)) {
    try {
      std::uint64_t count = 0;
      events->read(&count, sizeof count).wait(io.waitScope);
    } catch (const kj::Exception& exception) {
      log(LogLevel::Error, "control", exception.getDescription().cStr());
    }
  }
}

/// Runs the queued work; false after stop().
bool EventLoop::drain(kj::AsyncIoContext& io) {
  for (;;) {
    std::vector<Work> batch;
    {
      const Lock lock(mutex_);
      if (queue_.empty()) return !stopped_;
      batch.swap(queue_);
    }
    for (Work& work : batch) {
      run_guarded(std::exchange(work, nullptr), io);  // what it holds is destroyed before the next begins
      settle(io);
    }
  }
}

}  // namespace segue::control::detail
