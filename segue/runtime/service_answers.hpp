// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/error.hpp>
#include <segue/base/wait.hpp>
#include <segue/control/robot_request.hpp>
#include <segue/model/transition.hpp>
#include <segue/runtime/controller_set.hpp>
#include <segue/runtime/halt_result.hpp>
#include <segue/runtime/planned_switch.hpp>
#include <segue/runtime/switch_result.hpp>
#include <segue/type/value.hpp>

#include <future>
#include <string_view>

/// Answers to clients of a robot. Any thread.
namespace segue::runtime {

Result<type::Value> answer_of(const Result<PlannedSwitch>& planned);
/// These two wait for the result; DeadlineExceeded where it goes on without them.
Result<type::Value> answer_of(std::future<SwitchResult> future, std::string_view target, const Wait& wait);
/// Null where there was nothing to halt.
Result<type::Value> answer_of(const std::shared_future<HaltResult>& future, TimePoint deadline);

/// Where files have errors: the report of a request that was refused.
type::Value refusal(const Diagnostics& diagnostics, std::string_view what);
Error no_files();
/// `wanted` is no controller of the set.
Error unknown(const model::NetworkName& wanted, const ControllerSet& set);

/// ParseError with all problems.
Result<model::Transition> read_given(const control::GivenTransition& given);

}  // namespace segue::runtime
