// SPDX-License-Identifier: Apache-2.0
#include <segue/host/notifier.hpp>

#include <segue/base/log.hpp>

#include <exception>

namespace segue::host::detail {

Notifier::~Notifier() {
  halt();
}

void Notifier::set_listener(TaskHost::Listener listener) {
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

void Notifier::halt() {
  {
    const std::lock_guard lock(mutex_);
    running_ = false;
    waiting_.clear();
  }
  changed_.notify_all();
  if (thread_.joinable()) {
    thread_.join();
  }
}

void Notifier::post(Make make) {
  {
    const std::lock_guard lock(mutex_);
    if (!running_) {
      return;
    }
    waiting_.push_back(std::move(make));
  }
  changed_.notify_all();
}

void Notifier::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return !running_ || !waiting_.empty(); });
    if (!running_) {
      return;
    }
    const Make make = std::move(waiting_.front());
    waiting_.pop_front();
    lock.unlock();
    try {
      if (const auto event = make()) {
        listener_(*event);
      }
    } catch (const std::exception& exception) {
      log(LogLevel::Error, "host", std::string("a listener for task events threw: ") + exception.what());
    }
    lock.lock();
  }
}

}  // namespace segue::host::detail
