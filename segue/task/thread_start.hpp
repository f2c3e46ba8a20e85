// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/base/result.hpp>

#include <pthread.h>

#include <string>

namespace segue::task::detail {

struct StartedThread {
  pthread_t thread{};
  bool scheduler_granted = true;
};

/// Starts a thread with the scheduler, priority and processors of `activity`.
Result<StartedThread> start_thread(const std::string& name, const Activity& activity, void* (*main)(void*),
                                   void* argument);

}  // namespace segue::task::detail
