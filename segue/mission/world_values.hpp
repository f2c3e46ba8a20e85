// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/mission/mission.hpp>
#include <segue/mission/world_view.hpp>
#include <segue/type/value.hpp>

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Data of the world that are values: actions change them as effects (DataChange), and others read them.
/// Since a change says what the new value is made of, a concurrent run hands that on as soon as it is known,
/// before the action has happened: that is the predicted world (Brunner et al. 2019, projection).
namespace segue::mission {

/// By the names of data.
using WorldValues = std::map<std::string, type::Value, std::less<>>;

/// Whether the data are a value, not what functions in Python make of changes of facts.
[[nodiscard]] bool is_value(const DeclaredData& data);

/// The values with which a run begins.
[[nodiscard]] WorldValues initial_values(const Mission& mission);

/// "scene", or "scene.arm.pose": data, and the field that is meant.
struct WorldField {
  std::string_view data;
  std::string_view path;  ///< "arm.pose"; empty: all
};
[[nodiscard]] WorldField world_field(std::string_view text);
/// The same of a placeholder "world.scene.arm"; nothing where it is an input's.
[[nodiscard]] std::optional<WorldField> placeholder_field(std::string_view placeholder);

/// The value of the data or of their field, as a placeholder_field() names it; null where there is none.
[[nodiscard]] type::Value value_of(const type::Value& data, std::string_view placeholder);

/// The placeholders of values in an action: "world.scene" of "{world.scene}" in the arguments of a pool or
/// controller, or in the values of its changes.
[[nodiscard]] std::vector<std::string> world_placeholders(const Action& action);

/// The names of values that an execution of the action looks at, sorted; of all where it reads the world.
[[nodiscard]] std::vector<std::string> values_read(const Mission& mission, const Action& action);
/// The names of values that it may change, sorted.
[[nodiscard]] std::vector<std::string> values_changed(const Action& action);
/// The same with those that it looks at, of an action with world inputs (add_world_inputs()).
[[nodiscard]] std::vector<std::string> values_touched(const Action& action);

/// Gives each action an input (Port::from_world) for each value or field that it looks at, which the engine
/// fills when the action begins.
void add_world_inputs(Mission& mission);

/// The inputs and outputs that the new value consists of.
[[nodiscard]] std::vector<std::string> sources_of(const DataChange& change);
/// Those of all changes of that value, in their order, without duplicates.
[[nodiscard]] std::vector<std::string> sources_of_change(const Action& action, std::string_view data);
/// The value after the changes of an action. `port` is asked for the inputs and outputs above.
[[nodiscard]] type::Value changed_value(const Action& action, std::string_view data, type::Value value,
                                        const std::function<const type::Value&(std::string_view)>& port);

/// A value as it is attached to the world that an action sees.
class ValueData final : public WorldData {
 public:
  explicit ValueData(type::Value value) : value_(std::move(value)) {}
  [[nodiscard]] std::shared_ptr<WorldData> clone() const override {
    return std::make_shared<ValueData>(*this);
  }
  void changed(const std::string& /*fact*/, bool /*holds*/) override {}
  [[nodiscard]] type::Value shown() const override { return value_; }
  [[nodiscard]] const type::Value& value() const { return value_; }

 private:
  type::Value value_;
};

}  // namespace segue::mission
