// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/task_host/stand_in.hpp>

#include <segue/base/text.hpp>
#include <segue/type/conform.hpp>
#include <segue/type/type_info.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <new>
#include <set>
#include <stdexcept>
#include <thread>

namespace segue::task_host {

namespace {

constexpr double kDefaultRate = 10.0;
/// A stand-in that writes whenever it gets a sample would never stop in a cycle of connections, so it ignores
/// samples that come sooner than this.
constexpr Duration kShortestInterval = std::chrono::microseconds(100);
constexpr std::string_view kStatePort = "state";  // every component has it

Duration period_of(double rate) {
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(1.0 / rate));
}

bool has_port(const task::Component& component, const ExpectedPort& port) {
  return port.direction == model::Direction::Input ? component.find_input(port.name) != nullptr
                                                   : component.find_output(port.name) != nullptr;
}

/// The model may have more details of a type than this process, or fewer.
const type::Type* type_named(std::string_view name, const type::TypeRegistry* types) {
  if (name.empty()) {
    return nullptr;
  }
  if (const auto* info = type::find_type_info(name)) {
    return info->type;
  }
  return types == nullptr ? nullptr : types->find(name);
}

type::Value initial_value(std::string_view type_name, const type::TypeRegistry* types) {
  const auto* info = type_name.empty() ? nullptr : type::find_type_info(type_name);
  if (info == nullptr) {
    return default_value(type_named(type_name, types));
  }
  void* memory = ::operator new(info->size, std::align_val_t(info->alignment));
  info->construct(memory);
  type::Value value = info->to_value(memory);
  info->destroy(memory);
  ::operator delete(memory, std::align_val_t(info->alignment));
  return value;
}

/// Accepts what fits the type as far as it is known.
task::DynamicProperty::Check check_against(const type::Type* type) {
  if (type == nullptr || !type->is_complete()) {
    return nullptr;
  }
  return [type](const type::Value& value, std::string_view path) -> Result<void> {
    Diagnostics findings;
    type::check_value(value, *type, path, {}, findings);
    if (findings.has_errors()) {
      return findings.to_error(ErrorCode::TypeMismatch);
    }
    return {};
  };
}

Result<void> check_behaviour(const type::Value& value, std::string_view path) {
  if (auto behaviour = read_behaviour(value, {}, path); !behaviour) {
    return std::move(behaviour.error());
  }
  return {};
}

/// Blocks for ever, as a stand-in that is specified to hang.
[[noreturn]] void hang() {
  while (true) {
    std::this_thread::sleep_for(std::chrono::hours(1));
  }
}

task::ComponentOptions options_of(const StandInPlan& plan) {
  task::ComponentOptions options{.doc = "stands in for " + plan.component.str(),
                                 .activity = stand_in_activity(plan.model, plan.behaviour)};
  if (plan.model != nullptr) {
    options.claims = plan.model->exclusive;
    options.trigger_on = plan.model->trigger_ports;
    options.descriptors = plan.model->descriptors;
  }
  return options;
}

class StandIn final : public task::Component {
 public:
  explicit StandIn(const StandInPlan& plan);

  Result<void> grow(const ExpectedPort& port, bool configured);
  void add_unknown_property(const std::string& name) {
    properties_.push_back(std::make_unique<task::DynamicProperty>(
        *this, name, "", type::Value{}, task::PropertyOptions{true, "named by the network"}));
  }

 protected:
  Result<void> on_configure() override;
  Result<void> on_start() override;
  void on_update() override;
  void on_stop() override;
  void on_cleanup() override;

 private:
  void add_port(const model::PortModel& port);
  void add_properties(const StandInPlan& plan);
  void add_operation(const model::OperationModel& operation, const type::TypeRegistry* types);
  /// How to create a port that a connection names; nullopt where it must not be created.
  [[nodiscard]] std::optional<model::PortModel> model_for(const ExpectedPort& port) const;
  /// Waits for the duration of the hook; an error where the hook is specified to fail.
  Result<void> pass(Duration StandInBehaviour::*time, std::string_view hook);

