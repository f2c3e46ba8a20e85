// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/network_index.hpp>
#include <segue/type/conform.hpp>

#include <algorithm>
#include <cstdio>
#include <unordered_map>

namespace segue::model::detail {
namespace {

using type::Type;

std::string hexadecimal(std::uint64_t hash) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

class ComponentCheck {
 public:
  ComponentCheck(const Network& network, const NetworkIndex& index, const ComponentCatalog& catalog,
                 const StandsIn& stands_in, Diagnostics& diagnostics)
      : network_(network),
        index_(index),
        catalog_(catalog),
        stands_in_(stands_in),
        diagnostics_(diagnostics) {}

  void run() {
    for (const Task& task : network_.tasks) {
      check_component(task);
      check_properties(task);
      check_triggers(task);
      check_devices(task);
    }
    for (const Connection& connection : network_.connections)
      check_connection(connection);
  }

 private:
  void report(bool only_warning, std::string code, std::string message, const SourceLocation& where) {
    diagnostics_.add({only_warning ? Severity::Warning : Severity::Error, std::move(code), std::move(message),
                      place(where, network_)});
  }

  bool stands_in(const Task& task) const { return stands_in_ && stands_in_(task.component); }

  void check_component(const Task& task) {
    const std::string what = "task " + quote(task.id.str());
    const ComponentIndex* component = index_.component(task.component);
    if (task.component.empty() || stands_in(task)) return;  // the former is a problem of structure
    if (component == nullptr) {
      report(false, "unknown-component",
             what + ": there is no component " + quote(task.component.str()) +
                 component_suggestion(task.component),
             task.where);
    } else if (component->model().abstract) {
      report(false, "abstract-component",
             what + ": component " + quote(task.component.str()) +
                 " is only there to be derived from; use one of those that extend it",
             task.where);
    }
  }

  std::string component_suggestion(const ComponentName& name) {
    const auto [found, fresh] = suggestions_.try_emplace(name);
    if (!fresh) return found->second;
    std::vector<std::string> names;
    for (const ComponentModel* model : catalog_.all())
      names.push_back(model->name.str());
    found->second = names.empty() ? "; no component model is loaded" : did_you_mean(name.str(), names);
    return found->second;
  }

  void check_properties(const Task& task) {
    const ComponentIndex* component = index_.component(task.component);
    if (component == nullptr || !task.properties.is_map()) return;
    const bool is_stand_in = stands_in(task);
    for (const auto& [name, value] : task.properties.as_map()) {
      const PropertyModel* property = component->find_property(name);
      const SourceLocation where = place_of(value, task);
      if (property == nullptr) {
        if (is_stand_in) continue;
        report(component->model().incomplete, "unknown-property",
               "task " + quote(task.id.str()) + ": component " + quote(task.component.str()) +
                   " has no property " + quote(name) + did_you_mean(name, component->property_names()),
               where);
        continue;
      }
      const Type* type = property->type.empty() ? nullptr : catalog_.types().find(property->type);
      if (type == nullptr || (is_stand_in && !type->is_complete())) continue;
      type::check_value(value, *type, task.id.str() + "." + name, where.file, diagnostics_);
    }
  }

  /// A stand-in without a model has the inputs that are connected.
  void check_triggers(const Task& task) {
    const ComponentIndex* component = index_.component(task.component);
    if (component == nullptr || !task.activity) return;
    if (task.activity->trigger == Trigger::FileDescriptorDriven) return check_descriptors(task, *component);
    for (const std::string& port : task.activity->triggers) {
      if (!component->find_ports(port, Direction::Input).empty()) continue;
      report(component->model().incomplete, "unknown-port",
             "task " + quote(task.id.str()) + " is driven by " + quote(port) + ", but component " +
                 quote(task.component.str()) + " has no such input port" +
                 did_you_mean(port, component->port_names(Direction::Input)),
             task.where);
    }
  }

  /// A stand-in without a model names none.
  void check_descriptors(const Task& task, const ComponentIndex& component) {
    const auto& known = component.model().descriptors;
    for (const std::string& name : task.activity->triggers) {
      if (std::ranges::find(known, name) != known.end()) continue;
      report(component.model().incomplete, "unknown-descriptor",
             "task " + quote(task.id.str()) + " is driven by " + quote(name) + ", but component " +
                 quote(task.component.str()) + " names no such file descriptor" + did_you_mean(name, known),
             task.where);
    }
  }

  SourceLocation place_of(const type::Value& value, const Task& task) {
    SourceLocation where = place(task.where, network_);
    if (value.mark().line > 0) {
      where.line = static_cast<int>(value.mark().line);
      where.column = static_cast<int>(value.mark().column);
    }
    return where;
  }

