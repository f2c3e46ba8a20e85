// SPDX-License-Identifier: Apache-2.0
// Stands in for programs of ROS 2 packages in tests and examples; which one, its file's name tells.
//
// talker: a node without a life cycle.
//
// counter: one that publishes the texts "0", "1" and so on on the topic numbers, from when somebody listens.
//
// listener: one that subscribes to the topic words and notes in NAME.heard how many such texts have come, and
// how often one did not follow the one before.
//
// fails: ends with exit status 3 before it is a node.
//
// stubborn: ignores SIGINT and SIGTERM, and has a child in a session of its own.
//
// component_container_isolated: loads managed nodes, and maps PREFIX/lib/libtest_nodes.so as their library.
//
// All others: a managed node. Its parameters:
//   takes: {configure: 0.3}         seconds; also activate, deactivate, cleanup
//   counts_on: /scan, every: 0.01   while it is active, it publishes 1, 2, ... (std_msgs/msg/UInt64) with so
//                                   many seconds between them
//   fails_to_activate: true
//   dies_in_configure: true
//   meets: 12                       it is configured when so many are in configure
//
// Each node notes its arguments and parameters in $NODE_NOTES/NAME, its pid in NAME.pid, and where it is to
// look for others in NAME.discovery, where there is such a folder.
#include "managed_peer.hpp"
#include "sanitizer_options.hpp"
#include "service_peer.hpp"

#include <segue/base/file.hpp>
#include <segue/ros2/parameter_value.hpp>
#include <segue/type/yaml.hpp>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace ros2::testing {
namespace {

namespace fs = std::filesystem;
using segue::type::Value;

struct Arguments {
  std::string name;
  std::string name_space = "/";
  std::string text;
  Value parameters;

  [[nodiscard]] std::string node() const { return (name_space == "/" ? "" : name_space) + "/" + name; }
};

Arguments parse(const std::vector<std::string>& words) {
  Arguments found;
  for (std::size_t i = 0; i < words.size(); ++i) {
    found.text += words[i] + "\n";
    const auto after = [&](const std::string& prefix, std::string& value) {
      if (words[i].starts_with(prefix)) value = words[i].substr(prefix.size());
    };
    after("__node:=", found.name);
    after("__ns:=", found.name_space);
    if (words[i] != "--params-file" || i + 1 == words.size()) continue;
    const Value file = segue::type::parse_yaml(segue::read_file(words[i + 1]).value()).value();
    found.parameters = *file.find(found.node())->find("ros__parameters");
  }
  return found;
}

fs::path notes() {
  return std::getenv("NODE_NOTES");
}

void note(const std::string& name, const std::string& text) {
  if (std::getenv("NODE_NOTES") == nullptr) return;
  std::ofstream(notes() / (name + ".new")) << text;
  fs::rename(notes() / (name + ".new"), notes() / name);
}

void note_node(const Arguments& node) {
  note(node.name + ".pid", std::to_string(::getpid()));
  std::string discovery;
  for (const std::string name :
       {"ROS_DOMAIN_ID", "ROS_AUTOMATIC_DISCOVERY_RANGE", "ROS_LOCALHOST_ONLY", "ROS_STATIC_PEERS"}) {
    const char* value = std::getenv(name.c_str());
    discovery += name + "=" + (value == nullptr ? "" : value) + "\n";
  }
  note(node.name + ".discovery", discovery);
  note(node.name, node.text + (node.parameters.is_null() ? "" : segue::type::to_yaml(node.parameters)));
}

std::uint32_t domain() {
  return static_cast<std::uint32_t>(std::atoi(std::getenv("ROS_DOMAIN_ID")));
}

/// Waits until `count` nodes are in configure at the same time.
void meet(const std::string& name, std::int64_t count) {
  fs::create_directories(notes() / "meeting");
  std::ofstream(notes() / "meeting" / name) << "here";
  while (std::distance(fs::directory_iterator(notes() / "meeting"), fs::directory_iterator()) < count)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
}

std::chrono::duration<double> seconds(const Value& value) {
  return std::chrono::duration<double>(value.as_double());
}

/// Publishes numbers while its node is active.
class Counter {
 public:
  Counter(std::unique_ptr<Peer> peer, const std::string& node, const std::string& topic,
          std::chrono::duration<double> period)
      : peer_(std::move(peer)), thread_([this, period] { count(period); }) {
    peer_->advertise({topic, "std_msgs/msg/UInt64"});
    peer_->announce(node.substr(1));
  }
  ~Counter() {
    ends_ = true;
    thread_.join();
  }
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;
  void set_active(bool active) { active_ = active; }

 private:
  void count(std::chrono::duration<double> period) {
    for (; !ends_; std::this_thread::sleep_for(period)) {
      if (!active_) continue;
      ++number_;
      peer_->publish(codec_.encode(Value::map({{"data", number_}}), "").value());
    }
  }

