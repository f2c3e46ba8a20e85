// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/base/life_cycle.hpp>
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/task/component_registry.hpp>
#include <segue/task/operation.hpp>
#include <segue/task/port.hpp>
#include <segue/task/property.hpp>
#include <segue/task/state.hpp>
#include <segue/task/sub_state.hpp>
#include <segue/task/typed_port.hpp>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task {

class Component;
class InputTimeout;

/// Dynamic ports whose names match a pattern.
struct PortFamily {
  std::string pattern;
  Direction direction = Direction::Input;
  const type::TypeInfo* type = nullptr;  ///< nullptr: each port has its own
  std::string doc;
};

/// The task as the hooks of its component see it. Tasks implement it.
class TaskContext {
 public:
  [[nodiscard]] virtual const std::string& id() const = 0;
  [[nodiscard]] virtual TimePoint now() const = 0;
  /// Sub-states by their position among those of their kind, from 1; 0: none.
  virtual void set_state(std::uint32_t nominal) = 0;
  virtual void error(std::uint32_t error_state, std::string_view message) = 0;
  virtual void recovered() = 0;
  virtual void exception(std::string_view message) = 0;
  virtual void fatal(std::string_view message) = 0;
  virtual Result<void> trigger_fd(int descriptor, std::string_view descriptor_name) = 0;

 protected:
  ~TaskContext() = default;
};

namespace detail {
/// The default of ComponentOptions::activity: where gcc 12 makes one aggregate in another, it takes members
/// for uninitialized.
inline Activity port_driven() {
  Activity activity;
  return activity;
}
}  // namespace detail

/// Facts about a component that its constructor fixes.
struct ComponentOptions {
  std::string doc{};
  Activity activity = detail::port_driven();  ///< unless the network says otherwise
  std::vector<std::string> claims{};          ///< devices that one configured task at a time may hold
  std::vector<std::string> trigger_on{};   ///< port-driven: inputs that do, unless the network says; else all
  std::vector<std::string> descriptors{};  ///< by name, of trigger_fd(): a network may choose among them
};

/// A unit of robot software: derive, add ports, properties and operations as members, override hooks, and
/// register with SEGUE_COMPONENT. Hooks never run at the same time. on_update and on_error run on the task's
/// executor and must follow the real-time rules; the others run in the thread that asked for the change and
/// may allocate and block. A hook that throws leads to Exception, after on_stop and on_cleanup.
class Component {
 public:
  explicit Component(const ComponentOptions& options = {});
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;
  virtual ~Component();

  /// The parts of the component, in the order of construction. Dynamic ports are created by configure, and
  /// destroyed by cleanup or an exception. Any thread; pointers are valid as long as the port, so outside the
  /// component's own hooks use HeldPorts.
  [[nodiscard]] std::vector<InputPortBase*> inputs() const;
  [[nodiscard]] std::vector<OutputPortBase*> outputs() const;
  [[nodiscard]] InputPortBase* find_input(std::string_view name) const;
  [[nodiscard]] OutputPortBase* find_output(std::string_view name) const;
  /// The dynamic ports that on_configure may create, as the constructor declared them.
  [[nodiscard]] const std::vector<PortFamily>& port_families() const { return families_; }
  [[nodiscard]] const std::vector<PropertyBase*>& properties() const { return properties_; }
  [[nodiscard]] const std::vector<OperationBase*>& operations() const { return operations_; }
  [[nodiscard]] const std::vector<InputTimeout*>& timeouts() const { return timeouts_; }
  [[nodiscard]] PropertyBase* find_property(std::string_view name) const;
  [[nodiscard]] OperationBase* find_operation(std::string_view name) const;

  /// Fixed by the constructor.
  [[nodiscard]] const ComponentOptions& options() const { return options_; }
  [[nodiscard]] const std::vector<std::string>& nominal_states() const { return nominal_states_; }
  [[nodiscard]] const std::vector<std::string>& error_states() const { return error_states_; }
  /// The name under which it is registered; empty if it was not created by the registry.
  [[nodiscard]] const std::string& component_name() const { return component_name_; }
  void set_component_name(std::string name) { component_name_ = std::move(name); }
  /// The task that runs it; nullptr before there is one.
  [[nodiscard]] const TaskContext* context() const { return context_; }

