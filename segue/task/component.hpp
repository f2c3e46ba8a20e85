// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/activity.hpp>
#include <segue/base/life_cycle.hpp>
#include <segue/base/log.hpp>
#include <segue/base/result.hpp>
#include <segue/task/component_registry.hpp>
#include <segue/task/operation.hpp>
#include <segue/task/port.hpp>
#include <segue/task/property.hpp>
#include <segue/task/state.hpp>
#include <segue/task/typed_port.hpp>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace segue::task {

class Component;

/// Dynamic ports that have names of a pattern.
struct PortFamily {
  std::string pattern;
  Direction direction = Direction::Input;
  const type::TypeInfo* type = nullptr;
  std::string doc;
};

/// What a component's hooks can ask of the task that runs them. Tasks implement it.
class TaskContext {
 public:
  [[nodiscard]] virtual const std::string& id() const = 0;
  [[nodiscard]] virtual TimePoint now() const = 0;
  virtual void set_state(std::string_view name) = 0;
  virtual void error(std::string_view name, std::string_view message) = 0;
  virtual void recovered() = 0;
  virtual void exception(std::string_view message) = 0;
  virtual void fatal(std::string_view message) = 0;
  virtual Result<void> trigger_fd(int descriptor) = 0;

 protected:
  ~TaskContext() = default;
};

/// A unit of robot software: derive, add ports, properties and operations as members, override hooks, and
/// register with SEGUE_COMPONENT. Hooks never run at the same time. on_update and on_error run on the task's
/// executor and must follow the real-time rules; the others run in the thread that asked for the change and
/// may allocate and block. A hook that throws leads to Exception, after on_stop and on_cleanup.
class Component {
 public:
  Component();
  Component(const Component&) = delete;
  Component& operator=(const Component&) = delete;
  virtual ~Component();

  /// What the component consists of, in the order of construction; dynamic ports come and go with configure
  /// and cleanup, and when the task breaks. Any thread; pointers are valid as long as the port is: outside of
  /// the component's own hooks, use HeldPorts.
  [[nodiscard]] std::vector<InputPortBase*> inputs() const;
  [[nodiscard]] std::vector<OutputPortBase*> outputs() const;
  [[nodiscard]] InputPortBase* find_input(std::string_view name) const;
  [[nodiscard]] OutputPortBase* find_output(std::string_view name) const;
  /// What on_configure may make beyond these, as the constructor declared it.
  [[nodiscard]] const std::vector<PortFamily>& port_families() const { return families_; }
  [[nodiscard]] const std::vector<PropertyBase*>& properties() const { return properties_; }
  [[nodiscard]] const std::vector<OperationBase*>& operations() const { return operations_; }
  [[nodiscard]] PropertyBase* find_property(std::string_view name) const;
  [[nodiscard]] OperationBase* find_operation(std::string_view name) const;

  /// Fixed by the constructor.
  [[nodiscard]] const Activity& default_activity() const { return activity_; }
  [[nodiscard]] const std::vector<std::string>& nominal_states() const { return nominal_states_; }
  [[nodiscard]] const std::vector<std::string>& error_states() const { return error_states_; }
  [[nodiscard]] const std::vector<std::string>& claims() const { return claims_; }
  /// Inputs that trigger a port-driven task; empty: all.
  [[nodiscard]] const std::vector<std::string>& trigger_ports() const { return trigger_ports_; }
  [[nodiscard]] const std::string& doc() const { return doc_; }
  /// The name it is registered under; empty if it was not made through the registry.
  [[nodiscard]] const std::string& component_name() const { return component_name_; }
  void set_component_name(std::string name) { component_name_ = std::move(name); }
  /// The task that runs it; nullptr before there is one.
  [[nodiscard]] const TaskContext* context() const { return context_; }

 protected:
  /// PreOperational -> Stopped: take the configuration, make dynamic ports, open devices.
  virtual Result<void> on_configure();
  /// Stopped -> Running. Descriptors that drive the task are named here (trigger_fd).
  virtual Result<void> on_start();
  virtual void on_update();
  /// Instead of on_update while in RunTimeError.
  virtual void on_error();
  virtual void on_stop();
  virtual void on_cleanup();
  /// Before RunTimeError -> Running and Exception -> PreOperational.
  virtual Result<void> on_recover();
  /// What the task that takes over from this one shall know (state.hpp); nothing: it begins afresh. While
  /// Stopped. Must leave the component as it is, since it may be started again: a throw does no harm.
  virtual std::optional<State> save_state();
  /// Before the first start, when on_configure is done: the state of the task that this one continues.
  /// Refuses what it does not know (the default: everything); a refusal or throw fails the transition.
  virtual Result<void> restore_state(const State& state);

