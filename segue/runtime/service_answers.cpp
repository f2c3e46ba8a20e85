// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/service_answers.hpp>

#include <segue/base/diagnostic.hpp>
#include <segue/base/has_answered.hpp>
#include <segue/base/text.hpp>
#include <segue/model/files.hpp>
#include <segue/runtime/runtime_report.hpp>

#include <string>
#include <utility>
#include <vector>

namespace segue::runtime {

Result<type::Value> answer_of(const Result<PlannedSwitch>& planned) {
  return planned ? Result<type::Value>(to_value(*planned)) : planned.error();
}

Result<model::Transition> read_given(const control::GivenTransition& given) {
  Diagnostics diagnostics;
  auto transition = model::read_transition(given.text, given.file, diagnostics);
  if (!transition) {
    return diagnostics.to_error(ErrorCode::ParseError);
  }
  return *std::move(transition);
}

Result<type::Value> answer_of(std::future<SwitchResult> future, std::string_view target, const Wait& wait) {
  if (!has_answered(future, wait)) {
    return fail(ErrorCode::DeadlineExceeded,
                "the switch to " + quote(target) + " is still in progress; watch it with 'segue events'",
                std::string(target));
  }
  return to_value(future.get());
}

Result<type::Value> answer_of(const std::shared_future<HaltResult>& future, TimePoint deadline) {
  if (!future.valid()) {
    return type::Value();
  }
  if (future.wait_until(deadline) != std::future_status::ready) {
    return fail(ErrorCode::DeadlineExceeded,
                "the robot is being halted, but is not at rest yet; watch it with 'segue events'");
  }
  return to_value(future.get());
}

type::Value refusal(const Diagnostics& diagnostics, std::string_view what) {
  const std::string problems = to_string(diagnostics.to_error());
  return type::Value::map({{"outcome", to_string(Outcome::Refused)},
                           {"error", std::string(what) + " cannot be used: " + problems},
                           {"diagnostics", to_value(diagnostics)}});
}

Error no_files() {
  return fail(ErrorCode::Unsupported,
              "the runtime was started without a robot file, so there is nothing to apply");
}

Error unknown(const model::NetworkName& wanted, const ControllerSet& set) {
  std::vector<std::string> names;
  for (const auto& network : set.controllers) {
    names.push_back(network.name.str());
  }
  return fail(ErrorCode::NotFound, "the robot's files have no controller " + quote(wanted.str()) +
                                       did_you_mean(wanted.str(), names));
}

}  // namespace segue::runtime