 protected:
  /// PreOperational -> Stopped: apply the configuration, create dynamic ports, open devices.
  virtual Result<void> on_configure();
  /// Stopped -> Running. Gives the descriptors that drive the task (trigger_fd).
  virtual Result<void> on_start();
  virtual void on_update();
  /// Called instead of on_update while in RunTimeError.
  virtual void on_error();
  virtual void on_stop();
  virtual void on_cleanup();
  /// Called before RunTimeError -> Running and Exception -> PreOperational.
  virtual Result<void> on_recover();
  /// The state for the task that takes over from this one (state.hpp); nothing: that task starts afresh.
  /// Called while Stopped. Must not change the component, since it may be started again; an exception has no
  /// consequences for it.
  virtual std::optional<SavedState> save_state();
  /// Takes over the state of another task, after on_configure and before the first start. Must refuse a state
  /// that it does not know (the default refuses all); an error or exception fails the transition.
  virtual Result<void> restore_state(const SavedState& state);

  /// For constructors: declares dynamic ports that on_configure may create. `pattern` is an ECMAScript
  /// regular expression for their whole names; networks are checked against it.
  template <class T>
  void dynamic_inputs(std::string pattern, std::string text = {}) {
    add_family({std::move(pattern), Direction::Input, &type::type_info<T>(), std::move(text)});
  }
  template <class T>
  void dynamic_outputs(std::string pattern, std::string text = {}) {
    add_family({std::move(pattern), Direction::Output, &type::type_info<T>(), std::move(text)});
  }
  /// Ports whose types only the configuration tells.
  void dynamic_ports(Direction direction, std::string pattern, std::string text = {}) {
    add_family({std::move(pattern), direction, nullptr, std::move(text)});
  }

  /// The functions below are for hooks, real-time safe, and require a task.
  /// Enters RunTimeError, with a sub-state of this component or none. For on_start, on_update and on_error.
  void error(const ErrorState& state, std::string_view message);
  void error(std::string_view message);
  /// Returns from RunTimeError to Running. For on_error.
  void recovered();
  /// Enters Exception, or Fatal (which cannot be left), as soon as the hook returns.
  void exception(std::string_view message);
  void fatal(std::string_view message);
  /// To a preallocated ring: of 200 bytes; lines that find it full are lost and counted.
  void log(LogLevel level, std::string_view message) const;
  [[nodiscard]] TimePoint now() const;
  [[nodiscard]] const std::string& id() const;
  /// In on_start: update whenever `descriptor` is readable (a PortDriven task: then, too). Several may be
  /// given; stop forgets them. The component keeps ownership and must not close one before on_stop. Where the
  /// network says which descriptors drive the task, the others are left out. InvalidState: it is Periodic.
  Result<void> trigger_fd(int descriptor, std::string_view name = {});

 private:
  friend class PortBase;
  friend class InputPortBase;
  friend class OutputPortBase;
  friend class PropertyBase;
  friend class InputTimeout;
  friend class OperationBase;
  friend class State;
  friend class ErrorState;
  friend class ComponentAccess;
  friend class HeldPorts;

  void add_family(PortFamily family);

  mutable Mutex ports_mutex_;  ///< guards inputs_ and outputs_; ports leave them before they are destroyed
  std::vector<InputPortBase*> inputs_;
  std::vector<OutputPortBase*> outputs_;
  std::vector<PortFamily> families_;
  std::vector<PropertyBase*> properties_;
  std::vector<InputTimeout*> timeouts_;
  std::vector<OperationBase*> operations_;
  std::vector<std::string> nominal_states_;
  std::vector<std::string> error_states_;
  const ComponentOptions options_;
  std::string component_name_;
  TaskContext* context_ = nullptr;
  /// The state as a number: TaskState; nominal sub-states from 100, error sub-states from 200.
  OutputPort<std::int32_t> state_port_{*this, "state"};
};

inline constexpr std::int32_t kFirstNominalState = 100;
inline constexpr std::int32_t kFirstErrorState = 200;

}  // namespace segue::task

/// Registers a component under its full name ("demo::Filter"). At global scope, in a program or a library.
#define SEGUE_COMPONENT(Type)                                                                        \
  static const ::segue::task::detail::Registration SEGUE_DETAIL_NAME(segue_component_, __COUNTER__){ \
      #Type, ::segue::task::kComponentAbi,                                                           \
      []() -> std::unique_ptr<::segue::task::Component> { return std::make_unique<Type>(); }};
