// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/base/wait.hpp>
#include <segue/control/robot_lease.hpp>
#include <segue/runtime/served_runtime.hpp>

#include <cstdint>
#include <vector>

namespace segue::runtime {

/// The robot's lease as a server hands it out; it ends with its holder.
class RuntimeLease final : public control::RobotLease {
 public:
  RuntimeLease(ServedRuntime& runtime, std::uint64_t number) : runtime_(runtime), number_(number) {}
  ~RuntimeLease() override { runtime_.end_lease(number_); }
  RuntimeLease(const RuntimeLease&) = delete;
  RuntimeLease& operator=(const RuntimeLease&) = delete;

  [[nodiscard]] std::uint64_t number() const override { return number_; }
  Result<control::LeaseStanding> standing(const Wait& /*wait*/) override {
    return runtime_.lease_standing(number_);
  }
  Result<std::vector<control::HolderRequest>> asked() override { return runtime_.take_commands(number_); }

 private:
  ServedRuntime& runtime_;
  const std::uint64_t number_;
};

}  // namespace segue::runtime
