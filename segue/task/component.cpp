// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/task/component.hpp>
#include <segue/task/held_ports.hpp>
#include <segue/task/realtime_log.hpp>

#include <algorithm>
#include <cassert>
#include <functional>

namespace segue::task {

namespace {

template <class Named>
Named* find_named(const std::vector<Named*>& all, std::string_view name) {
  const auto found = std::ranges::find_if(all, [&](const Named* one) { return one->name() == name; });
  return found == all.end() ? nullptr : *found;
}

}  // namespace

Component::Component(const ComponentOptions& options) : options_(options) {}
Component::~Component() = default;

std::vector<InputPortBase*> Component::inputs() const {
  const Lock lock(ports_mutex_);
  return inputs_;
}

std::vector<OutputPortBase*> Component::outputs() const {
  const Lock lock(ports_mutex_);
  return outputs_;
}

InputPortBase* Component::find_input(std::string_view name) const {
  const Lock lock(ports_mutex_);
  return find_named(inputs_, name);
}

OutputPortBase* Component::find_output(std::string_view name) const {
  const Lock lock(ports_mutex_);
  return find_named(outputs_, name);
}

HeldPorts::HeldPorts(const Component& component, const Component& other) SEGUE_UNCHECKED_LOCKS
    : first_(std::min(&component, &other, std::less<>())->ports_mutex_),
      second_(std::max(&component, &other, std::less<>())->ports_mutex_) {
  first_.lock();
  if (&second_ != &first_) second_.lock();
}

/// Unchecked: both mutexes may be one.
HeldPorts::~HeldPorts() SEGUE_UNCHECKED_LOCKS {
  if (&second_ != &first_) second_.unlock();
  first_.unlock();
}

InputPortBase* HeldPorts::find_input(const Component& component, std::string_view name) const {
  return find_named(inputs(component), name);
}

OutputPortBase* HeldPorts::find_output(const Component& component, std::string_view name) const {
  return find_named(outputs(component), name);
}

PropertyBase* Component::find_property(std::string_view name) const {
  return find_named(properties_, name);
}

OperationBase* Component::find_operation(std::string_view name) const {
  return find_named(operations_, name);
}

Result<void> Component::on_configure() {
  return {};
}
Result<void> Component::on_start() {
  return {};
}
void Component::on_update() {}
void Component::on_error() {}
void Component::on_stop() {}
void Component::on_cleanup() {}
Result<void> Component::on_recover() {
  return {};
}

std::optional<SavedState> Component::save_state() {
  return std::nullopt;
}

Result<void> Component::restore_state(const SavedState& state) {
  return fail(ErrorCode::Unsupported, "component " + quote(component_name_) +
                                          " cannot take over the state of another task; it got " +
                                          quote(state.name) + " version " + std::to_string(state.version));
}

State::State(Component& component, std::string name)
    : component_(component), number_(static_cast<std::uint32_t>(component.nominal_states_.size()) + 1) {
  component.nominal_states_.push_back(std::move(name));
}

void State::enter() const {
  assert(component_.context_ != nullptr);
  component_.context_->set_state(number_);
}

ErrorState::ErrorState(Component& component, std::string name)
    : component_(component), number_(static_cast<std::uint32_t>(component.error_states_.size()) + 1) {
  component.error_states_.push_back(std::move(name));
}

void Component::add_family(PortFamily family) {
  if (family.type != nullptr) type::register_type_info(*family.type);
  families_.push_back(std::move(family));
}

void Component::error(const ErrorState& state, std::string_view message) {
  assert(context_ != nullptr && &state.component_ == this);
  context_->error(state.number_, message);
}

void Component::error(std::string_view message) {
  assert(context_ != nullptr);
  context_->error(0, message);
}

void Component::recovered() {
  assert(context_ != nullptr);
  context_->recovered();
}

void Component::exception(std::string_view message) {
  assert(context_ != nullptr);
  context_->exception(message);
}

void Component::fatal(std::string_view message) {
  assert(context_ != nullptr);
  context_->fatal(message);
}

void Component::log(LogLevel level, std::string_view message) const {
  RealtimeLog::instance().push(
      level, context_ == nullptr ? std::string_view(component_name_) : context_->id(), message);
}

TimePoint Component::now() const {
  assert(context_ != nullptr);
  return context_->now();
}

const std::string& Component::id() const {
  assert(context_ != nullptr);
  return context_->id();
}

Result<void> Component::trigger_fd(int descriptor, std::string_view name) {
  assert(context_ != nullptr);
  return context_->trigger_fd(descriptor, name);
}

}  // namespace segue::task
