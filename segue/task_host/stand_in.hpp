// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/diagnostic.hpp>
#include <segue/base/result.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/task/component.hpp>
#include <segue/type/value.hpp>

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

/// Stand-ins: components that have a component's interface but not its code, so that a network can be run,
/// timed and broken where its components are not installed. A stand-in has the ports, properties and
/// operations of the component's model; without a model it has the ports that connections name, and takes any
/// property.
///
/// A map specifies its behaviour. By default everything takes no time and succeeds:
///
///     stand_in: {configure: 30ms, start: 5ms, stop: 1.3s, cleanup: 2ms, rate: 10, fail: [configure,
///     connect],
///     hang: [update]}
///
/// `configure`, `start`, `stop` and `cleanup` are how long the hooks take. `rate` (Hz) is how often it writes
/// each output port, 0 never; default: the component's period, else 10; a port-driven component of a model
/// writes when it gets a sample. `fail` names what fails: configure, start, stop, cleanup, update, connect.
/// `hang` names what never returns: configure, start, stop, cleanup, update, operation; only the end of the
/// process ends it.
/// The map stands as the reserved property `stand_in` of a task, or per component or task in a stand-in file
/// (the task's own property wins, then the task's entry, then the component's, then `default`):
///
///     stand_ins:
///       default: {configure: 10ms}
///       camera_usb::Task: {stop: 1.3s}
///       velodyne: {rate: 20}
namespace segue::task_host {

/// Name of the reserved property.
inline constexpr std::string_view kStandInProperty = "stand_in";

struct StandInBehaviour {
  Duration configure{0};
  Duration start{0};
  Duration stop{0};
  Duration cleanup{0};
  std::optional<double> rate;     ///< Hz; nothing: by the model
  std::vector<std::string> fail;  ///< of kStandInFailures
  std::vector<std::string> hang;  ///< of kStandInHangs

  friend bool operator==(const StandInBehaviour&, const StandInBehaviour&) = default;
  [[nodiscard]] bool fails(std::string_view what) const;
  [[nodiscard]] bool hangs(std::string_view what) const;
};

inline constexpr std::array<std::string_view, 6> kStandInFailures = {"configure", "start",  "stop",
                                                                     "cleanup",   "update", "connect"};
inline constexpr std::array<std::string_view, 6> kStandInHangs = {"configure", "start",  "stop",
                                                                  "cleanup",   "update", "operation"};

/// The entries of `value` (a map of the same keys) over `base`. Unknown keys, wrong types, negative durations
/// and rates beyond 10 kHz are errors; `path` begins the message.
Result<StandInBehaviour> read_behaviour(const type::Value& value, StandInBehaviour base,
                                        std::string_view path);

/// Behaviours by component name, task id or "default".
class StandInTable {
 public:
  /// Reads the map under `stand_ins`. Reports all problems at once.
  static std::optional<StandInTable> read(const type::Value& document, const std::string& file,
                                          Diagnostics& diagnostics);
  static std::optional<StandInTable> load(const std::filesystem::path& file, Diagnostics& diagnostics);

  void set(std::string name, type::Value behaviour);
  [[nodiscard]] StandInBehaviour of(const model::ComponentName& component, const model::TaskId& task) const;

 private:
  std::map<std::string, type::Value, std::less<>> entries_;
};

/// A port that a connection names.
struct ExpectedPort {
  std::string name;
  model::Direction direction = model::Direction::Input;
  friend auto operator<=>(const ExpectedPort&, const ExpectedPort&) = default;
};

/// The ports of each task that the network's connections name.
std::map<model::TaskId, std::vector<ExpectedPort>> expected_ports(const model::Network& network);

/// The inputs from which a stand-in is created.
struct StandInPlan {
  model::ComponentName component;
  const model::ComponentModel* model = nullptr;  ///< nullptr: not known
  const type::TypeRegistry* types = nullptr;     ///< of the model; must outlive the stand-in
  std::vector<ExpectedPort> ports;               ///< that connections name
  std::vector<std::string> properties;           ///< that the network sets
  StandInBehaviour behaviour;                    ///< before the property `stand_in`
};

/// Creates a stand-in. Its types are the C++ types of this process where they are registered by name; other
/// ports are untyped and carry the name of their type.
std::unique_ptr<task::Component> make_stand_in(const StandInPlan& plan);

[[nodiscard]] bool is_stand_in(const task::Component& component);

/// Adds a port that a connection names to a stand-in that lacks it. A port that matches none of its model (or
/// that cleanup has removed) is an error, unless the model is incomplete or unknown. May be called from any
/// thread. Requires is_stand_in().
Result<void> grow_port(task::Component& stand_in, const ExpectedPort& port, bool configured);

/// The properties among `names` that a component lacks.
std::vector<std::string> missing_properties(const task::Component& component,
                                            const std::vector<std::string>& names);

/// Adds properties to a stand-in, which accept any value and are null at first. Requires is_stand_in(), that
/// it lacks them, and that no other thread reads its properties at the same time.
void add_properties(task::Component& stand_in, const std::vector<std::string>& names);

/// The activity of a stand-in where the network specifies none: that of its model where a stand-in supports
/// it, at the rate of its behaviour.
Activity stand_in_activity(const model::ComponentModel* model, const StandInBehaviour& behaviour);

/// The default value of a type: zero, the first symbol, empty text, no items. Null where the type is not
/// known.
type::Value default_value(const type::Type* type);

}  // namespace segue::task_host