  segue::ros2::InterfaceLibrary library_;
  const segue::ros2::MessageCodec codec_ =
      segue::ros2::MessageCodec::of(library_, "std_msgs/msg/UInt64").value();
  const std::unique_ptr<Peer> peer_;
  std::int64_t number_ = 0;
  std::atomic<bool> active_{false};
  std::atomic<bool> ends_{false};
  std::thread thread_;
};

Value description_of(const Value& parameter) {
  return Value::map({{"name", *parameter.find("name")}, {"type", *parameter.find("value")->find("type")}});
}

/// The parameters with their names in ROS 2: "takes.configure".
Value with_dots(const Value& parameters) {
  Value flat = Value::map({});
  if (parameters.is_null()) return flat;
  for (const Value& one : parameter_messages(parameters))
    flat.as_map().set(one.find("name")->as_string(), segue::ros2::parameter_from(*one.find("value")));
  return flat;
}

/// A managed node as its parameters say.
class Managed {
 public:
  explicit Managed(const Arguments& node,
                   std::function<std::unique_ptr<Peer>()> make_peer = fast_peers_of_one_node(domain()))
      : name_(node.name),
        parameters_(with_dots(node.parameters)),
        make_peer_(std::move(make_peer)),
        services_(make_peer_, node.node()) {
    note_node(node);
    if (const Value* topic = parameters_.find("counts_on"))
      counter_ = std::make_unique<Counter>(make_peer_(), node.node(), topic->as_string(),
                                           seconds(*parameters_.find("every")));
    peer_ = std::make_unique<ManagedPeer>(
        make_peer_, node.node(), [this](int transition) { enter(transition); }, false);
    services_.serve_parameters([this] { return parameter_messages(parameters_); }, description_of);
    services_.start();
    if (parameters_.find("fails_to_activate") != nullptr)
      peer_->set_fault(ManagedPeer::Fault::FailsToActivate);
  }

 private:
  void enter(int transition) {
    static const std::array<std::string, 5> kNames{"", "configure", "cleanup", "activate", "deactivate"};
    if (counter_ != nullptr && transition == 4) counter_->set_active(false);
    if (const Value* time = parameters_.find("takes." + kNames.at(static_cast<std::size_t>(transition))))
      std::this_thread::sleep_for(seconds(*time));
    if (counter_ != nullptr && transition == 3) counter_->set_active(true);
    if (transition != 1) return;
    if (parameters_.find("dies_in_configure") != nullptr) ::raise(SIGKILL);
    if (const Value* meets = parameters_.find("meets")) meet(name_, meets->as_int());
  }

  const std::string name_;
  const Value parameters_;
  const std::function<std::unique_ptr<Peer>()> make_peer_;
  std::unique_ptr<Counter> counter_;
  std::unique_ptr<ManagedPeer> peer_;
  ServicePeer services_;
};

void wait_for_end() {
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  int number = 0;
  ::sigwait(&signals, &number);
}

int talk(const Arguments& node) {
  const auto peer = make_fast_peer(domain());
  note_node(node);
  peer->announce(node.name);
  wait_for_end();
  note(node.name + ".end", "by SIGINT");
  return 0;
}

int be_stubborn(const Arguments& node) {
  ::signal(SIGINT, SIG_IGN);
  ::signal(SIGTERM, SIG_IGN);
  if (const pid_t child = ::fork(); child == 0) {
    ::setsid();
    note(node.name + ".child", std::to_string(::getpid()));
    ::pause();
  }
  const auto peer = make_fast_peer(domain());
  peer->announce(node.name);
  note_node(node);
  for (;;)
    ::pause();
}

/// The topic of that name, which may be remapped.
TopicOf text_topic(const Arguments& node, const std::string& name) {
  TopicOf topic{"/" + name, "std_msgs/msg/String"};
  topic.quality.depth = 10'000;
  const std::string rule = "\n" + name + ":=";
  if (const auto found = node.text.find(rule); found != std::string::npos) {
    const auto begin = found + rule.size();
    topic.topic = node.text.substr(begin, node.text.find('\n', begin) - begin);
  }
  return topic;
}

/// Whether SIGINT comes within a millisecond.
bool is_asked_to_end() {
  const timespec pause{0, 1'000'000};
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  return ::sigtimedwait(&signals, nullptr, &pause) == SIGINT;
}

segue::ros2::MessageCodec text_codec() {
  segue::ros2::InterfaceLibrary library;
  return segue::ros2::MessageCodec::of(library, "std_msgs/msg/String").value();
}

int count(const Arguments& node) {
  const auto peer = make_fast_peer(domain());
  const auto codec = text_codec();
  peer->advertise(text_topic(node, "numbers"));
  peer->announce(node.name);
  note_node(node);
  for (int next = 0; !is_asked_to_end();) {
    if (peer->subscriptions() > 0)
      peer->publish(codec.encode(Value::map({{"data", std::to_string(next++)}}), "").value());
  }
  return 0;
}

int listen(const Arguments& node) {
  const auto peer = make_fast_peer(domain());
  const auto codec = text_codec();
  peer->subscribe(text_topic(node, "words"));
  peer->announce(node.name);
  note_node(node);
  int last = -1;
  int heard = 0;
  int gaps = 0;
  while (!is_asked_to_end()) {
    const auto messages = peer->take();
    for (const Bytes& message : messages) {
      const int number = std::stoi(codec.decode(message).value().find("data")->as_string());
      if (last >= 0 && number != last + 1) ++gaps;
      last = number;
      ++heard;
    }
    if (!messages.empty())
      note(node.name + ".heard", std::to_string(heard) + " heard, " + std::to_string(gaps) + " gaps");
  }
  return 0;
}

/// As a plugin's library is, the file stays mapped as long as this process lives.
void map_library(const fs::path& file) {
  const int descriptor = ::open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::mmap(nullptr, 1, PROT_READ, MAP_PRIVATE, descriptor, 0);
  ::close(descriptor);
}

/// A container of ROS 2 (composition_interfaces).
class Container {
 public:
  explicit Container(const std::string& name) {
    load_->serve(name + "/_container/load_node", "composition_interfaces/srv/LoadNode");
    unload_->serve(name + "/_container/unload_node", "composition_interfaces/srv/UnloadNode");
    list_->serve(name + "/_container/list_nodes", "composition_interfaces/srv/ListNodes");
    for (const auto* peer : {&load_, &unload_, &list_})
      (*peer)->announce(name.substr(1));
  }
  void answer() {
    for (const Request& request : load_->requests())
      respond(*load_, request, load(decode("LoadNode_Request", request)), "LoadNode_Response");
    for (const Request& request : unload_->requests()) {
      const bool known = nodes_.erase(decode("UnloadNode_Request", request).find("unique_id")->as_int()) > 0;
      respond(*unload_, request, Value::map({{"success", known}}), "UnloadNode_Response");
    }
    for (const Request& request : list_->requests())
      respond(*list_, request, list(), "ListNodes_Response");
  }

