// SPDX-License-Identifier: Apache-2.0
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/journal/damaged.hpp>
#include <segue/journal/journal.hpp>
#include <segue/journal/store.hpp>

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <iterator>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

namespace segue::journal {

namespace {

using detail::AnyEntry;
using detail::Store;

constexpr Duration kFirstAttempt = std::chrono::seconds(2);
constexpr Duration kShortestPause = std::chrono::seconds(1);
constexpr Duration kLongestPause = std::chrono::seconds(30);

/// The file belongs to another program or a newer Segue; only the user can resolve that.
bool is_refusal(const Error& error) {
  return error.code == ErrorCode::InvalidArgument || error.code == ErrorCode::Unsupported;
}

/// A relative path in such a variable is to be ignored (XDG Base Directory Specification).
std::filesystem::path folder_in(const char* variable) {
  const char* value = std::getenv(variable);
  const std::filesystem::path folder = value == nullptr ? "" : value;
  return folder.is_absolute() ? folder : std::filesystem::path();
}

}  // namespace

Result<std::filesystem::path> default_path(std::string_view robot) {
  if (!is_identifier(robot))
    return fail(ErrorCode::InvalidArgument, quote(robot) + " is not a valid robot name");
  std::filesystem::path state = folder_in("XDG_STATE_HOME");
  if (state.empty()) {
    const auto home = folder_in("HOME");
    if (home.empty()) {
      return fail(ErrorCode::NotFound, "there is no place for the journal of " + quote(robot) +
                                           ": neither XDG_STATE_HOME nor HOME names a folder");
    }
    state = home / ".local" / "state";
  }
  return state / "segue" / robot / "journal.sqlite";
}

/// The queue, and the thread that writes it to the file. The mutex is not held while the file is accessed, so
/// a slow disk never blocks add().
struct Journal::Implementation {
  Implementation(const std::filesystem::path& file, const JournalOptions& wanted, OnTrouble listener)
      : path(std::filesystem::absolute(file).lexically_normal()),
        options(wanted),
        on_trouble(std::move(listener)) {
    thread = std::thread([this] { work(); });
    Lock lock(mutex);
    changed.wait_until(mutex, RealClock::instance().now() + kFirstAttempt,
                       [this]() SEGUE_REQUIRES(mutex) { return ended_attempt > 0; });
  }

  ~Implementation() {
    {
      const Lock lock(mutex);
      stopping = true;
    }
    changed.notify_all();
    thread.join();
  }

  void add(AnyEntry entry);
  Result<void> flush(TimePoint deadline);

  // Called by the writing thread only.
  void work();
  /// Writes all waiting entries, without the mutex meanwhile.
  void attempt() SEGUE_REQUIRES(mutex);
  Result<void> write(std::vector<AnyEntry>& entries, std::uint64_t gap, const std::string& reason);
  Result<void> open();
  void report(Trouble::Kind kind, const std::string& message, std::uint64_t entries_lost = 0) const;

  void shorten_queue() SEGUE_REQUIRES(mutex);
  void put_back(std::vector<AnyEntry> entries) SEGUE_REQUIRES(mutex);
  /// The number of entries, counted from the first one added, that are written or dropped.
  [[nodiscard]] std::uint64_t settled() const SEGUE_REQUIRES(mutex) {
    return writing ? writing_from : added - queue.size();
  }
  [[nodiscard]] bool may_try() const SEGUE_REQUIRES(mutex) {
    return (!queue.empty() || trouble) && (flushing > 0 || not_before <= RealClock::instance().now());
  }

  const std::filesystem::path path;
  const JournalOptions options;
  const OnTrouble on_trouble;

  mutable Mutex mutex;  ///< protects all members below except `store` and `thread`
  ConditionVariable changed;
  std::deque<AnyEntry> queue SEGUE_GUARDED_BY(mutex);
  std::size_t weight SEGUE_GUARDED_BY(mutex) = 0;  ///< of the queue
  std::uint64_t added SEGUE_GUARDED_BY(mutex) = 0;
  std::uint64_t lost SEGUE_GUARDED_BY(mutex) = 0;
  /// Dropped entries that are not in the file as a gap yet.
  std::uint64_t unreported SEGUE_GUARDED_BY(mutex) = 0;
  bool writing SEGUE_GUARDED_BY(mutex) = false;
  std::uint64_t writing_from SEGUE_GUARDED_BY(mutex) = 0;   ///< settled() when the current write began
  std::uint64_t begun_attempt SEGUE_GUARDED_BY(mutex) = 0;  ///< attempts are numbered from 1
  std::uint64_t ended_attempt SEGUE_GUARDED_BY(mutex) = 0;
  std::optional<Error> trouble SEGUE_GUARDED_BY(mutex);  ///< error of the last attempt
  Duration pause SEGUE_GUARDED_BY(mutex) = kShortestPause;
  TimePoint not_before SEGUE_GUARDED_BY(mutex){};
  int flushing SEGUE_GUARDED_BY(mutex) = 0;
  bool stopping SEGUE_GUARDED_BY(mutex) = false;
  std::shared_ptr<const model::ActionTimes> times SEGUE_GUARDED_BY(mutex) =
      std::make_shared<model::ActionTimes>();

