// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>

#include <functional>
#include <string>

namespace segue::model {

/// A question for an instance of a pool of processes, for one call of an operation.
struct InstanceQuestion {
  std::string pool;
  std::string rather_not{};  ///< an instance that is taken only where no other one is free
};
struct TakenInstance {
  std::string task;
  int pid = 0;  ///< tells one life of its process from the next
};
/// Gets the instance, once, from any thread, also before the function that asks returns. Must not block.
using InstanceAnswer = std::function<void(Result<TakenInstance>)>;

}  // namespace segue::model
