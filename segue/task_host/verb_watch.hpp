// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/model/ids.hpp>
#include <segue/task/task.hpp>

#include <list>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task_host::detail {

/// Keeps the deadlines of verbs in progress. A hook that does not return blocks the thread that called it, so
/// another thread has to find it here. Thread safe.
class VerbWatch {
 public:
  /// A verb, from its begin to its end.
  class Verb {
   public:
    /// `task`: nullptr where it is just being created. `name`: of the verb, such as "configure".
    Verb(VerbWatch& watch, model::TaskId id, const task::Task* task, std::string_view name,
         TimePoint deadline);
    Verb(const Verb&) = delete;
    Verb& operator=(const Verb&) = delete;
    ~Verb();

   private:
    friend class VerbWatch;
    VerbWatch& watch_;
    const model::TaskId id_;
    const task::Task* const task_;
    const std::string name_;
    const TimePoint deadline_;
    std::list<const Verb*>::iterator place_;
  };

  /// Notes that a verb could not begin because another hook of the task had not returned by its deadline.
  void blocked(const model::TaskId& id, const std::shared_ptr<task::Task>& task);

  /// A task with a verb that is overdue, or still blocked. Another task may have got its id since.
  struct Overdue {
    model::TaskId id;
    const task::Task* task = nullptr;  ///< to be compared only; nullptr: it was just being created
    std::string why;                   ///< "configure has not returned by its deadline"
  };
  [[nodiscard]] std::vector<Overdue> overdue();

 private:
  Mutex mutex_;
  std::list<const Verb*> verbs_ SEGUE_GUARDED_BY(mutex_);
  std::map<model::TaskId, std::weak_ptr<task::Task>> blocked_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_host::detail
