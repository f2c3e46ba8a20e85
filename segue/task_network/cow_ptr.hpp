// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstdint>
#include <utility>

namespace segue::task_network {

/// Base of the objects that CowPtr owns. A copied object starts without owners.
class CowObject {
 public:
  CowObject() = default;
  CowObject(const CowObject&) {}
  CowObject& operator=(const CowObject&) { return *this; }
  virtual ~CowObject() = default;

 private:
  template <class>
  friend class CowPtr;
  mutable std::atomic<std::uint32_t> owners_{0};
};

/// A copy-on-write pointer: shared ownership, and `unique` tells whether the object may be changed in place.
/// Several CowPtr may share an object over several threads; one CowPtr belongs to one thread.
///
/// Memory order: a new owner copies from an existing one, which keeps the count above zero meanwhile, so
/// counting up may be relaxed. Counting down is a release, and both the last owner's decrement (before the
/// delete) and the load in `unique` (before a write in place) are acquires: reads through an owner that has
/// gone happen before either. shared_ptr's use_count does not promise the latter.
template <class T>
class CowPtr {
 public:
  CowPtr() = default;
  explicit CowPtr(T* object) : object_(object) { acquire(); }
  CowPtr(const CowPtr& other) : object_(other.object_) { acquire(); }
  CowPtr(CowPtr&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  template <class U>  // NOLINTNEXTLINE(google-explicit-constructor)
  CowPtr(CowPtr<U> other) : object_(std::exchange(other.object_, nullptr)) {}
  CowPtr& operator=(CowPtr other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~CowPtr() {
    if (object_ != nullptr && object_->owners_.fetch_sub(1, std::memory_order_acq_rel) == 1) delete object_;
  }

  [[nodiscard]] bool unique() const { return object_->owners_.load(std::memory_order_acquire) == 1; }
  [[nodiscard]] T* get() const { return object_; }
  T* operator->() const { return object_; }
  T& operator*() const { return *object_; }
  explicit operator bool() const { return object_ != nullptr; }

 private:
  template <class>
  friend class CowPtr;
  void acquire() const {
    if (object_ != nullptr) object_->owners_.fetch_add(1, std::memory_order_relaxed);
  }
  T* object_ = nullptr;
};

template <class T, class... Arguments>
CowPtr<T> make_cow(Arguments&&... arguments) {
  return CowPtr<T>(new T(std::forward<Arguments>(arguments)...));
}

}  // namespace segue::task_network
