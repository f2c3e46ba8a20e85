// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/concurrent/alarm.hpp>

#include <memory>
#include <thread>
#include <vector>

namespace segue::concurrent {

/// Looks after work in progress when it is due, on a thread of its own, which starts with the first entry.
/// Adding and removing entries wakes no thread, so that work that ends in time costs no hand-over. All
/// functions may be called from any thread.
class DeadlineWatch {
 public:
  class Entry {
   public:
    virtual ~Entry() = default;
    /// Called when it is due. Returns when it is due next; TimePoint::max() removes it. May call add() and
    /// remove(); must not block.
    virtual TimePoint on_due(TimePoint now) = 0;
  };
  using EntryPtr = std::shared_ptr<Entry>;

  DeadlineWatch() = default;
  DeadlineWatch(const DeadlineWatch&) = delete;
  DeadlineWatch& operator=(const DeadlineWatch&) = delete;
  /// close().
  ~DeadlineWatch() { close(); }

  void add(EntryPtr entry, TimePoint due);
  /// A call of on_due() that has begun may still be in progress afterwards.
  void remove(const EntryPtr& entry);
  /// No entry is called any more when it returns. Must not be called by an entry.
  void close();

 private:
  struct Item {
    EntryPtr entry;
    TimePoint due;
  };
  void watch();
  /// The alarm has gone off: those whose time has come.
  std::vector<EntryPtr> due_at(TimePoint time);
  void set_alarm() SEGUE_REQUIRES(mutex_);

  Mutex mutex_;  ///< protects what names it
  std::vector<Item> items_ SEGUE_GUARDED_BY(mutex_);
  bool closed_ SEGUE_GUARDED_BY(mutex_) = false;
  Alarm alarm_;  ///< is set under the mutex; the thread waits without it
  std::thread thread_;
};

}  // namespace segue::concurrent
