// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/task/port.hpp>
#include <segue/task/sample.hpp>

namespace segue::task {

/// Samples in place, of a type that the configuration tells; a component makes the port in on_configure.
class AnyInput final : public InputPortBase {
 public:
  using InputPortBase::InputPortBase;
  /// The next sample that has not been read; empty where there is none.
  SampleRef take() noexcept { return fetch() == ReadStatus::NewData ? last() : SampleRef(); }
};

/// Samples made in place, of a type that the configuration tells; a component makes the port in on_configure.
class AnyOutput final : public OutputPortBase {
 public:
  using OutputPortBase::acquire;
  using OutputPortBase::acquire_flat;
  using OutputPortBase::OutputPortBase;
  using OutputPortBase::publish;
};

}  // namespace segue::task
