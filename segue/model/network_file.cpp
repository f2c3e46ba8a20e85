// SPDX-License-Identifier: Apache-2.0
#include <segue/base/input_file.hpp>
#include <segue/base/sha256.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/files.hpp>
#include <segue/model/network_sources.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <unordered_set>
#include <utility>

namespace segue::model {

using detail::Fields;
using detail::Source;
using type::Value;
using type::ValueMap;

namespace {

/// `tasks: [velodyne, xsens]` or `tasks: {velodyne: name_in_the_process}`.
std::vector<Placement> read_placements(Fields& fields, const Source& source) {
  std::vector<Placement> result;
  const Value* value = fields.find("tasks");
  if (value == nullptr) return result;
  if (value->is_map()) {
    for (const auto& [task, name_value] : value->as_map()) {
      std::string name = name_value.is_null() ? task : detail::scalar_text(name_value).value_or("");
      detail::check_name(name, fields.what() + ": task " + quote(task), name_value, source);
      result.push_back({TaskId(task), std::move(name)});
    }
    return result;
  }
  for (const std::string& task : fields.texts("tasks")) {
    detail::check_name(task, fields.what() + ": 'tasks'", *value, source);
    result.push_back({TaskId(task), task});
  }
  return result;
}

Deployment read_deployment(const std::string& key, const Value& value, const Source& source) {
  Fields fields(value, "deployment " + quote(key), source);
  Deployment deployment;
  detail::read_process(fields, deployment, source);
  std::string process = fields.name("process");
  if (process.empty() && fields.find("process") == nullptr) {
    detail::check_name(key, fields.what(), value, source);
    process = key;
  }
  deployment.process = ProcessName(std::move(process));
  deployment.tasks = read_placements(fields, source);
  fields.finish();
  return deployment;
}

/// Expands "a.out -> b.in" to the map that it abbreviates, with source locations.
Value spelled_out(const Value& arrow, const Source& source) {
  constexpr std::string_view kArrow = "->";
  const std::string& text = arrow.as_string();
  const auto at = text.find(kArrow);
  if (at == std::string::npos) {
    source.error("bad-connection",
                 "expected a connection such as 'velodyne.scans -> filter.input', got " + quote(text), arrow);
    return {};
  }
  const auto end_of_from = text.find_last_not_of(' ', at == 0 ? 0 : at - 1);
  const auto start_of_to = text.find_first_not_of(' ', at + kArrow.size());
  Value from(text.substr(0, at == 0 || end_of_from == std::string::npos ? 0 : end_of_from + 1));
  Value to(start_of_to == std::string::npos ? std::string{} : text.substr(start_of_to));
  from.set_mark(arrow.mark());
  to.set_mark(arrow.mark());
  ValueMap ends;
  ends.append("from", std::move(from));
  ends.append("to", std::move(to));
  Value map(std::move(ends));
  map.set_mark(arrow.mark());
  return map;
}

void read_connections(const Value& list, Network& network, const Source& source) {
  network.connections.reserve(list.as_list().size());
  for (const Value& item : list.as_list()) {
    const Value spelled = item.is_string() ? spelled_out(item, source) : Value();
    const Value& map = item.is_string() ? spelled : item;
    if (map.is_null()) continue;
    Fields fields(map, "connection", source);
    if (!fields.is_map()) continue;
    if (auto connection = detail::read_connection(fields, source)) {
      network.connections.push_back(std::move(*connection));
    }
    fields.finish();
  }
}

detail::NetworkPart read_own_network(const Value& root, const Source& source) {
  Fields fields(root, "the network", source);
  Network network;
  network.name = NetworkName(fields.name("network"));
  if (const Value* tasks = fields.find("tasks", Value::Kind::Map)) {
    network.tasks.reserve(tasks->as_map().size());
    for (const auto& [id, value] : tasks->as_map())
      network.tasks.push_back(detail::read_task(id, value, source));
  }
  if (const Value* deployments = fields.find("deployments", Value::Kind::Map)) {
    network.deployments.reserve(deployments->as_map().size());
    for (const auto& [key, value] : deployments->as_map())
      network.deployments.push_back(read_deployment(key, value, source));
  }
  const Value* connections = fields.find("connections");
  if (connections == nullptr || (connections->is_map() && connections->as_map().empty())) {
    // Exporters of other formats write this for no connections.
  } else if (fields.find("connections", Value::Kind::List) != nullptr) {
    read_connections(*connections, network, source);
  }
  auto includes = detail::read_includes(fields, source);
  fields.finish();
  return {std::move(network), std::move(includes)};
}

/// The kind of a file that is not a network, as a sentence that says what to do about it; "" for networks.
std::string other_kind(const Value& root) {
  constexpr std::pair<std::string_view, std::string_view> kKinds[] = {
      {"robot", "this is a robot file, not a network; name a network, such as one of its controllers"},
      {"mission", "this is a mission, not a network"},
      {"transition",
       "this is a transition, not a network; `segue predict` shows the network that it leads to"},
      {"components", "these are component models, not a network"},
      {"component", "this is a component model, not a network"}};
  for (const auto& [key, problem] : kKinds) {
    if (root.find(key) != nullptr && root.find("tasks") == nullptr) return std::string(problem);
  }
  return {};
}

/// Why a file that says nothing of a network is none: as one it would be empty, and take down what runs.
std::string missing_network(const Value& root) {
  constexpr std::string_view kKeys[] = {"network", "tasks", "deployments", "connections", "include"};
  if (root.is_null()) return "this file is empty; a network without tasks says `tasks: {}`";
  const bool says = std::ranges::any_of(kKeys, [&](auto key) { return root.find(key) != nullptr; });
  if (says || !root.is_map()) return {};
  return "this is not a network: it has none of 'network', 'tasks', 'deployments' and 'connections'; one "
         "without "
         "tasks says `tasks: {}`";
}

/// Long enough for the versions of a robot's controllers, short enough to be read.
constexpr std::size_t kVersionDigits = 12;

std::string version_of(std::string_view text) {
  return sha256(text).substr(0, kVersionDigits);
}

Value write_placements(const Deployment& deployment) {
  const bool plain = std::ranges::all_of(
      deployment.tasks, [](const Placement& placement) { return placement.name == placement.task.str(); });
  if (plain) {
    Value::List list;
    list.reserve(deployment.tasks.size());
    for (const Placement& placement : deployment.tasks)
      list.emplace_back(placement.task.str());
    return list;
  }
  ValueMap map;
  for (const Placement& placement : deployment.tasks)
    map.append(placement.task.str(), placement.name);
  return map;
}

Value write_deployments(const Network& network) {
  ValueMap map;
  std::unordered_set<std::string> used;
  for (const Deployment& deployment : network.deployments) {
    std::string key = deployment.process.str();
    for (int i = 2; !used.insert(key).second; ++i)
      key = deployment.process.str() + "-" + std::to_string(i);
    ValueMap entry;
    if (key != deployment.process.str()) entry.append("process", deployment.process.str());
    detail::write_process(entry, deployment);
    if (!deployment.tasks.empty()) entry.append("tasks", write_placements(deployment));
    map.append(std::move(key), std::move(entry));
  }
  return map;
}

Value write_connections(const Network& network) {
  Value::List list;
  list.reserve(network.connections.size());
  for (const Connection& connection : network.connections) {
    ValueMap entry;
    detail::write_connection(entry, connection);
    const bool plain =
        entry.size() == 2 && entry.begin()->second.is_string() && (entry.begin() + 1)->second.is_string();
    list.push_back(plain ? Value(to_string(connection)) : Value(std::move(entry)));
  }
  return list;
}

std::optional<detail::NetworkPart> read_part(std::string_view text, const std::string& file,
                                             Diagnostics& diagnostics) {
  const Source source(file, diagnostics);
  const auto root = source.parse(text);
  if (!root) return std::nullopt;
  auto problem = other_kind(*root);
  if (problem.empty()) problem = missing_network(*root);
  if (!problem.empty()) {
    source.error("no-network", std::move(problem), *root);
    return std::nullopt;
  }
  return detail::is_cnd(*root, file) ? detail::read_cnd(*root, source.foreign())
                                     : read_own_network(*root, source);
}

}  // namespace

Value to_value(const Deployment& deployment) {
  ValueMap entry;
  entry.append("process", deployment.process.str());
  detail::write_process(entry, deployment);
  if (!deployment.tasks.empty()) entry.append("tasks", write_placements(deployment));
  return entry;
}

std::optional<Deployment> read_deployment(const Value& value, const std::string& file,
                                          Diagnostics& diagnostics) {
  Diagnostics found;
  auto deployment = read_deployment(std::string{}, value, Source(file, found));
  const bool good = !found.has_errors();
  diagnostics.append(found);
  return good ? std::optional(std::move(deployment)) : std::nullopt;
}

std::optional<Network> read_network(std::string_view text, const std::string& file, Diagnostics& diagnostics,
                                    const ReadFile& read) {
  const std::size_t errors_before = diagnostics.error_count();
  auto network = read_network_parts(text, file, diagnostics, read);
  return diagnostics.error_count() > errors_before ? std::nullopt : std::move(network);
}

std::optional<Network> read_network_parts(std::string_view text, const std::string& file,
                                          Diagnostics& diagnostics, const ReadFile& read) {
  auto part = read_part(text, file, diagnostics);
  if (!part) return std::nullopt;
  std::string sources(text);
  if (read) {
    detail::NetworkSources others(read, read_part, diagnostics);
    part->network = others.complete(std::move(*part), file);
    sources += others.contents();
  } else if (!part->includes.empty()) {
    diagnostics.error("no-include",
                      "the network includes files, which are not at hand where only its text was passed on; "
                      "pass all of it as one text",
                      part->includes.front().where);
  }
  Network& network = part->network;
  detail::warn_of_sections(network, diagnostics);
  if (network.name.empty()) network.name = NetworkName(detail::name_from_file(file));
  network.file = file;
  network.version = version_of(sources);
  return std::move(network);
}

std::optional<Network> load_network(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto text = detail::read_text(file, diagnostics);
  return text ? read_network(*text, file.string(), diagnostics, read_input_file) : std::nullopt;
}

Value to_value(const Task& task) {
  return detail::write_task(task);
}

std::string write_network(const Network& network) {
  ValueMap root;
  if (!network.name.empty()) root.append("network", network.name.str());
  ValueMap tasks;
  for (const Task& task : network.tasks)
    tasks.append(task.id.str(), detail::write_task(task));
  root.append("tasks", std::move(tasks));
  if (!network.deployments.empty()) root.append("deployments", write_deployments(network));
  if (!network.connections.empty()) root.append("connections", write_connections(network));
  return type::to_yaml(Value(std::move(root)));
}

}  // namespace segue::model
