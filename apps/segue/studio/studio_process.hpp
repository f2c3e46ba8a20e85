// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <utility>

namespace segue::cli {

/// Where a studio listens unless told otherwise.
inline constexpr std::uint32_t kStudioPort = 8475;

/// `segue studio` in a process of its own, which ends with this one, however this one ends. It prints to this
/// process's standard output and error; whatever happens to it, this process goes on.
class StudioProcess {
 public:
  static Result<StudioProcess> start(const std::string& robot, std::uint32_t port, bool json);
  StudioProcess(StudioProcess&& other) noexcept
      : pid_(std::exchange(other.pid_, 0)), input_(std::move(other.input_)) {}
  StudioProcess& operator=(StudioProcess&&) = delete;
  ~StudioProcess();

 private:
  StudioProcess(pid_t pid, Descriptor input) : pid_(pid), input_(std::move(input)) {}

  pid_t pid_;
  Descriptor input_;  ///< ends the studio when it closes
};

}  // namespace segue::cli