 private:
  Value load(const Value& asked) {
    if (asked.find("plugin_name")->as_string() != "test::Managed")
      return Value::map({{"success", false}, {"error_message", "there is no such plugin"}});
    Arguments node{
        asked.find("node_name")->as_string(), asked.find("node_namespace")->as_string(), {}, Value::map({})};
    for (const Value& rule : asked.find("remap_rules")->as_list())
      node.text += rule.as_string() + "\n";
    for (const Value& each : asked.find("parameters")->as_list())
      node.parameters.as_map().set(each.find("name")->as_string(),
                                   *each.find("value")->find("integer_value"));
    map_library(fs::path(std::getenv("AMENT_PREFIX_PATH")) / "lib/libtest_nodes.so");
    nodes_[++last_] = {node.node(), std::make_unique<Managed>(node, make_peer_)};
    return Value::map({{"success", true}, {"full_node_name", node.node()}, {"unique_id", last_}});
  }
  [[nodiscard]] Value list() const {
    Value::List names;
    Value::List ids;
    for (const auto& [id, node] : nodes_) {
      names.emplace_back(node.first);
      ids.emplace_back(id);
    }
    return Value::map({{"full_node_names", Value(std::move(names))}, {"unique_ids", Value(std::move(ids))}});
  }
  segue::ros2::MessageCodec codec(const std::string& name) {
    return segue::ros2::MessageCodec::of(library_, "composition_interfaces/srv/" + name).value();
  }
  Value decode(const std::string& name, const Request& request) {
    return codec(name).decode(request.message).value();
  }
  void respond(Peer& peer, const Request& request, const Value& response, const std::string& name) {
    while (peer.clients() == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    peer.respond(request, codec(name).encode(response, "").value());
  }

  segue::ros2::InterfaceLibrary library_;
  const std::function<std::unique_ptr<Peer>()> make_peer_ = fast_peers_of_one_process(domain());
  std::unique_ptr<Peer> load_ = make_peer_();
  std::unique_ptr<Peer> unload_ = make_peer_();
  std::unique_ptr<Peer> list_ = make_peer_();
  std::map<std::int64_t, std::pair<std::string, std::unique_ptr<Managed>>> nodes_;  ///< with their names
  std::int64_t last_ = 0;
};

int contain(const Arguments& node) {
  Container container(node.node());
  note_node(node);
  while (!is_asked_to_end())
    container.answer();
  note(node.name + ".end", "by SIGINT");
  return 0;
}

int run(const std::string& program, const Arguments& node) {
  std::printf("%s begins as %s\n", program.c_str(), node.node().c_str());
  std::fflush(stdout);
  if (program == "fails") return 3;
  if (program == "stubborn") return be_stubborn(node);
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  ::pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  if (program == "talker") return talk(node);
  if (program == "counter") return count(node);
  if (program == "listener") return listen(node);
  if (program == "component_container_isolated") return contain(node);
  const Managed managed(node);
  wait_for_end();
  note(node.name + ".end", "by SIGINT");
  return 0;
}

}  // namespace
}  // namespace ros2::testing

int main(int count, char** words) {
  return ros2::testing::run(std::filesystem::path(words[0]).filename().string(),
                            ros2::testing::parse({words + 1, words + count}));
}
