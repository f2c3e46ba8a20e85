// SPDX-License-Identifier: Apache-2.0
#include "chain_network.hpp"

#include <segue/base/text.hpp>

#include <deque>
#include <utility>

#include "../output.hpp"

namespace segue::cli {

namespace {

using type::Value;
using Way = std::vector<ChainConnection>;

bool fits(const ChainPort& port, const ChainPort& wanted) {
  return port.task == wanted.task && (wanted.port.empty() || port.port == wanted.port);
}

bool passes(const Way& way, const std::string& task) {
  for (const ChainConnection& connection : way) {
    if (connection.from.task == task) return true;
  }
  return false;
}

}  // namespace

std::string to_string(const ChainPort& port) {
  return port.port.empty() ? port.task : port.task + '.' + port.port;
}

std::string to_string(const ChainConnection& connection) {
  return to_string(connection.from) + " -> " + to_string(connection.to);
}

ChainNetwork::ChainNetwork(const Value& status) {
  for (const Value& task : list_at(status, "tasks")) {
    tasks_[printable_at(task, "id")] = {printable_at(task, "component"), printable_at(task, "host"),
                                        printable_at(task, "process")};
  }
  for (const Value& connection : list_at(status, "connections"))
    connections_.insert({port_in(connection, "from"), port_in(connection, "to")});
}

void ChainNetwork::apply(const Value& transition) {
  std::set<ChainConnection> ended;
  for (const Value& action : list_at(transition, "actions")) {
    const std::string kind = printable_at(action, "kind");
    const Value* definition = action.find("definition");
    if (kind == "apply_config" && definition != nullptr) {
      tasks_[printable_at(action, "task")] = {printable_at(*definition, "component"),
                                              printable_at(action, "host"), printable_at(action, "process")};
    } else if (kind == "disconnect") {
      ended.insert({port_in(action, "from"), port_in(action, "to")});
    }
  }
  // One that is disconnected and connected goes on.
  for (const ChainConnection& connection : ended)
    connections_.erase(connection);
  for (const Value& action : list_at(transition, "actions")) {
    if (printable_at(action, "kind") == "connect")
      connections_.insert({port_in(action, "from"), port_in(action, "to")});
  }
  for (const Value& task : list_at(transition, "removes"))
    tasks_.erase(task.as_string());
  std::erase_if(connections_, [this](const ChainConnection& one) {
    return !tasks_.contains(one.from.task) || !tasks_.contains(one.to.task);
  });
}

const ChainTask* ChainNetwork::task(const std::string& id) const {
  const auto found = tasks_.find(id);
  return found == tasks_.end() ? nullptr : &found->second;
}

Result<ChainPort> ChainNetwork::find(std::string_view text) const {
  for (std::size_t end = text.size(); end != std::string_view::npos && end > 0;
       end = text.rfind('.', end - 1)) {
    const std::string id(text.substr(0, end));
    if (tasks_.contains(id)) return ChainPort{id, std::string(text.substr(std::min(end + 1, text.size())))};
  }
  std::vector<std::string> names;
  for (const auto& [id, task] : tasks_)
    names.push_back(id);
  const std::string task(text.substr(0, text.find('.')));
  return fail(ErrorCode::NotFound, "there is no task " + quote(task) + did_you_mean(task, names));
}

Result<std::vector<Way>> ChainNetwork::chains(const ChainPort& from, const ChainPort& to) const {
  std::vector<Way> found;
  std::deque<Way> begun;  // in the order of their lengths
  for (const ChainConnection& first : connections_) {
    if (fits(first.from, from)) begun.push_back({first});
  }
  constexpr std::size_t kMostSteps = 100'000;
  for (std::size_t step = 0; !begun.empty() && step < kMostSteps && found.size() < kMostChains; ++step) {
    const Way way = std::move(begun.front());
    begun.pop_front();
    const ChainPort& end = way.back().to;
    if (fits(end, to)) found.push_back(way);
    if (end.task == to.task || passes(way, end.task)) continue;
    for (const ChainConnection& next : connections_) {
      if (next.from.task != end.task) continue;
      begun.push_back(way);
      begun.back().push_back(next);
    }
  }
  if (!found.empty()) return found;
  return fail(ErrorCode::NotFound, "no connections lead from " + quote(to_string(from)) + " to " +
                                       quote(to_string(to)) + "; `segue status` shows all connections");
}

/// A port as "task.port", or as a map where its name has a dot.
ChainPort ChainNetwork::port_in(const Value& map, std::string_view key) const {
  const Value* value = map.find(key);
  if (value == nullptr) return {};
  if (value->is_map()) return {printable_at(*value, "task"), printable_at(*value, "port")};
  const std::string text = printable_at(map, key);
  const auto port = find(text);
  return port ? *port : ChainPort{text, {}};
}

}  // namespace segue::cli