  const StandInBehaviour defaults_;
  StandInBehaviour now_;
  std::optional<model::ComponentModel> model_;
  const type::TypeRegistry* types_;
  Mutex ports_mutex_;  ///< protects the ports below: connections may add more at any time
  std::vector<ExpectedPort> expected_;
  std::deque<task::State> nominal_states_;
  std::deque<task::ErrorState> error_states_;
  std::vector<std::unique_ptr<task::InputPortBase>> static_inputs_, dynamic_inputs_;
  std::vector<std::unique_ptr<task::OutputPortBase>> static_outputs_, dynamic_outputs_;
  std::vector<std::unique_ptr<task::DynamicProperty>> properties_;
  std::vector<std::unique_ptr<task::DynamicOperation>> operations_;
  task::DynamicProperty* behaviour_property_ = nullptr;
  /// A copy of `now_.hangs("operation")`, since operations may run in their callers' threads. Relaxed: these
  /// read nothing else.
  std::atomic<bool> operations_hang_;
  TimePoint last_write_{};
  Duration interval_ = kShortestInterval;
};

StandIn::StandIn(const StandInPlan& plan)
    : Component(options_of(plan)),
      defaults_(plan.behaviour),
      now_(plan.behaviour),
      model_(plan.model == nullptr ? std::nullopt : std::optional(*plan.model)),
      types_(plan.types),
      expected_(plan.ports),
      operations_hang_(plan.behaviour.hangs("operation")) {
  set_component_name(plan.component.str());
  add_properties(plan);
  if (model_) {
    for (const auto& name : model_->nominal_states)
      nominal_states_.emplace_back(*this, name);
    for (const auto& name : model_->error_states)
      error_states_.emplace_back(*this, name);
    for (const auto& port : model_->ports) {
      if (!port.dynamic && !port.pattern) add_port(port);
    }
    for (const auto& operation : model_->operations)
      add_operation(operation, types_);
  }
  for (const auto& port : expected_) {
    const auto found = model_for(port);
    if (found && !found->dynamic) add_port(*found);
  }
}

std::optional<model::PortModel> StandIn::model_for(const ExpectedPort& port) const {
  const model::PortModel* known = model_ ? model_->find_port(port.name, port.direction) : nullptr;
  model::PortModel made;
  if (known != nullptr) {
    made = *known;
    made.dynamic = known->dynamic || known->pattern;
  } else if (model_ && !model_->incomplete) {
    return std::nullopt;
  }
  made.name = port.name;
  made.direction = port.direction;
  return made;
}

void StandIn::add_port(const model::PortModel& port) {
  if (has_port(*this, {port.name, port.direction})) {
    return;
  }
  const auto* info = port.type.empty() ? nullptr : type::find_type_info(port.type);
  task::PortOptions options;
  options.dynamic = port.dynamic;
  options.doc = port.doc;
  if (port.direction == model::Direction::Input) {
    (port.dynamic ? dynamic_inputs_ : static_inputs_)
        .push_back(std::make_unique<task::InputPortBase>(*this, port.name, info, port.type, options));
  } else {
    (port.dynamic ? dynamic_outputs_ : static_outputs_)
        .push_back(std::make_unique<task::OutputPortBase>(*this, port.name, info, port.type, options));
  }
}

void StandIn::add_properties(const StandInPlan& plan) {
  std::set<std::string> names{std::string(kStandInProperty)};
  const auto add = [&](const std::string& name, const std::string& type_name, type::Value value,
                       task::PropertyOptions options, task::DynamicProperty::Check check) {
    const type::Type* type = type_named(type_name, types_);
    const bool is_compound = type != nullptr && type->resolved().kind == type::TypeKind::Compound;
    properties_.push_back(std::make_unique<task::DynamicProperty>(
        *this, name, type_name, std::move(value), std::move(options), std::move(check), is_compound));
  };
  add(std::string(kStandInProperty), "", type::ValueMap{}, {true, "how this stand-in behaves"},
      check_behaviour);
  behaviour_property_ = properties_.back().get();
  static const std::vector<model::PropertyModel> kNone;
  for (const auto& property : model_ ? model_->properties : kNone) {
    if (!names.insert(property.name).second) continue;
    const bool has_default = !property.default_value.is_null();
    add(property.name, property.type,
        has_default ? property.default_value : initial_value(property.type, types_),
        {property.live, property.doc}, check_against(type_named(property.type, types_)));
  }
  for (const auto& name : plan.properties) {
    if (names.insert(name).second) add_unknown_property(name);
  }
}

void StandIn::add_operation(const model::OperationModel& operation, const type::TypeRegistry* types) {
  task::OperationInfo info;
  info.name = operation.name;
  for (const auto& argument : operation.arguments) {
    info.arguments.push_back({argument.name, nullptr, argument.type});
  }
  info.result = operation.result;
  info.runs_in = operation.caller_thread ? task::RunsIn::CallerThread : task::RunsIn::TaskThread;
  info.doc = operation.doc;
  const type::Value result = initial_value(operation.result, types);
  operations_.push_back(std::make_unique<task::DynamicOperation>(
      *this, std::move(info),
      [this, result](const std::vector<type::Value>& /*arguments*/) -> Result<type::Value> {
        if (operations_hang_.load(std::memory_order_relaxed)) hang();
        return result;
      }));
}

Result<void> StandIn::grow(const ExpectedPort& port, bool configured) {
  const Lock lock(ports_mutex_);
  if (has_port(*this, port)) {
    return {};
  }
  const auto made = model_for(port);
  const std::string direction(port.direction == model::Direction::Input ? "input" : "output");
  if (!made) {
    return fail(ErrorCode::NotFound, "component " + quote(component_name()) + " has no " + direction +
                                         " port " + quote(port.name) + " in its model");
  }
  if (std::find(expected_.begin(), expected_.end(), port) == expected_.end()) {
    expected_.push_back(port);
  }
  if (made->dynamic && !configured) {
    return fail(ErrorCode::InvalidState, direction + " port " + quote(port.name) +
                                             " is dynamic: it exists once its task is configured");
  }
  add_port(*made);
  return {};
}

Result<void> StandIn::pass(Duration StandInBehaviour::*time, std::string_view hook) {
  auto behaviour = read_behaviour(behaviour_property_->value(), defaults_, kStandInProperty);
  if (!behaviour) {
    return std::move(behaviour.error());
  }
  now_ = std::move(*behaviour);
  operations_hang_.store(now_.hangs("operation"), std::memory_order_relaxed);
  if (now_.*time > Duration::zero()) {
    std::this_thread::sleep_for(now_.*time);
  }
  if (now_.hangs(hook)) hang();
  if (now_.fails(hook)) {
    return fail(ErrorCode::HookFailed, "stand_in.fail names " + quote(hook));
  }
  return {};
}

Result<void> StandIn::on_configure() {
  if (auto passed = pass(&StandInBehaviour::configure, "configure"); !passed) {
    return passed;
  }
  const Lock lock(ports_mutex_);
  static const std::vector<model::PortModel> kNone;
  for (const auto& port : model_ ? model_->ports : kNone) {
    if (port.dynamic && !port.pattern) add_port(port);
  }
  for (const auto& port : expected_) {
    if (const auto made = model_for(port)) add_port(*made);
  }
  return {};
}

Result<void> StandIn::on_start() {
  if (auto passed = pass(&StandInBehaviour::start, "start"); !passed) {
    return passed;
  }
  // Ten percent of tolerance, so that a periodic task that is called at exactly this rate writes every time.
  interval_ = now_.rate && *now_.rate > 0 ? period_of(*now_.rate) * 9 / 10 : kShortestInterval;
  last_write_ = {};
  return {};
}

void StandIn::on_update() {
  for (auto* input : inputs()) {
    input->drain();
  }
  if (now_.hangs("update")) hang();
  if (now_.fails("update")) {
    exception("stand_in.fail names 'update'");
    return;
  }
  const bool silent = now_.rate && *now_.rate == 0;
  if (silent || (last_write_ != TimePoint{} && now() - last_write_ < interval_)) {
    return;
  }
  last_write_ = now();
  for (auto* output : outputs()) {
    if (output->name() != kStatePort) output->write_default();
  }
}

void StandIn::on_stop() {
  if (auto passed = pass(&StandInBehaviour::stop, "stop"); !passed) {
    throw std::runtime_error(passed.error().message);
  }
}

void StandIn::on_cleanup() {
  const auto passed = pass(&StandInBehaviour::cleanup, "cleanup");
  {
    const Lock lock(ports_mutex_);
    dynamic_inputs_.clear();
    dynamic_outputs_.clear();
  }
  if (!passed) {
    throw std::runtime_error(passed.error().message);
  }
}

/// Arrays of arrays and compounds of compounds may describe more values than there is memory.
constexpr std::size_t kMostItems = 4096;

type::Value default_of(const type::Type& type, std::size_t& budget);

type::Value default_compound(const type::Type& type, std::size_t& budget) {
  type::ValueMap map;
  for (const auto& field : type.fields) {
    if (field.type != nullptr) map.set(field.name, default_of(*field.type, budget));
  }
  return map;
}

type::Value default_array(const type::Type& type, std::size_t& budget) {
  type::Value::List list;
  for (std::size_t item = 0; item < type.count && type.element != nullptr && budget > 0; ++item) {
    list.push_back(default_of(*type.element, budget));
  }
  return list;
}

type::Value default_number(const type::Type& type) {
  if (type.category == type::NumericCategory::Bool) return false;
  if (type.category == type::NumericCategory::Float) return 0.0;
  return 0;
}

type::Value default_of(const type::Type& declared, std::size_t& budget) {
  if (budget == 0) {
    return {};
  }
  --budget;
  const type::Type& type = declared.resolved();
  switch (type.kind) {
    case type::TypeKind::Numeric:
      return default_number(type);
    case type::TypeKind::Enum:
      return type.symbols.empty() ? type::Value{} : type::Value(type.symbols.front().name);
    case type::TypeKind::Compound:
      return default_compound(type, budget);
    case type::TypeKind::Array:
      return default_array(type, budget);
    case type::TypeKind::Container:
      if (type.is_string()) return "";
      return type.is_optional() ? type::Value{} : type::Value(type::Value::List{});
    case type::TypeKind::Opaque:
      return type.element == nullptr ? type::Value{} : default_of(*type.element, budget);
    default:
      return {};
  }
}

}  // namespace

