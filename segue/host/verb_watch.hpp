// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/model/ids.hpp>
#include <segue/task/task.hpp>

#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

namespace segue::host::detail {

/// Which verbs are under way and since when they should be done: a hook that does not return holds the
/// thread of its caller, so others must tell. Thread safe.
class VerbWatch {
 public:
  /// A verb, from its begin to its end.
  class Verb {
   public:
    Verb(VerbWatch& watch, model::TaskId task, TimePoint deadline);
    Verb(const Verb&) = delete;
    Verb& operator=(const Verb&) = delete;
    ~Verb();

   private:
    friend class VerbWatch;
    VerbWatch& watch_;
    const model::TaskId task_;
    const TimePoint deadline_;
    std::list<const Verb*>::iterator place_;
  };

  /// A verb could not begin, since another hook of the task has not returned by its deadline.
  void blocked(const model::TaskId& id, const std::shared_ptr<task::Task>& task);

  /// Tasks with a verb that is overdue, or still blocked; each once, in order.
  [[nodiscard]] std::vector<model::TaskId> overdue();

 private:
  std::mutex mutex_;
  std::list<const Verb*> verbs_;
  std::map<model::TaskId, std::weak_ptr<task::Task>> blocked_;
};

}  // namespace segue::host::detail
