// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace segue::task_host {

/// Gets samples of a port, oldest first, once, from any thread, also before the function that asks returns.
/// Must not block.
using SamplesAnswer = std::function<void(Result<std::vector<type::Value>>)>;

/// In place of the size of a reader's buffer: it gets no samples, but measurements of the writes
/// (detail::measure_writes).
inline constexpr std::size_t kMeasureWrites = 0;

/// Reads the samples of an output port for a person or a tool. Destroying it removes the connection. Thread
/// safe.
class PortReader {
 public:
  virtual ~PortReader() = default;
  /// The samples that nobody has read yet, oldest first, at most `limit`. Does not wait for samples.
  virtual std::vector<type::Value> read(std::size_t limit) = 0;
  /// Reads samples like read(), but answers as soon as there is one; with none at the end of the wait. The
  /// errors: NotFound where its task is gone, Cancelled where this has been destroyed or the wait was
  /// stopped, Unavailable where its process cannot be reached. Does not block.
  virtual void next(std::size_t limit, const Wait& wait, SamplesAnswer answered) = 0;
  [[nodiscard]] virtual std::string type_name() const = 0;
};

}  // namespace segue::task_host
