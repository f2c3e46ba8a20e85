// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/time_slice.hpp>
#include <segue/task/doorbell.hpp>
#include <segue/task/run_queue.hpp>
#include <segue/task/thread_executor.hpp>
#include <segue/task/thread_start.hpp>
#include <segue/task/wake_batch.hpp>

#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <optional>
#include <span>

namespace segue::task {

namespace {

constexpr std::uint32_t kAwake = 0;
constexpr std::uint32_t kInFutex = 1;
constexpr std::uint32_t kInPoll = 2;
constexpr std::uint32_t kInDoorbell = 3;  ///< a futex that other processes can wake

/// The number of jobs in a row after which descriptors are polled even though jobs are ready.
constexpr int kJobsBetweenPolls = 32;

/// The number of looks at memory after which a thread that spins reads the clock (and polls descriptors).
constexpr int kLooksBetweenReadings = 16;

/// Tells the processor that this is a loop that waits, so that a sibling of its core gets on faster.
void relax() noexcept {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

timespec to_timespec(Duration duration) {
  const auto count = std::max(duration, Duration::zero()).count();
  return {static_cast<time_t>(count / 1'000'000'000), static_cast<long>(count % 1'000'000'000)};
}

/// epoll_pwait2(), which some computers of robots have a kernel without (before Linux 5.11): there in two
/// calls.
int wait_for_events(int poller, std::span<epoll_event> events, const timespec* timeout) noexcept {
  const int most = static_cast<int>(events.size());
  const int count = epoll_pwait2(poller, events.data(), most, timeout, nullptr);
  if (count >= 0 || errno != ENOSYS) return count;
  pollfd any{poller, POLLIN, 0};
  return ppoll(&any, 1, timeout, nullptr) > 0 ? epoll_wait(poller, events.data(), most, 0) : 0;
}

}  // namespace

/// Shared with the thread, so that an executor may be destroyed from inside one of its own jobs.
///
/// Memory order:
/// - E1, the wake-up: the thread stores `sleeping` and then checks for posted jobs, stop, changes of how to
///   wait, and rings; a waker changes one of these and then loads `sleeping`. All are sequentially
///   consistent, so either the thread stays awake or the waker sees that it must wake it. The waker's
///   exchange to kAwake makes sure that one of several wakes, and changes the futex word, so a thread that is
///   about to sleep does not. Back to kAwake is relaxed: a waker that misses it wakes a thread that is awake.
/// - E2: `polls` releases the descriptors, `doorbell` releases the doorbell; the thread acquires both. A
///   waker sees them, too: the thread has acquired them before it stores in `sleeping` that it waits in that
///   way.
/// - `busy_before` and `awake_since` are relaxed, since they are figures for people: a reading while the
///   thread falls asleep or wakes up may count its last time awake twice or not at all.
struct ThreadExecutor::State {
  ~State() {
    if (poll_descriptor >= 0) close(poll_descriptor);
    if (wake_descriptor >= 0) close(wake_descriptor);
  }

  void wake() noexcept;
  void loop() noexcept;
  void answer(Doorbell& ringing) noexcept;
  [[nodiscard]] bool has_work() const noexcept;
  bool spin(TimePoint& now) noexcept;
  void sleep(TimePoint& now) noexcept;
  void sleep_in_poll(TimePoint now, TimePoint until) noexcept;
  void collect_events(const timespec* timeout, TimePoint now) noexcept;
  void sleep_in_futex(Doorbell* ringing, TimePoint until) noexcept;
  void note_sleep(TimePoint begin) noexcept;
  Result<void> prepare_poll(const std::shared_ptr<State>& self);
  Result<void> open_poll();
  Result<void> start_bridge(const std::shared_ptr<State>& self);
  static void* main(void* argument);
  static void* bridge_main(void* argument);

