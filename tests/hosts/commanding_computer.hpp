// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/distributed/distributed_task_host.hpp>
#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_options.hpp>
#include <segue/task_host/component_library.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <support/fake_hosts.hpp>

#include <array>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::distributed::testing {

using namespace std::chrono_literals;

constexpr std::size_t kDaemons = 2;
using Daemons = std::array<std::unique_ptr<Computer>, kDaemons>;

/// A computer that commands the robot, or has lost it.
class CommandingComputer {
 public:
  CommandingComputer(const std::string& name, Daemons& daemons, std::size_t count, Line* lines,
                     bool take_over)
      : holder(name) {
    std::vector<HostPlace> places;
    for (std::size_t i = 0; i < count; ++i)
      places.push_back(daemons.at(i)->place_over(lines[i]));
    DistributedOptions options;
    options.request = request_of(name, take_over);
    options.gateways.robot = "robot";
    options.watch = 2ms;
    host.emplace(own_, std::move(places), catalog_, std::move(options));
  }
  /// Nothing is done with the robot before.
  void begin() {
    runtime::RuntimeOptions options;
    options.policies.watch = 20ms;
    runtime.emplace("robot", *host, catalog_, std::move(options));
  }
  std::future<runtime::SwitchResult> request(const model::Network& network) {
    runtime::RequestOptions options;
    options.action_deadline = 1s;
    return runtime->request(network, std::move(options));
  }

  const std::string holder;

 private:
  task_host::LibrarySet libraries_;
  model::ComponentCatalog catalog_;
  task_host::LocalTaskHost local_{
      libraries_, catalog_, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  deploy::testing::FakeWorld world_;
  deploy::testing::FakeProcesses processes_{world_};
  deploy::testing::FakeService service_{world_, world_.own()};
  fleet::DeployedTaskHost own_{service_,
                               processes_,
                               deploy::testing::connector(world_),
                               request_of("").launch,
                               local_,
                               {60s, 1h, {model::kLocalHost}}};

 public:
  std::optional<DistributedTaskHost> host;
  std::optional<runtime::Runtime> runtime;
};

}  // namespace segue::distributed::testing