std::unique_ptr<task::Component> make_stand_in(const StandInPlan& plan) {
  return std::make_unique<StandIn>(plan);
}

bool is_stand_in(const task::Component& component) {
  return dynamic_cast<const StandIn*>(&component) != nullptr;
}

Result<void> grow_port(task::Component& stand_in, const ExpectedPort& port, bool configured) {
  return dynamic_cast<StandIn&>(stand_in).grow(port, configured);
}

std::vector<std::string> missing_properties(const task::Component& component,
                                            const std::vector<std::string>& names) {
  std::vector<std::string> missing;
  for (const auto& name : names) {
    if (component.find_property(name) == nullptr) missing.push_back(name);
  }
  return missing;
}

void add_properties(task::Component& stand_in, const std::vector<std::string>& names) {
  for (const auto& name : names) {
    dynamic_cast<StandIn&>(stand_in).add_unknown_property(name);
  }
}

Activity stand_in_activity(const model::ComponentModel* model, const StandInBehaviour& behaviour) {
  Activity activity = model == nullptr ? Activity{} : model->activity;
  const bool has_inputs = model != nullptr && std::any_of(model->ports.begin(), model->ports.end(),
                                                          [](const model::PortModel& port) {
                                                            return port.direction == model::Direction::Input;
                                                          });
  const bool rate_given = behaviour.rate && *behaviour.rate > 0;
  if (activity.trigger == Trigger::PortDriven && has_inputs && !rate_given) {
    return activity;
  }
  const bool follows_model = activity.trigger == Trigger::Periodic && activity.period > Duration::zero();
  if (!follows_model || rate_given) {
    activity.period = period_of(rate_given ? *behaviour.rate : kDefaultRate);
  }
  activity.trigger = Trigger::Periodic;
  return activity;
}

type::Value default_value(const type::Type* type) {
  std::size_t budget = kMostItems;
  return type == nullptr ? type::Value{} : default_of(*type, budget);
}

}  // namespace segue::task_host