  /// Devices are per host: the same path on another host is another device.
  void check_devices(const Task& task) {
    if (!is_configured(task.state)) return;
    std::vector<std::string> devices = task.exclusive;
    if (const ComponentIndex* component = index_.component(task.component)) {
      const auto& own = component->model().exclusive;
      devices.insert(devices.end(), own.begin(), own.end());
    }
    for (const std::string& device : devices) {
      const auto [first, fresh] = devices_.try_emplace(index_.host(task.id).str() + '\n' + device, &task);
      if (fresh || first->second == &task) continue;
      report(false, "device-conflict",
             "tasks " + quote(first->second->id.str()) + " and " + quote(task.id.str()) + " both claim " +
                 quote(device) + "; let one of them stay pre_operational",
             task.where);
    }
  }

  void check_connection(const Connection& connection) {
    const auto from = find_end(connection.from, Direction::Output, connection);
    const auto to = find_end(connection.to, Direction::Input, connection);
    if (from.empty() || to.empty() || is_undecided(connection, *from.front(), *to.front())) return;
    const bool fits = std::ranges::any_of(from, [&](const PortModel* output) {
      return std::ranges::any_of(to, [&](const PortModel* input) { return same_type(*output, *input); });
    });
    if (!fits) report_mismatch(*from.front(), *to.front(), connection);
  }

  /// A port of a stand-in whose type is not known to this program has none, and fits all.
  bool is_undecided(const Connection& connection, const PortModel& output, const PortModel& input) {
    const bool simulated =
        stands_in(*index_.task(connection.from.task)) || stands_in(*index_.task(connection.to.task));
    return simulated &&
           (catalog_.types().find(output.type) == nullptr || catalog_.types().find(input.type) == nullptr);
  }

  std::vector<const PortModel*> find_end(const PortRef& end, Direction direction,
                                         const Connection& connection) {
    const Task* task = index_.task(end.task);
    const ComponentIndex* component = task == nullptr ? nullptr : index_.component(task->component);
    if (component == nullptr) return {};
    auto ports = component->find_ports(end.port, direction);
    const bool grows = component->model().incomplete && stands_in(*task);
    if (ports.empty() && !grows) report_unknown_port(end, direction, *component, connection);
    return ports;
  }

  void report_unknown_port(const PortRef& end, Direction direction, const ComponentIndex& component,
                           const Connection& connection) {
    const bool output = direction == Direction::Output;
    const std::string what = "connection " + to_string(connection) + ": ";
    const auto other = component.find_ports(end.port, output ? Direction::Input : Direction::Output);
    if (!other.empty() && !other.front()->pattern) {
      report(false, "wrong-direction",
             what + to_string(end) +
                 (output ? " is an input, but a connection starts at an output"
                         : " is an output, but a connection ends at an input"),
             connection.where);
      return;
    }
    report(component.model().incomplete, "unknown-port",
           what + "component " + quote(component.model().name.str()) + " has no " +
               std::string(to_string(direction)) + " port " + quote(end.port) +
               did_you_mean(end.port, component.port_names(direction)),
           connection.where);
  }

  bool same_type(const PortModel& output, const PortModel& input) {
    if (output.type.empty() || input.type.empty() || output.type == input.type) return true;
    const Type* from = catalog_.types().find(output.type);
    const Type* to = catalog_.types().find(input.type);
    return from != nullptr && to != nullptr && &from->resolved() == &to->resolved();
  }

  void report_mismatch(const PortModel& output, const PortModel& input, const Connection& connection) {
    std::string message = "connection " + to_string(connection) + ": " + to_string(connection.from) + " is " +
                          output.type + ", but " + to_string(connection.to) + " is " + input.type;
    const Type* from = catalog_.types().find(output.type);
    const Type* to = catalog_.types().find(input.type);
    if (from != nullptr && to != nullptr) {
      const auto hash_from = type::structural_hash(*from);
      const auto hash_to = type::structural_hash(*to);
      message += hash_from == hash_to
                     ? " (of the same structure, but another name)"
                     : " (structures " + hexadecimal(hash_from) + " and " + hexadecimal(hash_to) + ")\n" +
                           type::definition(*from) + type::definition(*to);
    }
    while (message.ends_with('\n'))
      message.pop_back();
    report(false, "type-mismatch", std::move(message), connection.where);
  }

  const Network& network_;
  const NetworkIndex& index_;
  const ComponentCatalog& catalog_;
  const StandsIn& stands_in_;
  Diagnostics& diagnostics_;
  std::unordered_map<std::string, const Task*> devices_;
  std::unordered_map<ComponentName, std::string> suggestions_;
};

}  // namespace

void check_components(const Network& network, const NetworkIndex& index, const ComponentCatalog& catalog,
                      const StandsIn& stands_in, Diagnostics& diagnostics) {
  ComponentCheck(network, index, catalog, stands_in, diagnostics).run();
}

}  // namespace segue::model::detail
