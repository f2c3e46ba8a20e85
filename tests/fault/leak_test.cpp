// SPDX-License-Identifier: Apache-2.0
// Many random switches among the four controllers of the Artemis rover, with stand-ins in real processes:
// after each exactly the controller exists, and at the end no resource has grown.
#include <segue/model/files.hpp>

#include <support/paths.hpp>

#include <algorithm>
#include <random>
#include <set>
#include <tuple>

#include "deployed_robot.hpp"

namespace segue::testing {
namespace {

/// The process of an endpoint of a connection.
using Place = std::tuple<sample_link::Incarnation, std::uint64_t, std::uint64_t>;

class Leaks : public DeployedRobotTest {
 protected:
  void SetUp() override {
    launch_.stand_in = true;
    DeployedRobotTest::SetUp();
    for (const char* name : {"search_explore", "goal_navigation", "manipulation", "manipulator_teleop"}) {
      Diagnostics diagnostics;
      const std::string file = segue::paths::in_sources("/examples/04_artemis/controllers/") + name + ".cnd";
      auto network = model::load_network(file, diagnostics);
      ASSERT_TRUE(network) << to_string(diagnostics);
      networks_.push_back(std::move(*network));
    }
  }

  static std::set<std::string> names(const model::Network& network) {
    std::set<std::string> names;
    for (const auto& deployment : network.deployments)
      names.insert(deployment.process.str());
    return names;
  }

  /// The number of connections between two processes.
  static std::size_t crossings(const model::Network& network) {
    std::map<model::TaskId, std::string> homes;
    for (const auto& deployment : network.deployments) {
      for (const auto& placement : deployment.tasks)
        homes[placement.task] = deployment.process.str();
    }
    return static_cast<std::size_t>(std::count_if(
        network.connections.begin(), network.connections.end(), [&](const model::Connection& connection) {
          return homes[connection.from.task] != homes[connection.to.task];
        }));
  }

  /// Expects exactly the processes, tasks, connections and endpoints of the network.
  void expect_just(const model::Network& network) {
    std::set<std::string> running;
    for (const auto& [name, pid] : deployments())
      running.insert(name);
    EXPECT_EQ(running, names(network));
    EXPECT_TRUE(equivalent(host().observe(), network))
        << ::testing::PrintToString(differences(host().observe(), network));
    std::multiset<Place> outputs;
    std::multiset<Place> inputs;
    std::size_t in_memory = 0;
    for (const auto& snapshot : snapshots()) {
      in_memory += snapshot.memory.connections;
      for (const auto& endpoint : snapshot.endpoints) {
        (endpoint.side == deploy::Side::Output ? outputs : inputs)
            .emplace(endpoint.place.reader, endpoint.place.offset, endpoint.place.generation);
      }
      EXPECT_LE(snapshot.memory.peers, running.size()) << "of those that run, and the runtime's own";
    }
    EXPECT_EQ(outputs, inputs) << "each endpoint has its counterpart";
    EXPECT_EQ(outputs.size(), crossings(network));
    EXPECT_EQ(in_memory, 2 * crossings(network));
  }

  /// Resources of all deployment processes and of the runtime's own.
  std::vector<deploy::Snapshot> snapshots() {
    std::vector<deploy::Snapshot> all;
    auto own = life_->own().snapshot();
    EXPECT_TRUE(own);
    all.push_back(std::move(*own));
    for (const auto& [name, pid] : deployments()) {
      const auto socket =
          process_server::process_socket(launch_.robot, {model::kLocalHost, model::ProcessName(name)});
      EXPECT_TRUE(socket);
      auto connected =
          control::connect_deployment(*socket, RealClock::instance().now() + std::chrono::seconds(60), [] {});
      EXPECT_TRUE(connected) << to_string(connected.error());
      auto snapshot = connected->service->snapshot();
      EXPECT_TRUE(snapshot) << to_string(snapshot.error());
      if (snapshot) all.push_back(std::move(*snapshot));
    }
    return all;
  }

  std::vector<model::Network> networks_;
};

TEST_F(Leaks, ThereAreNoneInManySwitches) {
  for (const auto& network : networks_) {
    ASSERT_NO_FATAL_FAILURE(switch_to(network));
    expect_just(network);
  }
  ASSERT_NO_FATAL_FAILURE(switch_to(model::Network{}));
  expect_just(model::Network{});
  const Holdings before = holdings_of(::getpid());
  std::mt19937 random(std::random_device{}());
  const auto seed = random();
  SCOPED_TRACE("seed " + std::to_string(seed));
  random.seed(seed);
  for (int i = 0; i < number_of_switches(); ++i) {
    const auto& network = networks_[std::uniform_int_distribution<std::size_t>(0, 3)(random)];
    ASSERT_NO_FATAL_FAILURE(switch_to(network)) << "switch " << i << " to " << network.name.str();
    expect_just(network);
    if (HasFailure()) break;
  }
  ASSERT_NO_FATAL_FAILURE(switch_to(model::Network{}));
  expect_just(model::Network{});
  EXPECT_TRUE(eventually([&] { return !has_grown(before, holdings_of(::getpid())); }))
      << to_string(before) << " have become " << to_string(holdings_of(::getpid()));
}

}  // namespace
}  // namespace segue::testing
