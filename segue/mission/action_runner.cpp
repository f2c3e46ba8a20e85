// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/action_runner.hpp>
#include <segue/mission/controllers.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission/world_values.hpp>
#include <segue/model/reader.hpp>

#include <algorithm>

namespace segue::mission {

using type::Value;

Result<WorldView> ActionCall::world() const {
  const Action& what = action();
  if (!what.reads_world && what.reads_data.empty())
    return fail(ErrorCode::InvalidState, "the action does not declare 'reads_world'");
  const WorldView seen = what.reads_world ? look_at_world() : WorldView({}, {});
  AttachedData data = seen.data();
  for (std::size_t i = 0; i < what.inputs.size(); ++i) {
    const auto field = what.inputs[i].from_world ? placeholder_field(what.inputs[i].name) : std::nullopt;
    if (field && field->path.empty())
      data.insert_or_assign(std::string(field->data), std::make_shared<const ValueData>(inputs()[i]));
  }
  return WorldView(seen.facts(), std::move(data));
}

const Value& ActionCall::progress() const {
  static const Value kNone;
  return kNone;
}

Result<void> ActionRunner::go_on(const Action& /*action*/, const Value& /*progress*/) {
  return fail(ErrorCode::Unsupported,
              "nobody can see how far it got, since it is not a controller of a robot");
}

const Action& ActionCall::action() const {
  return program().mission().actions[program().node(state()).action];
}

const Value& ActionCall::input(std::string_view name) const {
  static const Value kNull;
  const auto found = position(action().inputs, name);
  return found ? inputs()[*found] : kNull;
}

Value ActionCall::filled(const Value& value) const {
  return mission::filled(value, [this](std::string_view name) -> const Value& { return input(name); });
}

bool ActionCall::set_output(std::string_view name, Value value) {
  const auto found = position(action().outputs, name);
  if (found) outputs()[*found] = std::move(value);
  return found.has_value();
}

Result<std::string> ActionCall::controller(std::string name) const {
  name = *controller_name(std::move(name), [&](const std::string& one) {
    return model::detail::scalar_text(input(one)).value_or("");
  });
  if (is_identifier(name)) return name;
  return fail(ErrorCode::InvalidArgument, quote(name) + " is not a valid controller name");
}

std::optional<Outcome> ActionCall::outcome(std::string_view name) const {
  if (name == kAbortedName) return kAborted;
  if (name == kPreemptedName) return kPreempted;
  const auto& outcomes = action().outcomes;
  const auto found = std::ranges::find(outcomes, name);
  if (found == outcomes.end()) return std::nullopt;
  return static_cast<Outcome>(found - outcomes.begin());
}

}  // namespace segue::mission