  detail::RunQueue queue;
  TimePoint now{};  ///< used by the thread only, for jobs that trigger each other
  alignas(64) std::atomic<std::uint32_t> sleeping{kAwake};
  std::atomic<bool> stop{false};
  std::atomic<bool> polls{false};            ///< the thread must wait for descriptors, too
  std::atomic<std::int64_t> busy_before{0};  ///< nanoseconds awake up to the last sleep
  std::atomic<std::int64_t> awake_since{0};  ///< 0 while asleep
  std::atomic<Doorbell*> doorbell{nullptr};  ///< set once
  Mutex descriptors_mutex;  ///< for setting the members below, once each; then the thread is told
  int poll_descriptor = -1;
  int wake_descriptor = -1;
  std::shared_ptr<Doorbell> owned_doorbell;
  /// Helper thread that passes rings on while this one waits for descriptors.
  std::optional<pthread_t> bridge;
  std::string name;
  Activity activity;
  pthread_t thread{};
};

namespace {
/// The executor that runs on this thread. Reached without a call, since every trigger looks at it.
[[gnu::tls_model("initial-exec")]] thread_local const void* current_executor = nullptr;
}  // namespace

Result<std::shared_ptr<ThreadExecutor>> ThreadExecutor::create(const std::string& name,
                                                               const Activity& activity) {
  auto state = std::make_shared<State>();
  state->name = name;
  state->activity = activity;
  std::shared_ptr<ThreadExecutor> executor(new ThreadExecutor(state));
  auto argument = std::make_unique<std::shared_ptr<State>>(state);
  state->awake_since.store(monotonic_now().time_since_epoch().count(), std::memory_order_relaxed);
  auto started = detail::start_thread(name, activity, &State::main, argument.get());
  if (!started) {
    executor->state_.reset();
    return std::move(started.error());
  }
  static_cast<void>(argument.release());  // owned by the thread now
  state->thread = started->thread;
  executor->granted_ = started->scheduler_granted;
  return executor;
}

ThreadExecutor::~ThreadExecutor() {
  if (!state_) return;
  const pthread_t thread = state_->thread;
  state_->stop.store(true, std::memory_order_seq_cst);  // E1: before wake() loads `sleeping`
  if (state_->bridge) {
    state_->owned_doorbell->ring_through();
    pthread_join(*state_->bridge, nullptr);
  }
  if (is_current()) {
    pthread_detach(thread);
    return;
  }
  state_->wake();
  pthread_join(thread, nullptr);
}

void* ThreadExecutor::State::main(void* argument) {
  const std::unique_ptr<std::shared_ptr<State>> state(static_cast<std::shared_ptr<State>*>(argument));
  current_executor = state->get();
  prctl(PR_SET_TIMERSLACK, 1UL);  // wake at the time asked for, not up to 50 us later
  ask_for_short_time_slices();
  (*state)->loop();
  current_executor = nullptr;
  return nullptr;
}

bool ThreadExecutor::is_current() const noexcept {
  return current_executor == state_.get();
}

[[gnu::hot]] void ThreadExecutor::trigger(Job& job, Job::Reason reason) noexcept {
  State& state = *state_;
  if (current_executor == &state) {
    state.queue.post_here(job, reason, state.now);
  } else if (state.queue.post(job, reason, clock().now())) {
    detail::WakeBatch::add([](void* sleeper) noexcept { static_cast<State*>(sleeper)->wake(); }, &state);
  }
}

[[gnu::hot]] void ThreadExecutor::State::wake() noexcept {
  if (sleeping.load(std::memory_order_seq_cst) == kAwake) return;  // E1: after the reason to wake
  const std::uint32_t how = sleeping.exchange(kAwake, std::memory_order_seq_cst);
  if (how == kInFutex) detail::futex_wake(sleeping, 1);
  if (how == kInPoll) eventfd_write(wake_descriptor, 1);
  if (how == kInDoorbell) doorbell.load(std::memory_order_acquire)->wake();  // E2
}

[[gnu::hot]] void ThreadExecutor::State::loop() noexcept {
  now = monotonic_now();
  int jobs_since_poll = 0;
  while (!stop.load(std::memory_order_relaxed)) {
    if (queue.next_due() <= now) queue.fire(now);
    Doorbell* const ringing = doorbell.load(std::memory_order_acquire);  // pairs with E2
    if (ringing != nullptr && ringing->rung()) answer(*ringing);
    if (!queue.run_one(now)) {
      jobs_since_poll = 0;
      if (!spin(now)) sleep(now);
    } else if (++jobs_since_poll >= kJobsBetweenPolls) {
      jobs_since_poll = 0;
      const timespec at_once{};
      if (polls.load(std::memory_order_acquire)) collect_events(&at_once, now);  // pairs with E2
    }
  }
}

/// Jobs that are triggered by it have been wanted since the ring.
[[gnu::hot]] void ThreadExecutor::State::answer(Doorbell& ringing) noexcept {
  const TimePoint present = now;
  now = ringing.rung_since(present);
  ringing.answer();
  now = present;
}

[[gnu::hot]] bool ThreadExecutor::State::has_work() const noexcept {
  const Doorbell* const ringing = doorbell.load(std::memory_order_acquire);  // pairs with E2
  return queue.has_posted() || (ringing != nullptr && ringing->rung()) ||
         stop.load(std::memory_order_seq_cst);
}

/// Looks for work for as long as the activity says. True: there may be some. Nobody needs to wake the thread
/// meanwhile, since `sleeping` says that it is awake.
[[gnu::hot]] bool ThreadExecutor::State::spin(TimePoint& time) noexcept {
  if (activity.spin == Duration::zero()) return false;
  const TimePoint until = std::min(time + activity.spin, queue.next_due());
  while (time < until) {
    for (int looks = 0; looks < kLooksBetweenReadings && !has_work(); ++looks)
      relax();
    time = monotonic_now();
    const timespec at_once{};
    if (polls.load(std::memory_order_acquire)) collect_events(&at_once, time);  // pairs with E2
    if (has_work() || queue.has_ready()) return true;
  }
  return queue.next_due() <= time;
}

[[gnu::hot]] void ThreadExecutor::State::sleep(TimePoint& time) noexcept {
  const TimePoint until = queue.next_due();
  const bool in_poll = polls.load(std::memory_order_acquire);          // pairs with E2
  Doorbell* const ringing = doorbell.load(std::memory_order_acquire);  // pairs with E2
  if (ringing != nullptr) ringing->set_sleep(in_poll ? Doorbell::Sleep::InPoll : Doorbell::Sleep::InFutex);
  const std::uint32_t how = in_poll ? kInPoll : ringing == nullptr ? kInFutex : kInDoorbell;
  // E1: before the reasons to stay awake are loaded, which all follow.
  sleeping.store(how, std::memory_order_seq_cst);
  const bool changed =
      polls.load(std::memory_order_seq_cst) != in_poll || doorbell.load(std::memory_order_seq_cst) != ringing;
  const bool rung = ringing != nullptr && ringing->rung();
  const bool stays = queue.has_posted() || stop.load(std::memory_order_seq_cst) || changed || rung;
  if (!stays) {
    note_sleep(time);
    if (in_poll) {
      sleep_in_poll(time, until);
    } else {
      sleep_in_futex(ringing, until);
    }
  }
  sleeping.store(kAwake, std::memory_order_relaxed);  // E1
  if (ringing != nullptr) ringing->set_sleep(Doorbell::Sleep::Awake);
  time = monotonic_now();
  if (stays) return;
  awake_since.store(time.time_since_epoch().count(), std::memory_order_relaxed);
}

[[gnu::hot]] void ThreadExecutor::State::note_sleep(TimePoint begin) noexcept {
  const std::int64_t awake = begin.time_since_epoch().count() - awake_since.load(std::memory_order_relaxed);
  busy_before.store(busy_before.load(std::memory_order_relaxed) + std::max<std::int64_t>(awake, 0),
                    std::memory_order_relaxed);
  awake_since.store(0, std::memory_order_relaxed);
}

[[gnu::hot]] void ThreadExecutor::State::sleep_in_futex(Doorbell* ringing, TimePoint until) noexcept {
  if (ringing == nullptr) {
    detail::futex_wait(sleeping, kInFutex, until);
  } else {
    ringing->wait(until);
  }
}

void ThreadExecutor::State::sleep_in_poll(TimePoint time, TimePoint until) noexcept {
  if (until == detail::kNever) return collect_events(nullptr, time);
  const timespec timeout = to_timespec(until - monotonic_now());
  collect_events(&timeout, time);
}

void ThreadExecutor::State::collect_events(const timespec* timeout, TimePoint time) noexcept {
  std::array<epoll_event, 16> events{};
  const int count = wait_for_events(poll_descriptor, events, timeout);
  if (count > 0) time = monotonic_now();
  for (int i = 0; i < count; ++i) {
    void* job = events[static_cast<std::size_t>(i)].data.ptr;
    if (job == nullptr) {
      eventfd_t ignored = 0;
      eventfd_read(wake_descriptor, &ignored);
    } else {
      queue.post_here(*static_cast<Job*>(job), Job::kDescriptor, time);
    }
  }
}

void ThreadExecutor::remove(Job& job) {
  if (is_current()) {
    state_->queue.forget(job);
  } else {
    if (state_->queue.post_retire(job)) state_->wake();
    detail::RunQueue::wait_retired(job);
  }
}

Result<void> ThreadExecutor::State::open_poll() {
  Descriptor poller(epoll_create1(EPOLL_CLOEXEC));
  Descriptor waker(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  epoll_event event{};
  event.events = EPOLLIN;
  if (!poller.valid() || !waker.valid() || epoll_ctl(poller.get(), EPOLL_CTL_ADD, waker.get(), &event) != 0) {
    return fail(ErrorCode::ResourceExhausted,
                std::string("cannot wait for file descriptors: ") + std::strerror(errno));
  }
  poll_descriptor = poller.release();
  wake_descriptor = waker.release();
  return {};
}

Result<void> ThreadExecutor::State::prepare_poll(const std::shared_ptr<State>& self) {
  const Lock lock(descriptors_mutex);
  if (polls.load(std::memory_order_relaxed)) return {};
  if (poll_descriptor < 0) {
    if (auto opened = open_poll(); !opened) return opened;
  }
  if (owned_doorbell) {
    if (auto started = start_bridge(self); !started) return started;
  }
  polls.store(true, std::memory_order_seq_cst);  // E1, E2
  wake();
  return {};
}

Result<void> ThreadExecutor::State::start_bridge(const std::shared_ptr<State>& self) {
  // With the same scheduler and priority, or rings would be delayed by other threads.
  auto argument = std::make_unique<std::shared_ptr<State>>(self);
  auto started = detail::start_thread(name, activity, &State::bridge_main, argument.get());
  if (!started) return std::move(started.error());
  static_cast<void>(argument.release());
  bridge = started->thread;
  return {};
}

/// Needed because other processes cannot write to an eventfd of this one, and a futex cannot end epoll_wait.
void* ThreadExecutor::State::bridge_main(void* argument) {
  const std::unique_ptr<std::shared_ptr<State>> owner(static_cast<std::shared_ptr<State>*>(argument));
  State& state = **owner;
  const std::shared_ptr<Doorbell> doorbell = state.owned_doorbell;  // set before this thread was started
  while (!state.stop.load(std::memory_order_seq_cst)) {
    const std::uint32_t seen = doorbell->rings();  // D3: before the reasons, which follow
    if (state.stop.load(std::memory_order_seq_cst)) break;
    if (doorbell->rung()) state.wake();
    doorbell->wait_for_ring(seen);
  }
  return nullptr;
}

Result<std::shared_ptr<Doorbell>> ThreadExecutor::doorbell(const DoorbellMaker& make) {
  State& state = *state_;
  const Lock lock(state.descriptors_mutex);
  if (state.owned_doorbell) return state.owned_doorbell;
  auto made = check_doorbell(make());
  if (!made) return made;
  state.owned_doorbell = std::move(*made);
  if (state.polls.load(std::memory_order_relaxed)) {
    if (auto started = state.start_bridge(state_); !started) {
      state.owned_doorbell.reset();
      return std::move(started.error());
    }
  }
  state.doorbell.store(state.owned_doorbell.get(), std::memory_order_seq_cst);  // E1, E2
  state.wake();
  return state.owned_doorbell;
}

Result<void> ThreadExecutor::watch(Job& job, int descriptor) {
  if (auto prepared = state_->prepare_poll(state_); !prepared) return prepared;
  epoll_event event{};
  event.events = EPOLLIN | EPOLLRDHUP | EPOLLONESHOT;
  event.data.ptr = &job;
  if (epoll_ctl(state_->poll_descriptor, EPOLL_CTL_ADD, descriptor, &event) == 0) return {};
  return fail(ErrorCode::InvalidArgument, "cannot be driven by file descriptor " +
                                              std::to_string(descriptor) + ": " + std::strerror(errno));
}

void ThreadExecutor::rearm(Job& job, int descriptor) noexcept {
  epoll_event event{};
  event.events = EPOLLIN | EPOLLRDHUP | EPOLLONESHOT;
  event.data.ptr = &job;
  epoll_ctl(state_->poll_descriptor, EPOLL_CTL_MOD, descriptor, &event);
}

void ThreadExecutor::unwatch(int descriptor) noexcept {
  epoll_ctl(state_->poll_descriptor, EPOLL_CTL_DEL, descriptor, nullptr);
}

Executor::Usage ThreadExecutor::usage() const {
  Usage usage;
  clockid_t cpu_clock{};
  timespec used{};
  if (pthread_getcpuclockid(state_->thread, &cpu_clock) == 0 && clock_gettime(cpu_clock, &used) == 0) {
    usage.cpu = std::chrono::seconds(used.tv_sec) + Duration(used.tv_nsec);
  }
  usage.busy = Duration(state_->busy_before.load(std::memory_order_relaxed));
  const std::int64_t since = state_->awake_since.load(std::memory_order_relaxed);
  if (since != 0) usage.busy += monotonic_now().time_since_epoch() - Duration(since);
  return usage;
}

}  // namespace segue::task
