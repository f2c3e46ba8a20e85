// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/task/channel.hpp>
#include <segue/task/commit_gate.hpp>
#include <segue/task/port.hpp>
#include <segue/task/sample.hpp>

#include <atomic>
#include <memory>
#include <string>

namespace segue::task {

class SampleMemory;

/// Gives links, and nobody else, access to the connections of an output port. Any thread, also while the task
/// writes; not for update paths, since these functions allocate, lock, and wait for a write in progress. The
/// port must exist until they return.
class OutputPortAccess {
 public:
  /// Adds an end; with a gate, it gets samples once that opens. AlreadyExists if an end leads to the same
  /// `reader`, "task.port", with the same policy; ResourceExhausted if there is no memory for its samples.
  static Result<void> attach(OutputPortBase& port, std::shared_ptr<WriterEnd> end, const std::string& reader,
                             const CommitGatePtr& gate = nullptr);
  /// Once the gate opens, the end gets no more samples. Does nothing where it gets none now.
  static void end_at(OutputPortBase& port, const WriterEnd& end, const CommitGatePtr& gate);
  /// Drops the gate of a transition that has ended.
  static void settle(OutputPortBase& port);
  /// Tells whoever has kept samples for it that a connection has begun with a commit.
  static void begun(const OutputPortBase& port) {
    if (port.options().on_commit) port.options().on_commit();
  }
  /// Removes an end. No sample is passed to it any more when this returns.
  static void detach(OutputPortBase& port, const WriterEnd& end);
  /// Waits until a write or show_last() that is in progress has ended.
  static void wait_until_written(OutputPortBase& port);
  /// From now on samples lie in `memory`, unless another memory was set before. ResourceExhausted.
  static Result<void> share(OutputPortBase& port, const std::shared_ptr<SampleMemory>& memory);
  /// Passes the last sample to `accept`, if there is one. The sample is taken out of the port meanwhile, so
  /// that it cannot be released; it is put back unless the writer has published a newer one.
  template <class Accept>
  static void show_last(OutputPortBase& port, Accept accept) {
    const Lock lock(port.attach_mutex_);
    SampleSlot* last = port.last_.exchange(nullptr, std::memory_order_acq_rel);  // pairs with K1
    if (last == nullptr) return;
    accept(*last);
    SampleSlot* expected = nullptr;
    if (!port.last_.compare_exchange_strong(expected, last, std::memory_order_acq_rel))
      last->release();  // K1
  }
};

/// Gives links and tasks, and nobody else, access to the connections of an input port and to whoever is
/// notified of its samples. Any thread, also while the task reads; but for notify() not for update paths, as
/// those of OutputPortAccess. The port must exist until they return.
class InputPortAccess {
 public:
  /// Adds an end, which gets the listener of the port.
  static void attach(InputPortBase& port, std::shared_ptr<ReaderEnd> end);
  /// Once the gate opens, what still waits in the end is read before anything newer of other ends.
  static void end_at(InputPortBase& port, const ReaderEnd& end, const CommitGatePtr& gate);
  /// Drops the gate of a transition that has ended.
  static void settle(InputPortBase& port);
  /// Removes an end. Nothing is read from it any more when this returns.
  static void detach(InputPortBase& port, const ReaderEnd& end);
  /// Wakes the task if this port triggers it. Real-time safe. N1, sequentially consistent: a link stores the
  /// sample and then loads the listener, a task that starts stores the listener and then checks for samples,
  /// so one of them sees the other.
  static void notify(InputPortBase& port) noexcept {
    if (SampleListener* listener = port.listener_.load(std::memory_order_seq_cst)) listener->sample_arrived();
  }
  /// Sets the listener of notify(); nullptr for none. The previous one is not being called any more when this
  /// returns.
  static void set_listener(InputPortBase& port, SampleListener* listener);
};

}  // namespace segue::task
