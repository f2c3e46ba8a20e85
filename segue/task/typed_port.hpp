// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/port.hpp>
#include <segue/type/describe.hpp>

#include <string>
#include <utility>
#include <vector>

namespace segue::task {

template <class T>
class OutputPort;

namespace detail {
inline PortOptions for_objects(PortOptions options) {
  options.flat = false;
  return options;
}
}  // namespace detail

/// A sample that is written in place: `auto loan = out_.loan(); if (loan) { loan->x = 1; loan.publish(); }`.
/// It still holds the value of an earlier sample, so every part must be set. Must not outlive its port;
/// discarded unless it is published. Real-time safe.
template <class T>
class Loan {
 public:
  explicit operator bool() const noexcept { return static_cast<bool>(slot_); }
  T& operator*() const noexcept { return *static_cast<T*>(slot_->value); }
  T* operator->() const noexcept { return static_cast<T*>(slot_->value); }
  /// Sends the sample; the loan is empty then. An empty one sends nothing (NoSlot).
  WriteResult publish() noexcept { return slot_ ? port_.publish(slot_.detach()) : WriteResult::NoSlot; }

 private:
  friend class OutputPort<T>;
  Loan(OutputPort<T>& port, SampleSlot* slot) noexcept : port_(port), slot_(SampleRef::adopt(slot)) {}
  OutputPort<T>& port_;
  SampleRef slot_;
};

/// A sample as it was written, shared with all other readers: immutable, and valid as long as it is held.
/// Holding many starves the writer (WriteResult::NoSlot). Real-time safe.
template <class T>
class Sample {
 public:
  Sample() = default;
  Sample(SampleRef reference, const T* value) noexcept : reference_(std::move(reference)), value_(value) {}
  explicit operator bool() const noexcept { return value_ != nullptr; }
  const T& operator*() const noexcept { return *value_; }
  const T* operator->() const noexcept { return value_; }
  [[nodiscard]] const T* get() const noexcept { return value_; }
  /// The number of this sample at its output port, from 1.
  [[nodiscard]] std::uint64_t sequence() const noexcept { return reference_->sequence; }

 private:
  SampleRef reference_;
  const T* value_ = nullptr;
};

/// Writes samples to all connections. For its task only, one thread at a time.
template <class T>
class OutputPort : public OutputPortBase {
 public:
  OutputPort(Component& component, std::string name, PortOptions options = {})
      : OutputPortBase(component, std::move(name), &type::type_info<T>(), {},
                       detail::for_objects(std::move(options))) {}

  /// Copies `value` by assignment into a free slot. As real-time safe as that assignment: containers keep
  /// their capacity, see prime().
  WriteResult write(const T& value) {
    SampleSlot* slot = acquire();
    if (slot == nullptr) return WriteResult::NoSlot;
    *static_cast<T*>(slot->value) = value;
    return publish(slot);
  }

  /// A slot to write to without a copy; empty if none is free. Real-time safe.
  Loan<T> loan() noexcept { return {*this, acquire()}; }

  /// Fills every free slot, and all slots that later connections add, with `example`, so that writing values
  /// that are not larger allocates nothing. For hooks, not for updates.
  void prime(const T& example) { prime_slots(&example); }

 private:
  friend class Loan<T>;
};

/// Reads samples from all connections in turn. For its task only, one thread at a time.
template <class T>
class InputPort : public InputPortBase {
 public:
  InputPort(Component& component, std::string name, PortOptions options = {})
      : InputPortBase(component, std::move(name), &type::type_info<T>(), {},
                      detail::for_objects(std::move(options))) {}

  /// Copies the next sample, or the last one again (OldData), into `value`; NoData leaves it unchanged. As
  /// real-time safe as T's assignment.
  ReadStatus read(T& value) {
    const ReadStatus status = fetch();
    if (status != ReadStatus::NoData) value = value_of(*last().get());
    return status;
  }

  /// The next sample itself, without a copy; empty if there is no new one. Real-time safe.
  Sample<T> take() noexcept {
    if (fetch() != ReadStatus::NewData) return {};
    return Sample<T>(last(), &value_of(*last().get()));
  }

  /// Reads all that waits, and gives the newest sample, also if it was read before; empty if there is none.
  /// Real-time safe.
  Sample<T> latest() noexcept {
    ReadStatus status = ReadStatus::NewData;
    while (status == ReadStatus::NewData)
      status = fetch();
    if (status == ReadStatus::NoData) return {};
    return Sample<T>(last(), &value_of(*last().get()));
  }

 private:
  /// A sample of an untyped output has no value and stands for a default value.
  static const T& value_of(const SampleSlot& slot) noexcept {
    if (slot.value != nullptr) return *static_cast<const T*>(slot.value);
    static const T default_value{};
    return default_value;
  }
};

}  // namespace segue::task
