// SPDX-License-Identifier: Apache-2.0
// Must not compile with clang: count() reads what the mutex protects without it (CMakeLists.txt tries that).
#include <segue/base/mutex.hpp>

namespace segue {

class Counter {
 public:
  void add() {
    const Lock lock(mutex_);
    ++count_;
  }
  [[nodiscard]] int count() const { return count_; }

 private:
  Mutex mutex_;
  int count_ SEGUE_GUARDED_BY(mutex_) = 0;
};

}  // namespace segue
