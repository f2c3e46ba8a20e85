// SPDX-License-Identifier: Apache-2.0
#include <segue/host/crew.hpp>

#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/host/alarm.hpp>
#include <segue/host/batch_outcomes.hpp>

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <csignal>
#include <deque>
#include <mutex>
#include <system_error>
#include <thread>

namespace segue::host {

namespace {

/// Actions keep their deadlines by themselves, and say more about it; only one that does not is given up.
constexpr Duration kGrace = std::chrono::milliseconds(10);
constexpr std::size_t kMostThreads = 256;
constexpr std::size_t kMostIdle = 4;

TimePoint now() {
  return RealClock::instance().now();
}

TimePoint end_of(TimePoint deadline) {
  return deadline > TimePoint::max() - kGrace ? deadline : deadline + kGrace;
}

struct Batch {
  Batch(std::vector<model::Action> copies, TimePoint until, Completion completed)
      : owned(std::move(copies)),
        actions(owned),
        deadline(until),
        outcomes(actions.size(), std::move(completed)) {}
  Batch(std::span<const model::Action> lent, TimePoint until, Completion completed)
      : actions(lent), deadline(until), outcomes(actions.size(), std::move(completed)) {}

  [[nodiscard]] bool all_begun() const { return next.load() >= actions.size(); }

  const std::vector<model::Action> owned;
  const std::span<const model::Action> actions;
  const TimePoint deadline;
  BatchOutcomes outcomes;
  std::atomic<std::size_t> next{0};  ///< the first that nobody has begun
  std::atomic<bool> slow{false};     ///< one has held up others: what ends is told
  // The rest belongs to the crew's mutex.
  TimePoint due = TimePoint::max();  ///< when to look at it
  std::size_t seen = 0;              ///< how many had ended at the last look
  std::size_t workers = 0;           ///< threads at it, or called to it
  bool help_called = false;          ///< one of them has not come yet
};
using BatchPtr = std::shared_ptr<Batch>;

Error overdue(const model::Action& action, bool begun) {
  return fail(ErrorCode::DeadlineExceeded,
              begun ? "has not ended by its deadline; it may still be at work, so look at the true state"
                    : "was not begun by its deadline, since too many others are at work",
              action.label());
}

void refuse(Batch& batch, const Error& why) {
  batch.outcomes.fail_rest([&](std::size_t index) {
    Error error = why;
    error.subject = batch.actions[index].label();
    return error;
  });
}

/// Signals are for the main thread.
void block_signals() {
  sigset_t all;
  sigfillset(&all);
  for (const int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT}) {
    sigdelset(&all, fault);
  }
  ::pthread_sigmask(SIG_BLOCK, &all, nullptr);
}

}  // namespace

struct Crew::Implementation : std::enable_shared_from_this<Implementation> {
  Implementation(Work carry_out, Duration longest) : work(std::move(carry_out)), patience(longest) {}

  /// Where it fails, nothing of the batch is begun.
  Result<void> enter(const BatchPtr& batch, bool with_worker);
  void take_part(Batch& batch);
  void leave(const BatchPtr& batch);
  /// Until nothing of it is in use any more.
  void wait_for(const BatchPtr& batch);
  void close();

  // With the mutex held.
  /// False: there is no thread for it, nor will there be.
  bool call_worker(const BatchPtr& batch);
  bool add_thread();
  void set_alarm();

  void serve();
  void watch();
  /// False: it needs no looking at any more.
  bool look_at(const BatchPtr& batch);

  const Work work;
  const Duration patience;
  std::mutex mutex;
  std::condition_variable called;  ///< a job waits
  std::condition_variable left;    ///< a worker has left
  std::deque<BatchPtr> jobs;
  std::vector<BatchPtr> watched;
  std::size_t threads = 0;
  std::size_t idle = 0;
  bool is_closed = false;
  bool ended = false;
  detail::Alarm alarm;
  std::thread watcher;
};

Result<void> Crew::Implementation::enter(const BatchPtr& batch, bool with_worker) {
  const std::lock_guard lock(mutex);
  if (is_closed) {
    return fail(ErrorCode::Unavailable, "nothing is begun any more: this is going down");
  }
  if (!watcher.joinable() && alarm.works()) {
    watcher = std::thread([this] { watch(); });
  }
  if (!with_worker) {
    ++batch->workers;
  } else if (!call_worker(batch)) {
    return fail(ErrorCode::ResourceExhausted, "no thread can be made for it");
  }
  const TimePoint end = end_of(batch->deadline);
  // Where there is one action only, nobody is held up by it.
  batch->due = batch->actions.size() == 1 ? end : std::min(now() + patience, end);
  watched.push_back(batch);
  set_alarm();
  return {};
}

bool Crew::Implementation::call_worker(const BatchPtr& batch) {
  if (batch->help_called) {
    return true;
  }
  if (jobs.size() >= idle && !add_thread() && threads == 0) {
    return false;
  }
  batch->help_called = true;
  ++batch->workers;
  jobs.push_back(batch);
  called.notify_one();
  return true;
}

bool Crew::Implementation::add_thread() {
  if (threads >= kMostThreads) {
    return false;
  }
  try {
    std::thread([self = shared_from_this()] { self->serve(); }).detach();
    ++threads;
    return true;
  } catch (const std::system_error& error) {
    log(LogLevel::Error, "host", std::string("no thread to carry out actions: ") + error.what());
    return false;
  }
}

void Crew::Implementation::set_alarm() {
  TimePoint first = TimePoint::max();
  for (const auto& batch : watched) {
    first = std::min(first, batch->due);
  }
  alarm.set(first);
}

