// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/model/ids.hpp>
#include <segue/sample_link/port_connection.hpp>
#include <segue/task/port.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <map>
#include <memory>

namespace segue::task_host::detail {

/// Samples that people, tools and missions have written to input ports: the last one of each port, with a
/// connection of its own, so that the task can read it again as old data. Thread safe.
class WrittenSamples {
 public:
  WrittenSamples();
  ~WrittenSamples();
  WrittenSamples(const WrittenSamples&) = delete;
  WrittenSamples& operator=(const WrittenSamples&) = delete;

  /// Connects and writes. The port must exist until this returns. TypeMismatch; Unsupported for a port whose
  /// type is not known. wait_until_taken() must follow.
  Result<std::shared_ptr<sample_link::PortConnection>> write(task::InputPortBase& port,
                                                             const model::PortRef& name,
                                                             const type::Value& value);
  /// Waits until the task has taken the sample. DeadlineExceeded, and InvalidState where its port is gone:
  /// the sample is withdrawn then.
  Result<void> wait_until_taken(const model::PortRef& name, const sample_link::PortConnection& connection,
                                TimePoint deadline);
  /// Forgets those of tasks that do not run.
  void forget(const std::function<bool(const model::TaskId&)>& runs);

 private:
  class Written;
  Mutex mutex_;  ///< protects both
  std::map<const sample_link::PortConnection*, std::unique_ptr<Written>> on_their_way_
      SEGUE_GUARDED_BY(mutex_);
  std::map<model::PortRef, std::unique_ptr<Written>> taken_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::task_host::detail
