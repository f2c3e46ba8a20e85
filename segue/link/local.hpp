// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/base/result.hpp>
#include <segue/link/connection.hpp>
#include <segue/task/port.hpp>

#include <memory>

namespace segue::link {

/// Connects two ports of this process. Lock free for both tasks; samples are shared, never copied.
/// TypeMismatch (both definitions shown) unless names and structures agree or one side takes any type;
/// AlreadyExists for the same ports and policy; InvalidArgument for a policy that makes no sense. Any thread,
/// while both tasks run.
Result<std::shared_ptr<Connection>> connect(task::OutputPortBase& from, task::InputPortBase& to,
                                            const Policy& policy);

/// Whether samples of `from` fit `to`; the error shows both definitions.
Result<void> check_types(const task::OutputPortBase& from, const task::InputPortBase& to);

/// A buffer of at least one sample; data of exactly one.
Result<void> check_policy(const Policy& policy);

}  // namespace segue::link
