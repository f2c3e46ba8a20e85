// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/model/ids.hpp>
#include <segue/type/type_info.hpp>
#include <segue/type/value.hpp>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace segue::task_host {
class PortReader;
class TaskHost;
}  // namespace segue::task_host

/// Members of tasks by their address: "odometry.pose".
namespace segue::runtime {

/// "task.member" as two names. InvalidArgument where one is missing; ids of tasks have no dot.
Result<model::PortRef> member_of(std::string_view address);

/// The newest samples of an output port, as Values. A value that can be moved; one thread uses it at a time.
/// Where its task has ended, the next call finds the task that then has that name.
class PortValues {
 public:
  /// Connects at once, or at the next call where that is not possible yet. `host` must outlive this.
  PortValues(task_host::TaskHost& host, std::string_view address);
  ~PortValues();
  PortValues(PortValues&& other) noexcept;
  PortValues& operator=(PortValues&& other) noexcept;

  /// A sample that was written since this was made and that no call has returned: the newest one, or, where
  /// there is none, the next one. Blocks for `timeout` at most. DeadlineExceeded; NotFound, where there is no
  /// such task or port; Unavailable.
  Result<type::Value> next(Duration timeout);
  /// The last sample that was written since this was made. Does not wait: NotFound, where there is none yet.
  Result<type::Value> latest();

 private:
  Result<void> connect();

  task_host::TaskHost* host_;
  Result<model::PortRef> port_;
  std::unique_ptr<task_host::PortReader> reader_;
  std::optional<type::Value> last_;
};

/// Samples of an output port as T, a type that is described: by SEGUE_TYPE, or in segue/type/describe.hpp. As
/// PortValues; and the error of the conversion, where a sample is not a valid T.
template <class T>
class Port {
 public:
  explicit Port(PortValues values) : values_(std::move(values)) {}

  Result<T> next(Duration timeout) { return read(values_.next(timeout)); }
  Result<T> latest() { return read(values_.latest()); }

 private:
  static Result<T> read(Result<type::Value> sample) {
    if constexpr (std::is_same_v<T, type::Value>) {
      return sample;
    } else {
      if (!sample) return std::move(sample.error());
      Result<T> object{T{}};
      auto done = type::type_info<T>().from_value(&*object, *sample, "sample");
      if (!done) return std::move(done.error());
      return object;
    }
  }

  PortValues values_;
};

}  // namespace segue::runtime
