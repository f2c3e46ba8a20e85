// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/task/futex.hpp>
#include <segue/task/port.hpp>
#include <segue/task/property.hpp>

#include <chrono>
#include <cstdint>
#include <string>

namespace segue::task {

/// A limit for how long an input may go without a sample. By such a limit the driver of an actuator learns
/// that whoever commands it is gone, hangs, or cannot be reached. A member of the component, after the input:
///
///   InputPort<Velocity> command_{*this, "command"};
///   InputTimeout timeout_{command_, "timeout", std::chrono::milliseconds(200)};
///
/// The limit is a live property of the component; 0 or less: there is none. Time counts by the task's clock,
/// from its start or from the update that read the last sample. A running task that is driven by samples or
/// by file descriptors is also updated once when the limit has passed.
class InputTimeout {
 public:
  /// `property`: its name; `limit`: its default. `doc` may say what the component does then.
  InputTimeout(InputPortBase& input, std::string property, std::chrono::milliseconds limit,
               std::string doc = {});
  ~InputTimeout();
  InputTimeout(const InputTimeout&) = delete;
  InputTimeout& operator=(const InputTimeout&) = delete;

  /// Whether the input has gone without a sample for so long. For on_update and on_error, after they have
  /// read the input; real-time safe.
  [[nodiscard]] bool passed() const noexcept;
  /// How long the input has gone without a sample; zero in the update that has read one. To be called like
  /// passed().
  [[nodiscard]] Duration age() const noexcept;
  /// As the property says; zero: there is none. Real-time safe.
  [[nodiscard]] Duration limit() const noexcept;
  [[nodiscard]] const InputPortBase& input() const { return input_; }

  /// For the task: counting begins.
  void begin(TimePoint now) noexcept;
  /// For the task: an update that lasted so long could read the input, and ask whether the limit has passed.
  void note_update(TimePoint begin, TimePoint end) noexcept;
  /// For the task: when the limit passes and no update has seen it yet; kNever where none is to come.
  [[nodiscard]] TimePoint due() const noexcept;

 private:
  InputPortBase& input_;
  Property<std::chrono::milliseconds> limit_;
  TimePoint since_{};          ///< the start or the end of the last update that read a sample
  TimePoint noted_{};          ///< the beginning of the last update
  std::uint64_t counted_ = 0;  ///< samples read until then
};

}  // namespace segue::task
