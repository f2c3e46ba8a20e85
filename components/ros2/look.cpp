// SPDX-License-Identifier: Apache-2.0
#include "look.hpp"
#include "local_process.hpp"
#include "node_interview.hpp"
#include "settings.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/graph_description.hpp>
#include <segue/ros2/node_command.hpp>

#include <algorithm>
#include <atomic>
#include <map>
#include <thread>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::Result;
using segue::type::Value;
using segue::type::ValueMap;

/// So many nodes are asked at a time, so that those that do not answer hold up few others.
constexpr std::size_t kThreads = 8;

bool is_named(const Look& request, const Value& node) {
  return request.all ||
         std::ranges::find(request.nodes, node.find("name")->as_string()) != request.nodes.end();
}

/// Whether all that is asked for has been found.
bool is_found(const Look& request, const Participant& participant) {
  if (request.nodes.empty()) return false;
  std::size_t found = 0;
  for (const Value& node : segue::ros2::describe_nodes(participant.graph().snapshot())) {
    if (is_named(request, node) && node.find("unseen_endpoints")->as_int() == 0) ++found;
  }
  return found >= request.nodes.size();
}

/// False: it was stopped.
bool listen(const Look& request, Participant& participant, const std::stop_token& stop) {
  segue::Mutex mutex;
  segue::ConditionVariable changed;
  bool has_changed = true;
  const auto notify = [&] {
    const segue::Lock lock(mutex);
    has_changed = true;
    changed.notify_all();
  };
  participant.watch(&mutex, notify);
  const segue::TimePoint end = segue::Deadline(request.wait);
  bool found = false;
  {
    const std::stop_callback stopped(stop, notify);
    while (!found && !stop.stop_requested() && segue::monotonic_now() < end) {
      {
        const segue::Lock lock(mutex);
        changed.wait_until(mutex, end, [&] { return has_changed; });
        has_changed = false;
      }
      found = is_found(request, participant);
    }
  }
  participant.stop_watching(&mutex);
  return !stop.stop_requested();
}

Value process_value(pid_t pid, std::int64_t nodes) {
  const auto words = command_of(pid);
  ValueMap map;
  map.set("pid", std::int64_t{pid});
  map.set("nodes", nodes);
  map.set("command", Value::List(words.begin(), words.end()));
  if (auto command = segue::ros2::parse_node_command(words)) {
    map.set("installation", command->installation);
    map.set("package", command->package);
    map.set("executable", command->executable);
    map.set("remappings", Value::List(command->remappings.begin(), command->remappings.end()));
    map.set("arguments", Value::List(command->arguments.begin(), command->arguments.end()));
  }
  return Value(std::move(map));
}

/// The processes of nodes on this computer, by the node's name.
std::map<std::string, Value> processes(const segue::ros2::GraphSnapshot& graph) {
  std::map<std::string, pid_t> found;
  std::map<pid_t, std::int64_t> counts;
  for (const auto& participant : graph.participants) {
    if (participant.entities.nodes.empty()) continue;
    std::optional<pid_t> pid;
    for (const auto& address : participant.addresses) {
      if (!pid) pid = process_at(address);
    }
    for (const auto& node : participant.entities.nodes) {
      if (pid && found.emplace(full_name(node), *pid).second) ++counts[*pid];
    }
  }
  std::map<std::string, Value> all;
  for (const auto& [name, pid] : found)
    all.emplace(name, process_value(pid, counts[pid]));
  return all;
}

void ask_all(const Look& request, const Interview& interview, Value::List& nodes) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < std::min(kThreads, nodes.size()); ++i) {
    threads.emplace_back([&] {
      for (std::size_t mine = next++; mine < nodes.size(); mine = next++) {
        if (is_named(request, nodes[mine])) ask(interview, nodes[mine].as_map());
      }
    });
  }
}

Result<void> check_named(const Look& request, const Value::List& nodes) {
  std::vector<std::string> names;
  for (const Value& node : nodes)
    names.push_back(node.find("name")->as_string());
  for (const std::string& name : request.nodes) {
    if (std::ranges::find(names, name) != names.end()) continue;
    return fail(ErrorCode::NotFound, "no node " + segue::quote(name) +
                                         segue::did_you_mean_or_list(name, names, "there are") +
                                         (names.empty() ? "; no node was found at all" : ""));
  }
  return {};
}

Result<segue::Duration> duration_in(const Value& request, const char* key, segue::Duration without) {
  const Value* text = request.find(key);
  return text == nullptr ? without : segue::parse_duration(text->as_string());
}

}  // namespace

Result<Look> parse_look(const Value& request) {
  Look look;
  const auto wait = duration_in(request, "wait", look.wait);
  if (!wait) return wait.error();
  const auto patience = duration_in(request, "patience", look.patience);
  if (!patience) return patience.error();
  look.wait = *wait;
  look.patience = *patience;
  if (const Value* domain = request.find("domain")) look.domain = static_cast<std::int32_t>(domain->as_int());
  if (const Value* discovery = request.find("discovery")) look.discovery = discovery->as_string();
  if (const Value* nodes = request.find("nodes")) {
    for (const Value& node : nodes->as_list())
      look.nodes.push_back(node.as_string());
  }
  const auto flag = [&](const char* key) {
    return request.find(key) != nullptr && request.find(key)->as_bool();
  };
  look.all = flag("all");
  look.types = flag("types");
  return look;
}

Result<Value> look(const Look& request, const std::stop_token& stop) {
  const auto settings = settings_from(request.domain, request.discovery);
  if (!settings) return settings.error();
  const auto participant = Participant::join(*settings);
  if (!participant) return participant.error();
  if (!listen(request, **participant, stop)) return fail(ErrorCode::Cancelled, "the look was stopped");
  const auto graph = (*participant)->graph().snapshot();
  auto nodes = segue::ros2::describe_nodes(graph);
  if (auto named = check_named(request, nodes); !named) return named.error();
  auto on_this_computer = processes(graph);
  for (Value& node : nodes) {
    const auto process = on_this_computer.find(node.find("name")->as_string());
    if (process != on_this_computer.end()) node.as_map().set("process", std::move(process->second));
  }
  ask_all(request, {*participant, request.patience, request.types, stop}, nodes);
  if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "the look was stopped");
  return Value::map(
      {{"nodes", Value(std::move(nodes))}, {"topics", Value(segue::ros2::describe_topics(graph))}});
}

}  // namespace ros2
