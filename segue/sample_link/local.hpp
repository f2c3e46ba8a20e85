// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/policy.hpp>
#include <segue/base/result.hpp>
#include <segue/sample_link/port_connection.hpp>
#include <segue/task/port.hpp>

#include <memory>
#include <string_view>

namespace segue::sample_link {

/// Connects two ports of this process. Lock free for both tasks; samples are shared, never copied.
/// TypeMismatch (showing both definitions) unless type names and structures agree or one port is of any type;
/// AlreadyExists for the same ports and policy, and where the samples travel already by the topic of both
/// (PortOptions); InvalidArgument for an invalid policy. Any thread, also while both tasks run. With a gate
/// it is dormant until that opens.
Result<std::shared_ptr<PortConnection>> connect(task::OutputPortBase& from, task::InputPortBase& to,
                                                const Policy& policy,
                                                const task::CommitGatePtr& gate = nullptr);

/// Whether samples of `from` fit `to`; the error shows both definitions.
Result<void> check_types(const task::OutputPortBase& from, const task::InputPortBase& to);

/// AlreadyExists where the output is the topic (PortOptions) that the input `to` is.
Result<void> check_topics(const task::OutputPortBase& from, std::string_view to, std::string_view topic);

/// Requires room for at least one sample; for policy data, for exactly one.
Result<void> check_policy(const Policy& policy);

}  // namespace segue::sample_link
