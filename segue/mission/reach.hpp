// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/mutex.hpp>

namespace segue::mission::detail {

/// How callbacks, which never keep it, reach an object for as long as there is one. Thread safe.
template <class T>
class Reach {
 public:
  explicit Reach(T& object) : object_(&object) {}

  /// Nobody uses the object any more when it returns. For its destructor, before anything of it goes.
  void close() {
    const Lock lock(mutex_);
    object_ = nullptr;
  }
  template <class Use>
  void with(Use use) {
    const Lock lock(mutex_);
    if (object_ != nullptr) use(*object_);
  }

 private:
  Mutex mutex_;  ///< locked before those of the object
  T* object_;
};

}  // namespace segue::mission::detail
