// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/runtime/runtime.hpp>
#include <segue/runtime/runtime_options.hpp>
#include <segue/task_host/local_task_host.hpp>

#include <support/asking_host.hpp>
#include <support/network_of.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

namespace segue::runtime::testing {

using segue::testing::AskingHost;
using segue::testing::network_of;

/// Makes a random network runnable in one process: transports are chosen automatically.
inline model::Network runnable(model::Network network) {
  for (auto& connection : network.connections) {
    connection.policy.transport = Transport::Automatic;
  }
  return network;
}

/// The number of entries of a folder, such as one of /proc/self.
inline std::size_t entries(const char* folder) {
  const std::filesystem::directory_iterator all(folder);
  return static_cast<std::size_t>(std::distance(begin(all), end(all)));
}

/// A runtime whose tasks are all stand-ins.
struct StandInRobot {
  explicit StandInRobot(RuntimeOptions options = {})
      : runtime("robot", asking, catalog, std::move(options)) {}

  model::ComponentCatalog catalog;
  task_host::LibrarySet libraries;
  task_host::LocalTaskHost host{
      libraries, catalog, {.stand_in = true, .only_stand_ins = false, .stand_ins = {}}};
  AskingHost asking{host};
  Runtime runtime;
};

}  // namespace segue::runtime::testing
