// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/diagnostic.hpp>
#include <segue/model/component_model.hpp>
#include <segue/model/network.hpp>
#include <segue/model/validate.hpp>

#include <array>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

/// Indices for validation with constant-time look-up. Internal; refer to the network and the catalog.
namespace segue::model::detail {

/// One component's ports and properties by name.
class ComponentIndex {
 public:
  explicit ComponentIndex(const ComponentModel& model);
  [[nodiscard]] const ComponentModel& model() const { return *model_; }
  /// All ports that fit: the static one, or every family whose expression the name matches.
  [[nodiscard]] std::vector<const PortModel*> find_ports(const std::string& name, Direction direction) const;
  [[nodiscard]] const PropertyModel* find_property(const std::string& name) const;
  /// Names for suggestions.
  [[nodiscard]] std::vector<std::string> port_names(Direction direction) const;
  [[nodiscard]] std::vector<std::string> property_names() const;

 private:
  const ComponentModel* model_;
  std::array<std::unordered_map<std::string_view, const PortModel*>, 2> ports_;
  std::array<std::vector<const PortModel*>, 2> families_;
  std::unordered_map<std::string_view, const PropertyModel*> properties_;
};

class NetworkIndex {
 public:
  NetworkIndex(const Network& network, const ComponentCatalog& catalog);

  [[nodiscard]] const Task* task(const TaskId& id) const { return tasks_.find(id); }
  /// The deployment that holds the task, or nullptr: the runtime's own process.
  [[nodiscard]] const Deployment* deployment(const TaskId& id) const;
  [[nodiscard]] const HostName& host(const TaskId& id) const;
  /// nullptr if the component is not known.
  [[nodiscard]] const ComponentIndex* component(const ComponentName& name) const;
  /// ", did you mean 'x'?" for the name of a task; "" after some calls, since it is costly.
  [[nodiscard]] std::string task_suggestion(const std::string& name) const;

 private:
  const Network& network_;
  TaskIndex tasks_;
  std::unordered_map<std::string_view, const Deployment*> deployments_;
  std::unordered_map<ComponentName, ComponentIndex> components_;
  mutable int suggestions_left_ = 20;
};

/// The location of a part of the network; only its file if the line is not known.
SourceLocation place(const SourceLocation& where, const Network& network);

/// Checks names, references and identities, without knowledge of components.
void check_structure(const Network& network, const NetworkIndex& index, Diagnostics& diagnostics);

/// Checks components, ports, types, properties and devices. Without `stands_in` no task is a stand-in.
void check_components(const Network& network, const NetworkIndex& index, const ComponentCatalog& catalog,
                      const StandsIn& stands_in, Diagnostics& diagnostics);

}  // namespace segue::model::detail