  std::optional<Store> store;  ///< used by the writing thread only
  std::thread thread;
};

void Journal::Implementation::add(AnyEntry entry) {
  {
    const Lock lock(mutex);
    weight += detail::weight_of(entry);
    ++added;
    queue.push_back(std::move(entry));
    shorten_queue();
  }
  changed.notify_all();
}

/// The latest entry is kept, whatever its size.
void Journal::Implementation::shorten_queue() {
  while (weight > options.queue && queue.size() > 1) {
    weight -= detail::weight_of(queue.front());
    queue.pop_front();
    ++lost;
    ++unreported;
  }
}

void Journal::Implementation::put_back(std::vector<AnyEntry> entries) {
  for (const AnyEntry& entry : entries)
    weight += detail::weight_of(entry);
  queue.insert(queue.begin(), std::make_move_iterator(entries.begin()),
               std::make_move_iterator(entries.end()));
  shorten_queue();
}

Result<void> Journal::Implementation::flush(TimePoint deadline) {
  Lock lock(mutex);
  const std::uint64_t wanted = added;
  const std::uint64_t own_attempt = begun_attempt + 1;  // the present attempt may lack the latest entries
  ++flushing;
  changed.notify_all();
  const bool ended = changed.wait_until(mutex, deadline, [&]() SEGUE_REQUIRES(mutex) {
    return (settled() >= wanted && !trouble) || (trouble && ended_attempt >= own_attempt);
  });
  --flushing;
  if (!ended) {
    return fail(ErrorCode::DeadlineExceeded, "the journal " + quote(path.native()) + " is not written yet");
  }
  return trouble ? Result<void>(*trouble) : Result<void>();
}

void Journal::Implementation::work() {
  const Lock lock(mutex);
  attempt();
  while (!stopping) {
    if (may_try()) {
      attempt();
    } else if (queue.empty() && !trouble) {
      changed.wait(mutex);
    } else {
      changed.wait_until(mutex, not_before);
    }
  }
  if (!queue.empty()) attempt();
}

void Journal::Implementation::attempt() {
  writing_from = settled();
  writing = true;
  const std::uint64_t number = ++begun_attempt;
  const std::uint64_t gap = unreported;
  const std::string reason = trouble ? trouble->message : "too many entries at once";
  std::vector<AnyEntry> entries(std::make_move_iterator(queue.begin()), std::make_move_iterator(queue.end()));
  queue.clear();
  weight = 0;
  Result<void> result;
  std::shared_ptr<model::ActionTimes> statistics;
  {
    const Unlocked unlocked(mutex);
    result = write(entries, gap, reason);
    if (result) statistics = std::make_shared<model::ActionTimes>(store->times());
  }
  writing = false;
  ended_attempt = number;
  const bool was_fine = !trouble;
  if (result) {
    times = std::move(statistics);
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
  const Unlocked unlocked(mutex);
  if (!result) {
    report(is_refusal(result.error()) ? Trouble::Kind::Refused : Trouble::Kind::Unwritable,
           "the journal " + quote(path.native()) + " cannot be written: " + to_string(result.error()));
  } else {
    report(Trouble::Kind::Resumed, "the journal " + quote(path.native()) + " is written again", gap);
  }
}

/// After a failure the next attempt opens the file again, since it may have been replaced.
Result<void> Journal::Implementation::write(std::vector<AnyEntry>& entries, std::uint64_t gap,
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
  auto opened = Store::open(path, options);
  if (!opened && opened.error().code == ErrorCode::ParseError) {
    const auto name = detail::move_aside(path);
    if (!name) return name.error();
    report(Trouble::Kind::Replaced, "the journal " + quote(path.native()) + " was damaged (" +
                                        opened.error().message + "): it has been renamed to " +
                                        quote(name->native()) + ", and a new one is created");
    opened = Store::open(path, options);
  }
  if (!opened) return opened.error();
  store.emplace(std::move(*opened));
  return {};
}

void Journal::Implementation::report(Trouble::Kind kind, const std::string& message,
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

void Journal::add(VersionEntry entry) {
  implementation_->add(std::move(entry));
}

void Journal::add(MissionEntry entry) {
  implementation_->add(std::move(entry));
}

void Journal::add(RunningEntry entry) {
  implementation_->add(std::move(entry));
}

void Journal::add(GapEntry entry) {
  implementation_->add(std::move(entry));
}

std::shared_ptr<const model::ActionTimes> Journal::times() const {
  const Lock lock(implementation_->mutex);
  return implementation_->times;
}

Result<void> Journal::flush(Deadline deadline) {
  return implementation_->flush(deadline);
}

std::uint64_t Journal::lost() const {
  const Lock lock(implementation_->mutex);
  return implementation_->lost;
}

}  // namespace segue::journal
