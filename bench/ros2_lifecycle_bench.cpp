// SPDX-License-Identifier: Apache-2.0
// Life-cycle nodes of ROS 2: how long a robot takes to bring up 1 and 25 of them and to exchange half of 25,
// beside a script that calls change_state of one node after the other, as `ros2 lifecycle set` in a script or
// a lifecycle manager does. The nodes are in a process of their own and need 0 or 20 ms for each transition.
//
//   ros2_lifecycle_bench [ROUNDS]      default: 5
#include "support/measure.hpp"
#include "support/robot.hpp"

#include "../components/ros2/peers/managed_peer.hpp"

#include <segue/base/clock.hpp>
#include <segue/runtime/runtime.hpp>

#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <vector>

namespace {

using namespace bench;
using namespace std::chrono_literals;
using ros2::testing::Peer;
using segue::type::Value;

constexpr std::size_t kNodes = 25;      // of a controller
constexpr std::size_t kExchanged = 12;  // of them, by others
constexpr auto kTransitionTime = 20ms;

std::string node_name(std::size_t number) {
  return "/node_" + std::to_string(number);
}

/// The nodes, until this process is killed.
[[noreturn]] void be_nodes(std::uint32_t domain, bool take_time) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  const auto make_peer = ros2::testing::fast_peers_of_one_node(domain);
  std::vector<std::unique_ptr<ros2::testing::ManagedPeer>> nodes;
  for (std::size_t i = 0; i < kNodes + kExchanged; ++i) {
    nodes.push_back(std::make_unique<ros2::testing::ManagedPeer>(make_peer, node_name(i), [=](int) {
      if (take_time) std::this_thread::sleep_for(kTransitionTime);
    }));
  }
  for (;;)
    ::pause();
}

/// A process with all nodes.
class Nodes {
 public:
  Nodes(std::uint32_t domain, bool take_time) : pid_(::fork()) {
    if (pid_ != 0) return;
    ::execl("/proc/self/exe", "ros2_lifecycle_bench", "nodes", std::to_string(domain).c_str(),
            take_time ? "1" : "0", nullptr);
    std::_Exit(1);
  }
  ~Nodes() {
    ::kill(pid_, SIGKILL);
    ::waitpid(pid_, nullptr, 0);
  }
  Nodes(const Nodes&) = delete;
  Nodes& operator=(const Nodes&) = delete;

 private:
  const pid_t pid_;
};

/// Calls change_state of one node after the other.
class Script {
 public:
  explicit Script(std::uint32_t domain) {
    const auto make_peer = ros2::testing::fast_peers_of_one_node(domain);
    for (std::size_t i = 0; i < kNodes + kExchanged; ++i) {
      clients_.push_back(make_peer());
      clients_.back()->use(node_name(i) + "/change_state", "lifecycle_msgs/srv/ChangeState");
    }
    for (const auto& client : clients_)
      wait_for([&] { return client->servers() > 0; });
    std::this_thread::sleep_for(1s);  // the servers know the clients, too
  }

  enum Transition : std::uint8_t { Configure = 1, Cleanup = 2, Activate = 3, Deactivate = 4 };
  void change(std::size_t begin, std::size_t end, Transition transition) {
    for (std::size_t i = begin; i < end; ++i)
      change(*clients_[i], transition);
  }

 private:
  void change(Peer& client, Transition transition) {
    const Value request = Value::map({{"transition", Value::map({{"id", int{transition}}})}});
    client.ask(request_.encode(request, "").value());
    wait_for([&] {
      for (const auto& response : client.responses())
        return response_.decode(response.message).value().find("success")->as_bool() || (std::exit(1), false);
      return false;
    });
  }

  segue::ros2::InterfaceLibrary library_;
  const segue::ros2::MessageCodec request_ =
      segue::ros2::MessageCodec::of(library_, "lifecycle_msgs/srv/ChangeState_Request").value();
  const segue::ros2::MessageCodec response_ =
      segue::ros2::MessageCodec::of(library_, "lifecycle_msgs/srv/ChangeState_Response").value();
  std::vector<std::unique_ptr<Peer>> clients_;
};

/// A controller with the nodes of these numbers.
std::string network(const std::string& name, std::uint32_t domain, std::size_t begin, std::size_t end,
                    std::size_t other_begin = 0, std::size_t other_end = 0) {
  std::string text = "network: " + name + "\ntasks:\n";
  const auto add = [&](std::size_t i) {
    text += "  node_" + std::to_string(i) +
            ": {component: 'ros2::ManagedNode', properties: {name: " + node_name(i) +
            ", domain: " + std::to_string(domain) + ", discovery: localhost, timeout: 60s}}\n";
  };
  for (std::size_t i = begin; i < end; ++i)
    add(i);
  for (std::size_t i = other_begin; i < other_end; ++i)
    add(i);
  return text;
}

