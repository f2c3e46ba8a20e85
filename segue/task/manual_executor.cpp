// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/task/doorbell.hpp>
#include <segue/task/manual_executor.hpp>
#include <segue/task/run_queue.hpp>

#include <poll.h>

#include <algorithm>
#include <atomic>
#include <vector>

namespace segue::task {

struct ManualExecutor::Implementation {
  struct Watched {
    Job* job;
    int descriptor;
    bool armed;
  };
  explicit Implementation(VirtualClock& time) : clock(time) {}
  void poll_descriptors();

  VirtualClock& clock;
  std::thread::id owner = std::this_thread::get_id();
  detail::RunQueue queue;
  std::vector<Watched> watched;
  Mutex doorbell_mutex;                  ///< guards doorbell
  std::shared_ptr<Doorbell> doorbell;    ///< set once
  std::atomic<Doorbell*> rung{nullptr};  // M1: released and acquired with what it points to
};

ManualExecutor::ManualExecutor(VirtualClock& clock)
    : implementation_(std::make_unique<Implementation>(clock)) {}
ManualExecutor::~ManualExecutor() = default;

void ManualExecutor::Implementation::poll_descriptors() {
  for (Watched& one : watched) {
    pollfd asked{one.descriptor, POLLIN, 0};
    if (!one.armed || poll(&asked, 1, 0) <= 0) continue;
    one.armed = false;
    queue.post_here(*one.job, Job::kDescriptor, clock.now());
  }
}

std::size_t ManualExecutor::run_ready(std::size_t limit) {
  std::size_t count = 0;
  while (count < limit) {
    TimePoint now = implementation_->clock.now();
    // Pairs with M1.
    if (Doorbell* doorbell = implementation_->rung.load(std::memory_order_acquire)) doorbell->answer();
    implementation_->poll_descriptors();
    implementation_->queue.fire(now);
    if (!implementation_->queue.run_one(now)) break;
    ++count;
  }
  return count;
}

void ManualExecutor::advance(Duration step) {
  const TimePoint end = implementation_->clock.now() + step;
  run_ready();
  while (implementation_->queue.next_due() <= end) {
    implementation_->clock.advance(
        std::max(implementation_->queue.next_due() - implementation_->clock.now(), Duration::zero()));
    run_ready();
  }
  implementation_->clock.advance(std::max(end - implementation_->clock.now(), Duration::zero()));
}

void ManualExecutor::trigger(Job& job, Job::Reason reason) noexcept {
  if (is_current()) {
    implementation_->queue.post_here(job, reason, implementation_->clock.now());
  } else {
    implementation_->queue.post(job, reason, implementation_->clock.now());
  }
}

void ManualExecutor::remove(Job& job) {
  std::erase_if(implementation_->watched, [&](const auto& one) { return one.job == &job; });
  implementation_->queue.forget(job);
}

Result<void> ManualExecutor::watch(Job& job, int descriptor) {
  implementation_->watched.push_back({&job, descriptor, true});
  return {};
}

void ManualExecutor::rearm(Job& job, int descriptor) noexcept {
  for (auto& one : implementation_->watched) {
    if (one.job == &job && one.descriptor == descriptor) one.armed = true;
  }
}

void ManualExecutor::unwatch(int descriptor) noexcept {
  std::erase_if(implementation_->watched, [&](const auto& one) { return one.descriptor == descriptor; });
}

Result<std::shared_ptr<Doorbell>> ManualExecutor::doorbell(const DoorbellMaker& make) {
  const Lock lock(implementation_->doorbell_mutex);
  if (!implementation_->doorbell) {
    auto made = check_doorbell(make());
    if (!made) return made;
    implementation_->doorbell = std::move(*made);
    // M1.
    implementation_->rung.store(implementation_->doorbell.get(), std::memory_order_release);
  }
  return implementation_->doorbell;
}

bool ManualExecutor::is_current() const noexcept {
  return std::this_thread::get_id() == implementation_->owner;
}

Clock& ManualExecutor::clock() noexcept {
  return implementation_->clock;
}

}  // namespace segue::task