void Crew::Implementation::take_part(Batch& batch) {
  const auto carry_out = [&](const model::Action& action) -> Result<void> {
    try {
      return work(action, batch.deadline);
    } catch (const std::exception& exception) {
      return fail(ErrorCode::Internal, std::string("threw: ") + exception.what(), action.label());
    } catch (...) {
      return fail(ErrorCode::Internal, "threw", action.label());
    }
  };
  std::size_t index = 0;
  while ((index = batch.next.fetch_add(1)) < batch.actions.size()) {
    const TimePoint begin = now();
    auto outcome = carry_out(batch.actions[index]);
    batch.outcomes.note({index, std::move(outcome), now() - begin});
    if (batch.slow && batch.all_begun()) {
      batch.outcomes.tell();
    }
  }
}

void Crew::Implementation::leave(const BatchPtr& batch) {
  const std::lock_guard lock(mutex);
  --batch->workers;
  if (batch->outcomes.ended() == batch->actions.size() && std::erase(watched, batch) > 0) {
    set_alarm();
  }
  left.notify_all();
}

void Crew::Implementation::wait_for(const BatchPtr& batch) {
  batch->outcomes.wait();
  std::unique_lock lock(mutex);
  batch->workers -= std::erase(jobs, batch);
  left.wait(lock, [&] { return batch->workers == 0; });
}

void Crew::Implementation::serve() {
  block_signals();
  ::pthread_setname_np(::pthread_self(), "segue-crew");
  std::unique_lock lock(mutex);
  while (true) {
    if (jobs.empty() && (ended || idle >= kMostIdle)) {
      break;
    }
    if (jobs.empty()) {
      ++idle;
      left.notify_all();
      called.wait(lock, [&] { return ended || !jobs.empty(); });
      --idle;
      continue;
    }
    const BatchPtr batch = std::move(jobs.front());
    jobs.pop_front();
    batch->help_called = false;
    lock.unlock();
    take_part(*batch);
    leave(batch);
    lock.lock();
  }
  --threads;
  left.notify_all();
}

void Crew::Implementation::watch() {
  block_signals();
  ::pthread_setname_np(::pthread_self(), "segue-crew-due");
  while (alarm.wait()) {
    std::vector<BatchPtr> due;
    {
      const std::lock_guard lock(mutex);
      alarm.gone_off();
      const TimePoint time = now();
      std::copy_if(watched.begin(), watched.end(), std::back_inserter(due),
                   [&](const BatchPtr& batch) { return batch->due <= time; });
    }
    for (const auto& batch : due) {
      const bool more = look_at(batch);
      const std::lock_guard lock(mutex);
      if (!more) {
        std::erase(watched, batch);
      }
    }
    const std::lock_guard lock(mutex);
    set_alarm();
  }
}

bool Crew::Implementation::look_at(const BatchPtr& batch) {
  const std::size_t done = batch->outcomes.ended();
  if (done == batch->actions.size()) {
    return false;
  }
  const TimePoint end = end_of(batch->deadline);
  if (now() >= end) {
    const std::size_t begun = batch->next.exchange(batch->actions.size());
    batch->outcomes.fail_rest(
        [&](std::size_t index) { return overdue(batch->actions[index], index < begun); });
    return false;
  }
  const bool stuck = done == batch->seen;
  if (stuck) {
    batch->slow = true;
  }
  if (batch->slow) {
    batch->outcomes.tell();
  }
  const std::lock_guard lock(mutex);
  batch->seen = done;
  if (stuck && !batch->all_begun()) {
    static_cast<void>(call_worker(batch));  // else it goes on when one of those at it returns
  }
  batch->due = batch->slow && batch->all_begun() ? end : std::min(now() + patience, end);
  return true;
}

void Crew::Implementation::close() {
  {
    std::unique_lock lock(mutex);
    is_closed = true;
    left.wait(lock, [&] { return idle == threads && jobs.empty(); });
    ended = true;
    called.notify_all();
    left.wait(lock, [&] { return threads == 0; });
    alarm.stop();
  }
  if (watcher.joinable()) {
    watcher.join();
  }
}

Crew::Crew(Work work, Duration patience)
    : implementation_(std::make_shared<Implementation>(std::move(work), patience)) {}

Crew::~Crew() {
  close();
}

void Crew::begin(std::vector<model::Action> actions, TimePoint deadline, Completion completed) {
  if (actions.empty()) {
    return;
  }
  const auto batch = std::make_shared<Batch>(std::move(actions), deadline, std::move(completed));
  if (const auto entered = implementation_->enter(batch, true); !entered) {
    refuse(*batch, entered.error());
  }
}

void Crew::run(std::span<const model::Action> actions, TimePoint deadline, const Completion& completed) {
  if (actions.empty()) {
    return;
  }
  const auto batch = std::make_shared<Batch>(std::vector<model::Action>(actions.begin(), actions.end()),
                                             deadline, completed);
  if (const auto entered = implementation_->enter(batch, true); !entered) {
    return refuse(*batch, entered.error());
  }
  batch->outcomes.wait();
}

void Crew::run_here(std::span<const model::Action> actions, TimePoint deadline, const Completion& completed) {
  if (actions.empty()) {
    return;
  }
  const auto batch = std::make_shared<Batch>(actions, deadline, completed);
  if (const auto entered = implementation_->enter(batch, false); !entered) {
    return refuse(*batch, entered.error());
  }
  implementation_->take_part(*batch);
  implementation_->leave(batch);
  implementation_->wait_for(batch);
}

void Crew::close() {
  implementation_->close();
}

}  // namespace segue::host
