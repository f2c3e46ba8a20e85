// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/task/commit_gate.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace segue::task {

namespace detail {
/// Waits until `section` differs from `begin`. Yields and then sleeps, since the thread inside may need this
/// processor.
void wait_until_left(const std::atomic<std::uint64_t>& section, std::uint64_t begin) noexcept;
}  // namespace detail

/// When a connection carries samples, relative to the commit of a transition.
enum class Lifetime : std::uint8_t { Always, FromCommit, UntilCommit, Never };

/// The lifetime of a connection once it is known whether the transition has committed.
inline Lifetime settled(Lifetime lifetime, bool committed) {
  if (lifetime == Lifetime::FromCommit) return committed ? Lifetime::Always : Lifetime::Never;
  if (lifetime == Lifetime::UntilCommit) return committed ? Lifetime::Never : Lifetime::Always;
  return lifetime;
}

/// The connections of a port: read by one real-time thread at a time without ever waiting, changed by any
/// other. When a change returns, the reader has stopped using the previous list. Connections that begin or
/// end with a commit share one gate, which is looked at once per section: a sample goes either to those
/// before the commit or to those after it.
///
/// Memory order:
/// - L1: the reader stores section_ (odd) and then loads list_; a change exchanges list_ and then loads
///   section_. All four are sequentially consistent, so either the reader loads the new list or the change
///   sees it inside and waits.
/// - L2: leaving a section releases it and the change acquires it, so the old list is deleted after its last
///   use.
/// - list_ is relaxed under the mutex, and section_ where the reader loads its own count. Readers that are
///   different threads over time are ordered by their owner (a task's ownership).
template <class End>
class ConnectionList {
 public:
  /// A connection of the list.
  struct Entry {
    std::shared_ptr<End> end;
    Lifetime lifetime = Lifetime::Always;
  };

  ConnectionList() = default;
  ConnectionList(const ConnectionList&) = delete;
  ConnectionList& operator=(const ConnectionList&) = delete;
  ~ConnectionList() { delete list_.load(std::memory_order_relaxed); }

 private:
  struct List {
    std::vector<Entry> entries;
    CommitGatePtr gate;  ///< that of all entries FromCommit and UntilCommit; nullptr: there are none
    bool steady = true;  ///< all entries are Always
  };

 public:
  /// The reader's view, valid as long as this object lives. One at a time.
  class Section {
   public:
    explicit Section(ConnectionList& list) noexcept
        : section_(list.section_), count_(list.section_.load(std::memory_order_relaxed)) {
      section_.store(count_ + 1, std::memory_order_seq_cst);  // L1: before the load of list_
      list_ = list.list_.load(std::memory_order_seq_cst);     // L1: after the store of section_
      committed_ = list_ != nullptr && list_->gate != nullptr && list_->gate->open();
    }
    Section(const Section&) = delete;
    Section& operator=(const Section&) = delete;
    ~Section() { section_.store(count_ + 2, std::memory_order_release); }  // L2
    [[nodiscard]] std::size_t size() const noexcept { return list_ == nullptr ? 0 : list_->entries.size(); }
    End& operator[](std::size_t index) const noexcept { return *list_->entries[index].end; }
    /// Whether no connection begins or ends with a commit, or has ended so.
    [[nodiscard]] bool steady() const noexcept { return list_ == nullptr || list_->steady; }
    [[nodiscard]] Lifetime lifetime(std::size_t index) const noexcept {
      return list_->entries[index].lifetime;
    }
    /// Whether the connection carries samples now.
    [[nodiscard]] bool carries(std::size_t index) const noexcept {
      const Lifetime now = lifetime(index);
      return now == Lifetime::Always || settled(now, committed_) == Lifetime::Always;
    }

   private:
    std::atomic<std::uint64_t>& section_;
    std::uint64_t count_;
    const List* list_;
    bool committed_;
  };

  /// Adds a connection; with a gate, it begins when that opens.
  void add(std::shared_ptr<End> end, const CommitGatePtr& gate = nullptr) {
    const Lock lock(mutex_);
    List next = copy(1);
    const Lifetime lifetime = gate ? Lifetime::FromCommit : Lifetime::Always;
    if (gate) use_gate(next, gate);
    next.entries.push_back({std::move(end), lifetime});
    swap(std::move(next));
  }

  /// The connection ends when the gate opens. Does nothing where it does not carry samples now.
  void end_at(const End* end, const CommitGatePtr& gate) {
    const Lock lock(mutex_);
    List next = copy(0);
    use_gate(next, gate);
    for (Entry& entry : next.entries) {
      if (entry.end.get() == end && entry.lifetime == Lifetime::Always)
        entry.lifetime = Lifetime::UntilCommit;
    }
    swap(std::move(next));
  }

  /// The transition has committed or was given up: the gate is not needed any more.
  void settle() {
    const Lock lock(mutex_);
    List next = copy(0);
    if (!next.gate) return;
    use_gate(next, nullptr);
    swap(std::move(next));
  }

  /// False if `end` is not in the list.
  bool remove(const End* end) {
    const Lock lock(mutex_);
    List next = copy(0);
    const auto is_it = [end](const Entry& entry) { return entry.end.get() == end; };
    if (std::erase_if(next.entries, is_it) == 0) return false;
    swap(std::move(next));
    return true;
  }

  /// A copy of the list, for any thread but the real-time reader.
  [[nodiscard]] std::vector<std::shared_ptr<End>> snapshot() const {
    const Lock lock(mutex_);
    std::vector<std::shared_ptr<End>> ends;
    const List* now = list_.load(std::memory_order_relaxed);
    for (std::size_t i = 0; now != nullptr && i < now->entries.size(); ++i)
      ends.push_back(now->entries[i].end);
    return ends;
  }

  /// Waits until the reader has left the section that it is in, if any.
  void wait_for_reader() const noexcept {
    const std::uint64_t seen = section_.load(std::memory_order_seq_cst);  // L1, pairs with L2
    if (seen % 2 == 1) detail::wait_until_left(section_, seen);
  }

  [[nodiscard]] bool empty() const noexcept { return list_.load(std::memory_order_acquire) == nullptr; }

 private:
  /// A copy with room for `more` entries.
  List copy(std::size_t more) const {
    const List* now = list_.load(std::memory_order_relaxed);
    List next;
    next.entries.reserve((now == nullptr ? 0 : now->entries.size()) + more);
    if (now == nullptr) return next;
    next.entries = now->entries;
    next.gate = now->gate;
    return next;
  }

  /// Replaces the gate. An earlier one belongs to a transition that has ended.
  static void use_gate(List& list, const CommitGatePtr& gate) {
    if (list.gate && list.gate != gate) {
      const bool committed = list.gate->open();
      for (Entry& entry : list.entries)
        entry.lifetime = settled(entry.lifetime, committed);
    }
    list.gate = gate;
  }

  void swap(List next) {
    next.steady = true;
    for (const Entry& entry : next.entries)
      next.steady = next.steady && entry.lifetime == Lifetime::Always;
    const List* fresh = next.entries.empty() ? nullptr : new List(std::move(next));
    // L1: before the load of section_.
    const std::unique_ptr<const List> old(list_.exchange(fresh, std::memory_order_seq_cst));
    wait_for_reader();
  }

  alignas(64) std::atomic<std::uint64_t> section_{0};  ///< odd: the reader is inside
  std::atomic<const List*> list_{nullptr};             ///< nullptr: no connections
  mutable Mutex mutex_;                                ///< serializes changes of list_
};

}  // namespace segue::task
