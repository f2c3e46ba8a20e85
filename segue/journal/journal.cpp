// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/journal/damaged.hpp>
#include <segue/journal/journal.hpp>
#include <segue/journal/store.hpp>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <iterator>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace segue::journal {

namespace {

using detail::Entry;
using detail::Store;

constexpr Duration kFirstAttempt = std::chrono::seconds(2);
constexpr Duration kShortestPause = std::chrono::seconds(1);
constexpr Duration kLongestPause = std::chrono::seconds(30);

/// What is there belongs to somebody else; only a person can change that.
bool is_refusal(const Error& error) {
  return error.code == ErrorCode::InvalidArgument || error.code == ErrorCode::Unsupported;
}

}  // namespace

/// The queue, and the thread that empties it into the file.
struct Journal::Implementation {
  Implementation(const std::filesystem::path& file, const JournalOptions& wanted, OnTrouble listener)
      : path(std::filesystem::absolute(file).lexically_normal()),
        options(wanted),
        on_trouble(std::move(listener)) {
    thread = std::thread([this] { work(); });
    std::unique_lock lock(mutex);
    changed.wait_until(lock, RealClock::instance().now() + kFirstAttempt,
                       [this] { return ended_attempt > 0; });
  }

  ~Implementation() {
    {
      const std::lock_guard lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    thread.join();
  }

  void add(Entry entry);
  Result<void> flush(TimePoint deadline);

  // The thread's.
  void work();
  void attempt(std::unique_lock<std::mutex>& lock);
  Result<void> write(std::vector<Entry>& entries, std::uint64_t gap, const std::string& reason);
  Result<void> open();
  void tell(Trouble::Kind kind, const std::string& message, std::uint64_t entries_lost = 0) const;

  // With the mutex.
  void shorten_queue();
  void put_back(std::vector<Entry> entries);
  /// How many of those added first are written or given up.
  [[nodiscard]] std::uint64_t settled() const { return writing ? writing_from : added - queue.size(); }
  [[nodiscard]] bool may_try() const {
    return (!queue.empty() || trouble) && (flushing > 0 || not_before <= RealClock::instance().now());
  }

  const std::filesystem::path path;
  const JournalOptions options;
  const OnTrouble on_trouble;

  mutable std::mutex mutex;  ///< guards all below but the store
  std::condition_variable changed;
  std::deque<Entry> queue;
  std::size_t weight = 0;  ///< of the queue
  std::uint64_t added = 0;
  std::uint64_t lost = 0;
  std::uint64_t unreported = 0;  ///< of those lost: since the file was last written
  bool writing = false;
  std::uint64_t writing_from = 0;   ///< how many were settled when writing began
  std::uint64_t begun_attempt = 0;  ///< attempts are numbered from 1
  std::uint64_t ended_attempt = 0;
  std::optional<Error> trouble;  ///< of the last attempt
  Duration pause = kShortestPause;
  TimePoint not_before{};
  int flushing = 0;
  bool stopping = false;
  std::shared_ptr<const model::ActionTimes> times = std::make_shared<model::ActionTimes>();

  std::optional<Store> store;  ///< the thread's
  std::thread thread;
};

void Journal::Implementation::add(Entry entry) {
  {
    const std::lock_guard lock(mutex);
    weight += detail::weight_of(entry);
    ++added;
    queue.push_back(std::move(entry));
    shorten_queue();
  }
  changed.notify_all();
}

/// The latest entry stays, whatever its size.
void Journal::Implementation::shorten_queue() {
  while (weight > options.queue && queue.size() > 1) {
    weight -= detail::weight_of(queue.front());
    queue.pop_front();
    ++lost;
    ++unreported;
  }
}

void Journal::Implementation::put_back(std::vector<Entry> entries) {
  for (const Entry& entry : entries)
    weight += detail::weight_of(entry);
  queue.insert(queue.begin(), std::make_move_iterator(entries.begin()),
               std::make_move_iterator(entries.end()));
  shorten_queue();
}

Result<void> Journal::Implementation::flush(TimePoint deadline) {
  std::unique_lock lock(mutex);
  const std::uint64_t wanted = added;
  const std::uint64_t own_attempt = begun_attempt + 1;  // the one under way may not have all of it
  ++flushing;
  changed.notify_all();
  const bool ended = changed.wait_until(lock, deadline, [&] {
    return (settled() >= wanted && !trouble) || (trouble && ended_attempt >= own_attempt);
  });
  --flushing;
  if (!ended) {
    return fail(ErrorCode::DeadlineExceeded, "the journal " + quote(path.native()) + " is not written yet");
  }
  return trouble ? Result<void>(*trouble) : Result<void>();
}

void Journal::Implementation::work() {
  std::unique_lock lock(mutex);
  attempt(lock);
  while (!stopping) {
    if (may_try()) {
      attempt(lock);
    } else if (queue.empty() && !trouble) {
      changed.wait(lock);
    } else {
      changed.wait_until(lock, not_before);
    }
  }
  if (!queue.empty()) attempt(lock);
}

/// Writes all that waits; lets go of the lock meanwhile.
void Journal::Implementation::attempt(std::unique_lock<std::mutex>& lock) {
  writing_from = settled();
  writing = true;
  const std::uint64_t number = ++begun_attempt;
  const std::uint64_t gap = unreported;
  const std::string reason = trouble ? trouble->message : "too much at once";
  std::vector<Entry> entries(std::make_move_iterator(queue.begin()), std::make_move_iterator(queue.end()));
  queue.clear();
  weight = 0;
  lock.unlock();
  auto result = write(entries, gap, reason);
  auto learnt = result ? std::make_shared<model::ActionTimes>(store->times()) : nullptr;
  lock.lock();
  writing = false;
  ended_attempt = number;
  const bool was_fine = !trouble;
  if (result) {
    times = std::move(learnt);
    unreported -= gap;
    trouble.reset();
    pause = kShortestPause;
    not_before = {};
  } else {
    put_back(std::move(entries));
    trouble = result.error();
    not_before = RealClock::instance().now() + pause;
    pause = std::min(2 * pause, kLongestPause);
  }
  changed.notify_all();
  if (was_fine == result.has_value()) return;
  lock.unlock();
  if (!result) {
    tell(is_refusal(result.error()) ? Trouble::Kind::Refused : Trouble::Kind::Unwritable,
         "the journal " + quote(path.native()) + " is not written: " + to_string(result.error()));
  } else {
    tell(Trouble::Kind::Resumed, "the journal " + quote(path.native()) + " is written again", gap);
  }
  lock.lock();
}

/// A file that failed is opened anew by the next attempt: it may be another one by then.
Result<void> Journal::Implementation::write(std::vector<Entry>& entries, std::uint64_t gap,
                                            const std::string& reason) {
  if (store && !store->is_in_place()) store.reset();
  if (!store) {
    if (auto opened = open(); !opened) return opened;
  }
  if (entries.empty() && gap == 0) return {};
  if (gap > 0) entries.emplace_back(GapEntry{std::chrono::system_clock::now(), gap, reason});
  auto done = store->write(entries);
  if (!done && done.error().code == ErrorCode::ParseError) {
    store.reset();
    done = open();
    if (done) done = store->write(entries);
  }
  if (gap > 0) entries.pop_back();
  if (!done) store.reset();
  return done;
}

Result<void> Journal::Implementation::open() {
  auto opened = Store::open(path, options.keep_actions);
  if (!opened && opened.error().code == ErrorCode::ParseError) {
    const auto name = detail::move_aside(path);
    if (!name) return name.error();
    tell(Trouble::Kind::Replaced, "the journal " + quote(path.native()) + " was damaged (" +
                                      opened.error().message + "): it is now " + quote(name->native()) +
                                      ", and a new one is begun");
    opened = Store::open(path, options.keep_actions);
  }
  if (!opened) return opened.error();
  store.emplace(std::move(*opened));
  return {};
}

void Journal::Implementation::tell(Trouble::Kind kind, const std::string& message,
                                   std::uint64_t entries_lost) const {
  if (on_trouble) on_trouble({kind, message, entries_lost});
}

Journal::Journal(const std::filesystem::path& path, const JournalOptions& options, OnTrouble on_trouble)
    : implementation_(std::make_unique<Implementation>(path, options, std::move(on_trouble))) {}

Journal::~Journal() = default;

const std::filesystem::path& Journal::path() const {
  return implementation_->path;
}

void Journal::add(TransitionEntry entry) {
  implementation_->add(std::move(entry));
}

void Journal::add(RequestEntry entry) {
  implementation_->add(std::move(entry));
}

void Journal::add(DifferenceEntry entry) {
  implementation_->add(std::move(entry));
}

std::shared_ptr<const model::ActionTimes> Journal::times() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->times;
}

Result<void> Journal::flush(TimePoint deadline) {
  return implementation_->flush(deadline);
}

std::uint64_t Journal::lost() const {
  const std::lock_guard lock(implementation_->mutex);
  return implementation_->lost;
}

}  // namespace segue::journal
