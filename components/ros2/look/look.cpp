// SPDX-License-Identifier: Apache-2.0
#include "look.hpp"
#include "../participant/settings.hpp"
#include "containers.hpp"
#include "local_process.hpp"
#include "node_interview.hpp"

#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/graph_description.hpp>
#include <segue/ros2/node_command.hpp>

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <set>
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

/// The nodes that are named and those that share a participant with them, as components do with their
/// container.
std::set<std::string> with_neighbours(const Look& request, const segue::ros2::GraphSnapshot& graph) {
  std::set<std::string> all(request.nodes.begin(), request.nodes.end());
  for (const auto& participant : graph.participants) {
    std::set<std::string> names;
    for (const auto& node : participant.entities.nodes)
      names.insert(full_name(node));
    if (std::ranges::any_of(request.nodes, [&](const auto& node) { return names.contains(node); }))
      all.merge(names);
  }
  return all;
}

/// Whether all that is asked for has been found.
bool is_found(const Look& request, const Participant& participant) {
  if (request.nodes.empty()) return false;
  const auto graph = participant.graph().snapshot();
  auto missing = with_neighbours(request, graph);
  for (const Value& node : segue::ros2::describe_nodes(graph)) {
    if (node.find("unseen_endpoints")->as_int() == 0) missing.erase(node.find("name")->as_string());
  }
  return missing.empty();
}

/// Of a brief look, when it ends: where nodes have been found, and no more of them or of their topics for a
/// while.
class Quiet {
 public:
  void notice(const segue::ros2::GraphSnapshot& graph) {
    std::size_t nodes = 0;
    for (const auto& participant : graph.participants)
      nodes += participant.entities.nodes.size();
    const std::size_t things = graph.participants.size() + nodes + graph.endpoints.size();
    if (nodes > 0 && things != things_) end_ = segue::Deadline(kWhile);
    things_ = things;
  }
  [[nodiscard]] segue::TimePoint end() const { return end_; }

 private:
  static constexpr std::chrono::milliseconds kWhile{100};
  std::size_t things_ = 0;
  segue::TimePoint end_ = segue::TimePoint::max();
};

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
  Quiet quiet;
  bool found = false;
  {
    const std::stop_callback stopped(stop, notify);
    while (!found && !stop.stop_requested() && segue::monotonic_now() < std::min(end, quiet.end())) {
      {
        const segue::Lock lock(mutex);
        changed.wait_until(mutex, std::min(end, quiet.end()), [&] { return has_changed; });
        has_changed = false;
      }
      if (request.brief) quiet.notice(participant.graph().snapshot());
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

/// Calls it with each number below `count`, in several threads.
void for_each(std::size_t count, const std::function<void(std::size_t)>& function) {
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> threads;
  for (std::size_t i = 0; i < std::min(kThreads, count); ++i) {
    threads.emplace_back([&] {
      for (std::size_t mine = next++; mine < count; mine = next++)
        function(mine);
    });
  }
}

/// The numbers of the containers that are asked. Where two have one name, each would answer as the other.
std::vector<std::size_t> containers_in(const Look& request, const segue::ros2::GraphSnapshot& graph,
                                       const Value::List& nodes) {
  const auto wanted = with_neighbours(request, graph);
  std::vector<std::size_t> containers;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const bool is_wanted =
        request.all || request.containers || wanted.contains(nodes[i].find("name")->as_string());
    if (is_wanted && is_container(nodes[i]) && nodes[i].find("copies")->as_int() == 1)
      containers.push_back(i);
  }
  return containers;
}

/// Asks the containers; a text for each that does not answer.
Value::List ask_containers(const std::vector<std::size_t>& containers, const Interview& interview,
                           Value::List& nodes) {
  const auto name = [&](std::size_t i) { return nodes[containers[i]].find("name")->as_string(); };
  std::vector<Result<Value::List>> answers(containers.size(), Value::List());
  for_each(containers.size(), [&](std::size_t i) { answers[i] = ask_components(interview, name(i)); });
  Value::List problems;
  for (std::size_t i = 0; i < containers.size(); ++i) {
    if (answers[i]) {
      add_components(std::move(*answers[i]), nodes[containers[i]], nodes);
    } else {
      problems.emplace_back(name(i) +
                            " does not tell its components: " + segue::to_string(answers[i].error()));
    }
  }
  return problems;
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
  look.containers = flag("containers");
  look.types = flag("types");
  look.brief = flag("brief");
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
  auto on_this_computer = request.brief ? std::map<std::string, Value>() : processes(graph);
  for (Value& node : nodes) {
    const auto process = on_this_computer.find(node.find("name")->as_string());
    if (process != on_this_computer.end()) node.as_map().set("process", std::move(process->second));
  }
  const Interview interview{*participant, request.patience, request.types, stop};
  auto problems = ask_containers(containers_in(request, graph, nodes), interview, nodes);
  for_each(nodes.size(), [&](std::size_t i) {
    if (is_named(request, nodes[i])) ask(interview, nodes[i].as_map());
  });
  if (stop.stop_requested()) return fail(ErrorCode::Cancelled, "the look was stopped");
  return Value::map({{"domain", std::int64_t{settings->domain}},
                     {"nodes", Value(std::move(nodes))},
                     {"topics", Value(segue::ros2::describe_topics(graph))},
                     {"problems", Value(std::move(problems))}});
}

}  // namespace ros2
