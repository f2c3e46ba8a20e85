// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/task_host/port_reader.hpp>
#include <segue/type/value.hpp>

#include <cstddef>
#include <string>
#include <vector>

namespace segue::control {

/// Samples of an output port for a remote reader.
class SampleStream {
 public:
  virtual ~SampleStream() = default;
  /// A look, as those of RobotService.
  virtual Result<std::vector<type::Value>> read(std::size_t limit, const Wait& wait) = 0;
  Result<std::vector<type::Value>> read(std::size_t limit) { return read(limit, Wait(TimePoint::max())); }
  /// Reads samples like read(), but answers as soon as there is one; with none at the end of the wait. Does
  /// not block.
  virtual void next(std::size_t limit, const Wait& wait, task_host::SamplesAnswer answered) = 0;
  [[nodiscard]] virtual std::string type_name() const = 0;
};

}  // namespace segue::control