  /// For constructors.
  void default_activity(Activity activity) { activity_ = std::move(activity); }
  void declare_states(std::vector<std::string> nominal, std::vector<std::string> error = {});
  void claims(std::vector<std::string> devices) { claims_ = std::move(devices); }
  void trigger_on(std::vector<std::string> inputs) { trigger_ports_ = std::move(inputs); }
  void doc(std::string text) { doc_ = std::move(text); }
  /// Dynamic ports that on_configure may make: `pattern` is an ECMAScript regular expression that their whole
  /// names match. Networks are checked against it.
  template <class T>
  void dynamic_inputs(std::string pattern, std::string text = {}) {
    add_family({std::move(pattern), Direction::Input, &type::type_info<T>(), std::move(text)});
  }
  template <class T>
  void dynamic_outputs(std::string pattern, std::string text = {}) {
    add_family({std::move(pattern), Direction::Output, &type::type_info<T>(), std::move(text)});
  }

  /// For hooks; real-time safe. Require a task.
  /// A declared nominal sub-state of Running; "" is plain Running.
  void set_state(std::string_view name);
  /// To RunTimeError with a declared sub-state ("" for none). For on_start, on_update and on_error.
  void error(std::string_view name, std::string_view message);
  /// Back from RunTimeError to Running. For on_error.
  void recovered();
  /// To Exception, or to Fatal (which nothing leaves), as soon as the hook returns.
  void exception(std::string_view message);
  void fatal(std::string_view message);
  /// Into a preallocated ring; longer messages are cut at 200 bytes, and lines are counted where the ring is
  /// full.
  void log(LogLevel level, std::string_view message) const;
  [[nodiscard]] TimePoint now() const;
  [[nodiscard]] const std::string& id() const;
  /// FileDescriptorDriven, in on_start: update whenever `descriptor` is readable. Several may be named; they
  /// are forgotten at stop. The component keeps owning it and must not close it before on_stop.
  Result<void> trigger_fd(int descriptor);

 private:
  friend class PortBase;
  friend class InputPortBase;
  friend class OutputPortBase;
  friend class PropertyBase;
  friend class OperationBase;
  friend class ComponentAccess;
  friend class HeldPorts;

  void add_family(PortFamily family);

  mutable std::mutex ports_mutex_;  ///< of the two lists; ports leave them before they go
  std::vector<InputPortBase*> inputs_;
  std::vector<OutputPortBase*> outputs_;
  std::vector<PortFamily> families_;
  std::vector<PropertyBase*> properties_;
  std::vector<OperationBase*> operations_;
  std::vector<std::string> nominal_states_;
  std::vector<std::string> error_states_;
  std::vector<std::string> claims_;
  std::vector<std::string> trigger_ports_;
  Activity activity_;
  std::string doc_;
  std::string component_name_;
  TaskContext* context_ = nullptr;
  /// Every component's state as a number: TaskState, nominal sub-states from 100, error ones from 200.
  OutputPort<std::int32_t> state_port_{*this, "state"};
};

inline constexpr std::int32_t kFirstNominalState = 100;
inline constexpr std::int32_t kFirstErrorState = 200;

}  // namespace segue::task

/// Offers a component under its full name ("demo::Filter"). At global scope, in a program or a library.
#define SEGUE_COMPONENT(Type)                                                                     \
  static const ::segue::task::detail::Registration SEGUE_DETAIL_NAME(segue_component_, __LINE__){ \
      #Type, ::segue::task::kComponentAbi,                                                        \
      []() -> std::unique_ptr<::segue::task::Component> { return std::make_unique<Type>(); }};
#define SEGUE_DETAIL_NAME(name, line) SEGUE_DETAIL_JOIN(name, line)
#define SEGUE_DETAIL_JOIN(name, line) name##line
