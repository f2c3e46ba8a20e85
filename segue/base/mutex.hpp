// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <mutex>

/// Mutexes whose use clang checks when it compiles (-Wthread-safety, in all builds with clang; Hutchins et
/// al. 2014, "C/C++ thread safety analysis"). A member says which mutex protects it (SEGUE_GUARDED_BY), a
/// function which one its caller must hold (SEGUE_REQUIRES) or must not hold (SEGUE_EXCLUDES). Whoever
/// touches a member without its mutex does not compile. A member that is protected in another way, such as by
/// the order of events, has a comment that says so instead. Other compilers see plain std::mutex.
#if defined(__clang__)
#define SEGUE_THREAD_SAFETY(x) __attribute__((x))
#else
#define SEGUE_THREAD_SAFETY(x)
#endif
/// Of a member: it is read and written only while that mutex is held.
#define SEGUE_GUARDED_BY(mutex) SEGUE_THREAD_SAFETY(guarded_by(mutex))
/// On a pointer: the object that it points to is protected by that mutex.
#define SEGUE_POINTEE_GUARDED_BY(mutex) SEGUE_THREAD_SAFETY(pt_guarded_by(mutex))
/// Of a function, also of a lambda (behind its parameters): the caller holds that mutex.
#define SEGUE_REQUIRES(...) SEGUE_THREAD_SAFETY(requires_capability(__VA_ARGS__))
#define SEGUE_REQUIRES_SHARED(...) SEGUE_THREAD_SAFETY(requires_shared_capability(__VA_ARGS__))
/// Of a function: the caller does not hold that mutex, since the function takes it or calls who may take it.
#define SEGUE_EXCLUDES(...) SEGUE_THREAD_SAFETY(locks_excluded(__VA_ARGS__))
/// Of a function that holds a mutex in a way which cannot be followed; a comment says how.
#define SEGUE_UNCHECKED_LOCKS SEGUE_THREAD_SAFETY(no_thread_safety_analysis)

namespace segue {

/// std::mutex. Not recursive.
class SEGUE_THREAD_SAFETY(capability("mutex")) Mutex {
 public:
  Mutex() = default;
  Mutex(const Mutex&) = delete;
  Mutex& operator=(const Mutex&) = delete;
  void lock() SEGUE_THREAD_SAFETY(acquire_capability()) { mutex_.lock(); }
  bool try_lock() SEGUE_THREAD_SAFETY(try_acquire_capability(true)) { return mutex_.try_lock(); }
  void unlock() SEGUE_THREAD_SAFETY(release_capability()) { mutex_.unlock(); }

 private:
  friend class ConditionVariable;
  friend class StoppableConditionVariable;
  std::mutex mutex_;
};

/// Holds a mutex as long as it lives, but between unlock() and lock().
class SEGUE_THREAD_SAFETY(scoped_lockable) Lock {
 public:
  explicit Lock(Mutex& mutex) SEGUE_THREAD_SAFETY(acquire_capability(mutex)) : lock_(mutex) {}
  ~Lock() SEGUE_THREAD_SAFETY(release_capability()) = default;
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  void unlock() SEGUE_THREAD_SAFETY(release_capability()) { lock_.unlock(); }
  void lock() SEGUE_THREAD_SAFETY(acquire_capability()) { lock_.lock(); }

 private:
  std::unique_lock<Mutex> lock_;
};

/// Gives a mutex that is held back as long as it lives, for calls that must not be made under it.
class SEGUE_THREAD_SAFETY(scoped_lockable) Unlocked {
 public:
  explicit Unlocked(Mutex& mutex) SEGUE_THREAD_SAFETY(release_capability(mutex)) : mutex_(mutex) {
    mutex_.unlock();
  }
  ~Unlocked() SEGUE_THREAD_SAFETY(release_capability()) { mutex_.lock(); }
  Unlocked(const Unlocked&) = delete;
  Unlocked& operator=(const Unlocked&) = delete;

 private:
  Mutex& mutex_;
};

}  // namespace segue
