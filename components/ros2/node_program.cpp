// SPDX-License-Identifier: Apache-2.0
// Stands in for programs of ROS 2 packages in tests; which one, its file's name tells.
//
// managed: a managed node. Parameters: dies_in_configure, or meets: N, by which it is configured when N are
// in configure.
//
// talker: a node without a life cycle.
//
// fails: ends with exit status 3 before it is a node.
//
// stubborn: ignores SIGINT and SIGTERM, and has a child in a session of its own.
//
// component_container_isolated: loads managed nodes.
//
// Each node notes its arguments and parameters in $NODE_NOTES/NAME, and its pid in NAME.pid.
#include "managed_peer.hpp"
#include "sanitizer_options.hpp"

#include <segue/base/file.hpp>
#include <segue/type/yaml.hpp>

#include <sys/wait.h>
#include <unistd.h>

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
  std::ofstream(notes() / (name + ".new")) << text;
  fs::rename(notes() / (name + ".new"), notes() / name);
}

void note_node(const Arguments& node) {
  note(node.name + ".pid", std::to_string(::getpid()));
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

std::unique_ptr<ManagedPeer> manage(const Arguments& node) {
  note_node(node);
  const Value* dies = node.parameters.find("dies_in_configure");
  const Value* meets = node.parameters.find("meets");
  return std::make_unique<ManagedPeer>(fast_peers_of_one_node(domain()), node.node(),
                                       [=, name = node.name](int transition) {
                                         if (transition != 1) return;
                                         if (dies != nullptr) ::raise(SIGKILL);
                                         if (meets != nullptr) meet(name, meets->as_int());
                                       });
}

void wait_for_end() {
  sigset_t signals;
  ::sigemptyset(&signals);
  ::sigaddset(&signals, SIGINT);
  int number = 0;
  ::sigwait(&signals, &number);
}

int talk(const Arguments& node) {
  const auto peer = make_fast_peer(domain());
  peer->announce(node.name);
  note_node(node);
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

/// A container of ROS 2 (composition_interfaces).
class Container {
 public:
  explicit Container(const std::string& name) {
    load_->serve(name + "/_container/load_node", "composition_interfaces/srv/LoadNode");
    unload_->serve(name + "/_container/unload_node", "composition_interfaces/srv/UnloadNode");
  }
  void answer() {
    for (const Request& request : load_->requests())
      respond(*load_, request, load(decode("LoadNode_Request", request)), "LoadNode_Response");
    for (const Request& request : unload_->requests()) {
      const bool known = nodes_.erase(decode("UnloadNode_Request", request).find("unique_id")->as_int()) > 0;
      respond(*unload_, request, Value::map({{"success", known}}), "UnloadNode_Response");
    }
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
    nodes_[++last_] = manage(node);
    return Value::map({{"success", true}, {"full_node_name", node.node()}, {"unique_id", last_}});
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
  const std::function<std::unique_ptr<Peer>()> make_peer_ = fast_peers_of_one_node(domain());
  std::unique_ptr<Peer> load_ = make_peer_();
  std::unique_ptr<Peer> unload_ = make_peer_();
  std::map<std::int64_t, std::unique_ptr<ManagedPeer>> nodes_;
  std::int64_t last_ = 0;
};

int contain(const Arguments& node) {
  Container container(node.node());
  note_node(node);
  for (;; container.answer()) {
    const timespec pause{0, 1'000'000};
    sigset_t signals;
    ::sigemptyset(&signals);
    ::sigaddset(&signals, SIGINT);
    if (::sigtimedwait(&signals, nullptr, &pause) == SIGINT) break;
  }
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
  if (program == "component_container_isolated") return contain(node);
  const auto managed = manage(node);
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
