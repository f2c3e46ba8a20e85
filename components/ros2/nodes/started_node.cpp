// SPDX-License-Identifier: Apache-2.0
#include "started_node.hpp"

#include "installation.hpp"

#include <segue/base/mutex.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/parameter_value.hpp>

#include <algorithm>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

namespace ros2 {
namespace {

using segue::ErrorCode;
using segue::fail;
using segue::quote;
using segue::Result;
using segue::type::Value;

struct NodeName {
  std::string name_space;
  std::string name;
};

NodeName split(const std::string& node) {
  const auto slash = node.rfind('/');
  if (slash == std::string::npos) return {"/", node};
  return {slash == 0 ? "/" : node.substr(0, slash), node.substr(slash + 1)};
}

/// The name of a file, which is none in another folder.
bool is_name(const std::string& text) {
  return !text.empty() && text.find('/') == std::string::npos && text != "." && text != "..";
}

/// "rclcpp_components/component_container" as package and program.
std::pair<std::string, std::string> program_of_container(const std::string& text) {
  const auto slash = std::min(text.find('/'), text.size());
  return {text.substr(0, slash), text.substr(std::min(slash + 1, text.size()))};
}

/// A node's name as arguments of its program.
std::vector<std::string> naming(const std::string& node) {
  const NodeName name = split(node);
  return {"--ros-args", "-r", "__node:=" + name.name, "-r", "__ns:=" + name.name_space};
}

/// So that the node looks for others where this process does, whatever the environments say.
void set_discovery(const Settings& settings, Installation& installation) {
  constexpr const char* kSwitch = "ROS_LOCALHOST_ONLY";
  constexpr const char* kRange = "ROS_AUTOMATIC_DISCOVERY_RANGE";
  constexpr const char* kPeers = "ROS_STATIC_PEERS";
  std::string peers;
  for (const std::string& peer : settings.static_peers)
    peers += (peers.empty() ? "" : ";") + peer;
  // Before Iron there is the switch only; from then on static peers do not count with it.
  const bool switched = settings.range == Range::Localhost && peers.empty();
  installation.set_variable("ROS_DOMAIN_ID", std::to_string(settings.domain));
  if (switched || installation.variable(kSwitch) == "1")
    installation.set_variable(kSwitch, switched ? "1" : "0");
  if (settings.range != Range::Subnet) {
    installation.set_variable(kRange, settings.range == Range::Localhost ? "LOCALHOST" : "OFF");
  } else if (const auto range = installation.variable(kRange); range == "LOCALHOST" || range == "OFF") {
    installation.set_variable(kRange, "SUBNET");
  }
  if (installation.variable(kPeers) != peers) installation.set_variable(kPeers, peers);
}

Result<std::unique_ptr<NodeProcess>> start_program(const Settings& settings, const ProcessSettings& process,
                                                   const std::pair<std::string, std::string>& program,
                                                   std::vector<std::string> arguments,
                                                   std::string parameters) {
  auto installation = find_installation(process.installation);
  if (!installation) return installation.error();
  auto path = installation->find_program(program.first, program.second);
  if (!path) return path.error();
  set_discovery(settings, *installation);
  return NodeProcess::start(
      {std::move(*path), std::move(arguments), std::move(installation->environment), std::move(parameters)});
}

Result<std::shared_ptr<NodeProcess>> start_own(const Settings& settings, const NodeStart& start) {
  std::vector<std::string> arguments = start.process.arguments;
  const auto named = naming(start.name);
  arguments.insert(arguments.end(), named.begin(), named.end());
  for (const std::string& remapping : start.process.remappings)
    arguments.insert(arguments.end(), {"-r", remapping});
  const bool has_parameters = start.parameters.is_map() && !start.parameters.as_map().empty();
  auto process = start_program(
      settings, start.process, {start.process.package, start.process.executable}, std::move(arguments),
      has_parameters ? segue::ros2::parameter_file(start.name, start.parameters) : std::string());
  if (!process) return process.error();
  return std::shared_ptr<NodeProcess>(std::move(*process));
}

struct Container {
  std::weak_ptr<NodeProcess> process;
  std::uint64_t seen_before = 0;  ///< StartedNode::seen_before()
};

/// Those that this process has started, by their names.
struct Containers {
  segue::Mutex mutex;
  std::map<std::string, Container> all SEGUE_GUARDED_BY(mutex);
};

Containers& containers() {
  static Containers all;
  return all;
}

/// That of others of this process, or a new one; `seen_before` is that of its process.
Result<std::shared_ptr<NodeProcess>> share_container(const Settings& settings, const ProcessSettings& wanted,
                                                     std::uint64_t& seen_before) {
  Containers& known = containers();
  const segue::Lock lock(known.mutex);
  Container& container = known.all[wanted.container];
  if (auto running = container.process.lock(); running && running->end().empty()) {
    seen_before = container.seen_before;
    return running;
  }
  auto process = start_program(settings, wanted, program_of_container(wanted.container_program),
                               naming(wanted.container), "");
  if (!process) return process.error();
  std::shared_ptr<NodeProcess> shared(std::move(*process));
  container = {shared, seen_before};
  return shared;
}

Value texts(const std::vector<std::string>& all) {
  return Value(Value::List(all.begin(), all.end()));
}

}  // namespace

Result<void> check(const ProcessSettings& process) {
  const auto wrong = [](const std::string& text) {
    return fail(ErrorCode::InvalidArgument, "process: " + text);
  };
  if (process.is_empty()) {
    if (process == ProcessSettings{}) return {};
    return wrong("it has no package");
  }
  if (process.executable.empty() == process.component.empty())
    return wrong("either an executable or a component of package " + process.package + " is expected");
  if (process.component.empty() != process.container.empty())
    return wrong("a component needs a container, and a container a component");
  const auto container = program_of_container(process.container_program);
  for (const auto& [name, is_used] :
       {std::pair(&process.package, true), std::pair(&process.executable, !process.executable.empty()),
        std::pair(&container.first, !process.container_program.empty()),
        std::pair(&container.second, !process.container_program.empty())}) {
    if (is_used && !is_name(*name))
      return wrong(quote(*name) + " is not a valid name of a package or a program");
  }
  for (const std::string& remapping : process.remappings) {
    if (remapping.find(":=") == std::string::npos)
      return wrong("remapping " + quote(remapping) + ": expected FROM:=TO");
  }
  return {};
}

Result<std::unique_ptr<StartedNode>> StartedNode::start(const std::shared_ptr<Participant>& participant,
                                                        const NodeStart& start, segue::TimePoint deadline) {
  std::unique_ptr<StartedNode> made(new StartedNode);
  const bool is_loaded = !start.process.container.empty();
  if (!is_loaded || !start.process.container_program.empty()) {
    made->seen_before_ = participant->graph().seen_so_far();
    auto process = is_loaded ? share_container(participant->settings(), start.process, made->seen_before_)
                             : start_own(participant->settings(), start);
    if (!process) return process.error();
    made->process_ = std::move(*process);
  }
  if (!is_loaded) return made;
  if (auto loaded = made->load(participant, start, deadline); !loaded) return loaded.error();
  return made;
}

Result<void> StartedNode::load(const std::shared_ptr<Participant>& participant, const NodeStart& start,
                               segue::TimePoint deadline) {
  segue::ros2::InterfaceLibrary library;
  const std::string& container = start.process.container;
  for (auto& [requester, name, interface] :
       {std::tuple(&load_, "load_node", "LoadNode"), std::tuple(&unload_, "unload_node", "UnloadNode")}) {
    auto made = Requester::make(participant, library, container + "/_container/" + name,
                                std::string("composition_interfaces/srv/") + interface);
    if (!made) return made.error();
    *requester = std::move(*made);
    (*requester)->allow(true);
  }
  const NodeName name = split(start.name);
  watch([this] { load_->allow(false); });
  auto response = load_->call(Value::map({{"package_name", start.process.package},
                                          {"plugin_name", start.process.component},
                                          {"node_name", name.name},
                                          {"node_namespace", name.name_space},
                                          {"remap_rules", texts(start.process.remappings)},
                                          {"parameters", *start.request.find("parameters")}}),
                              deadline);
  stop_watching();
  if (const std::string ended = end(); !ended.empty())
    return fail(ErrorCode::InvalidState, "container " + container + " " + ended);
  if (!response) return response.error();
  if (!response->find("success")->as_bool()) {
    return fail(ErrorCode::InvalidState, "container " + container + " does not load " +
                                             start.process.component + ": " +
                                             response->find("error_message")->as_string());
  }
  loaded_ = static_cast<std::uint64_t>(response->find("unique_id")->as_uint());
  return {};
}

Result<void> StartedNode::unload(segue::TimePoint deadline) {
  if (!loaded_ || !end().empty()) return {};
  const Value request = Value::map({{"unique_id", *std::exchange(loaded_, std::nullopt)}});
  watch([this] { unload_->allow(false); });
  auto response = unload_->call(request, deadline);
  stop_watching();
  if (!end().empty()) return {};
  if (!response) return response.error();
  if (response->find("success")->as_bool()) return {};
  return fail(ErrorCode::InvalidState,
              "its container does not unload it: " + response->find("error_message")->as_string());
}

StartedNode::~StartedNode() {
  stop_watching();
}

std::string StartedNode::end() const {
  return process_ ? process_->end() : std::string();
}

/// The process where nobody else of this process is in it; else that goes on without this node.
std::shared_ptr<NodeProcess> StartedNode::leave_process() {
  Containers& known = containers();
  const segue::Lock lock(known.mutex);
  std::shared_ptr<NodeProcess> process = std::exchange(process_, nullptr);
  if (process.use_count() > 1) return nullptr;
  std::erase_if(known.all, [&](const auto& each) { return each.second.process.lock() == process; });
  return process;
}

Result<void> StartedNode::finish(segue::TimePoint deadline) {
  auto unloaded = unload(deadline);
  if (process_ == nullptr) return unloaded;
  const auto process = leave_process();
  auto finished = process == nullptr ? Result<void>() : process->finish(deadline);
  return unloaded ? finished : unloaded;
}

void StartedNode::watch(std::function<void()> ended) {
  if (process_) process_->watch(this, std::move(ended));
}

void StartedNode::stop_watching() {
  if (process_) process_->stop_watching(this);
}

int StartedNode::descriptor() const {
  return process_ ? process_->descriptor() : -1;
}

}  // namespace ros2
