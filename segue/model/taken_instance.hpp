// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <functional>
#include <string>

namespace segue::model {

/// An instance of a pool that a caller has for itself.
struct TakenInstance {
  std::string task;
  int pid = 0;  ///< tells one life of its process from the next
};
/// A question for an instance of a pool of processes, for one call of an operation.
struct InstanceQuestion {
  std::string pool;
  /// The caller has just lost it: nobody gets it before it has been seen running again, and then the caller
  /// only where no other one is free. No task: none.
  TakenInstance lost{};
};
/// Gets the instance, once, from any thread, also before the function that asks returns. Must not block.
using InstanceAnswer = std::function<void(Result<TakenInstance>)>;

}  // namespace segue::model