segue::runtime::EmbeddedRobot robot(const Scratch& scratch, std::uint32_t domain) {
  std::filesystem::create_directories(scratch.path() / "controllers");
  static_cast<void>(scratch.write(
      "robot.yaml", "robot: bench\nlibraries: [segue_components_ros2]\ncontrollers: [controllers/*.yaml]\n"));
  static_cast<void>(scratch.write("controllers/idle.yaml", "network: idle\ntasks: {}\n"));
  static_cast<void>(scratch.write("controllers/one.yaml", network("one", domain, 0, 1)));
  static_cast<void>(scratch.write("controllers/all.yaml", network("all", domain, 0, kNodes)));
  static_cast<void>(
      scratch.write("controllers/exchanged.yaml",
                    network("exchanged", domain, kExchanged, kNodes, kNodes, kNodes + kExchanged)));
  ::setenv("SEGUE_LIBRARY_PATH", SEGUE_BENCH_LIBRARIES, 1);
  return open(scratch.path() / "robot.yaml", {});
}

/// All figures of several rounds.
struct Figures {
  std::vector<Duration> one, all, total, pause;
};

Duration time_of(const std::function<void()>& work) {
  const auto begin = segue::monotonic_now();
  work();
  return segue::monotonic_now() - begin;
}

void run_script(std::uint32_t domain, std::size_t rounds, Figures& figures) {
  Script script(domain);
  const auto bring_up = [&](std::size_t end) {
    return time_of([&] {
      script.change(0, end, Script::Configure);
      script.change(0, end, Script::Activate);
    });
  };
  for (std::size_t round = 0; round < rounds; ++round) {
    figures.one.push_back(bring_up(1));
    script.change(0, 1, Script::Deactivate);
    script.change(0, 1, Script::Cleanup);
    figures.all.push_back(bring_up(kNodes));
    figures.total.push_back(time_of([&] {
      script.change(kNodes, kNodes + kExchanged, Script::Configure);
      figures.pause.push_back(time_of([&] {
        script.change(0, kExchanged, Script::Deactivate);
        script.change(kNodes, kNodes + kExchanged, Script::Activate);
      }));
      script.change(0, kExchanged, Script::Cleanup);
    }));
    script.change(kExchanged, kNodes + kExchanged, Script::Deactivate);
    script.change(kExchanged, kNodes + kExchanged, Script::Cleanup);
  }
}

void run_robot(std::uint32_t domain, std::size_t rounds, bool look_ahead, Figures& figures) {
  const Scratch scratch;
  auto segue = robot(scratch, domain);
  const auto timed = [&](const char* controller) {
    auto result = segue.switch_to(controller);
    done(result);
    return result;
  };
  const auto go = [&](const char* controller) { done(segue.switch_to(controller)); };
  go("all");  // all nodes have been found
  go("exchanged");
  for (std::size_t round = 0; round < rounds; ++round) {
    go("idle");
    figures.one.push_back(timed("one").duration);
    go("idle");
    figures.all.push_back(timed("all").duration);
    if (look_ahead) {
      for (const auto& each : segue.runtime().prepare({segue::model::NetworkName("exchanged")}).get()) {
        if (!each.ready) std::fprintf(stderr, "not prepared: %s\n", each.reason.c_str());
      }
    }
    const auto result = timed("exchanged");
    figures.total.push_back(result.duration);
    figures.pause.push_back(result.commit);
    static_cast<void>(segue.runtime().prepare({}).get());
  }
  done(segue.shut_down());
}

void compare(std::size_t rounds, bool take_time) {
  const std::uint32_t domain = 1 + static_cast<std::uint32_t>(::getpid()) % 200 + (take_time ? 1 : 0);
  const Nodes nodes(domain, take_time);
  Figures script;
  Figures plain;
  Figures ahead;
  run_script(domain, rounds, script);
  run_robot(domain, rounds, false, plain);
  run_robot(domain, rounds, true, ahead);
  Table table(std::string("Managed nodes, ") +
              (take_time ? "20 ms for each transition" : "no time for transitions") +
              ", beside a script (floor)");
  const auto add = [&](const char* name, const std::vector<Duration>& figure,
                       const std::vector<Duration>& floor) {
    table.add(name, summarise(figure), 1, summarise(floor).median);
  };
  table.add("1 node: script", summarise(script.one));
  add("1 node: switch", plain.one, script.one);
  table.add("25 nodes: script", summarise(script.all));
  add("25 nodes: switch", plain.all, script.all);
  table.add("12 of 25 exchanged: script", summarise(script.total));
  add("12 of 25 exchanged: switch", plain.total, script.total);
  add("12 of 25 exchanged: switch, prepared ahead", ahead.total, script.total);
  table.add("its pause: script", summarise(script.pause));
  add("its pause: switch", plain.pause, script.pause);
  add("its pause: switch, prepared ahead", ahead.pause, script.pause);
  table.print();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 4) be_nodes(static_cast<std::uint32_t>(std::atoi(argv[2])), std::atoi(argv[3]) != 0);
  const std::size_t rounds = argc > 1 ? static_cast<std::size_t>(std::atol(argv[1])) : 5;
  compare(rounds, false);
  compare(rounds, true);
  return 0;
}
