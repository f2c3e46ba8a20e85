// SPDX-License-Identifier: Apache-2.0
#include <segue/deploy/event_queue.hpp>

#include <segue/base/log.hpp>

#include <exception>
#include <string>

namespace segue::deploy::detail {

namespace {

/// What is kept while nobody listens.
constexpr std::size_t kKept = 500;

}  // namespace

void EventQueue::set_listener(host::TaskHost::Listener listener) {
  const std::lock_guard setting(setting_);
  halt();
  if (!listener) {
    return;
  }
  const std::lock_guard lock(mutex_);
  listener_ = std::move(listener);
  running_ = true;
  thread_ = std::thread([this] { run(); });
}

void EventQueue::halt() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
  }
  changed_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void EventQueue::push(host::HostEvent event) {
  {
    const std::lock_guard lock(mutex_);
    waiting_.push_back(std::move(event));
    ++pushed_;
    if (!running_ && waiting_.size() > kKept) {
      waiting_.pop_front();
      ++told_;
    }
  }
  changed_.notify_all();
}

void EventQueue::drain() {
  std::unique_lock lock(mutex_);
  const std::uint64_t last = pushed_;
  changed_.wait(lock, [&] { return !running_ || told_ >= last; });
}

void EventQueue::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !running_ || !waiting_.empty(); });
    if (!running_) {
      return;
    }
    const host::HostEvent event = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    try {
      listener_(event);
    } catch (const std::exception& exception) {
      log(LogLevel::Error, "deploy", std::string("a listener for events threw: ") + exception.what());
    }
    lock.lock();
    ++told_;
    changed_.notify_all();
  }
}

}  // namespace segue::deploy::detail
