// SPDX-License-Identifier: Apache-2.0
//
// What trouble is called, and what runs, for messages.
#include "troubled_robot.hpp"

#include <segue/task_host/full_id.hpp>

#include <algorithm>
#include <iterator>

namespace segue::distributed::testing {

namespace {

constexpr std::array<std::string_view, kTroubleKinds> kTroubleNames = {"message lost",
                                                                       "answer lost",
                                                                       "message lost once",
                                                                       "answer lost once",
                                                                       "unanswered",
                                                                       "refused",
                                                                       "slow",
                                                                       "late commit",
                                                                       "late commit again",
                                                                       "clock jumps",
                                                                       "daemon restarts",
                                                                       "host restarts",
                                                                       "rival",
                                                                       "rival ends all",
                                                                       "action fails",
                                                                       "action doubted",
                                                                       "process hangs",
                                                                       "process dies",
                                                                       "process dies afterwards"};
constexpr std::array<std::string_view, 8> kPlantedNames = {"nothing",
                                                           "lost commit counts as done",
                                                           "lost actions count as done",
                                                           "old view counts as present",
                                                           "lease is not checked",
                                                           "promise lasts",
                                                           "refusal counts as promise",
                                                           "ended process lives on"};

}  // namespace

std::string_view to_string(TroubleKind kind) {
  return kTroubleNames.at(static_cast<std::size_t>(kind));
}

std::string_view to_string(Planted planted) {
  return kPlantedNames.at(static_cast<std::size_t>(planted));
}

std::string to_string(const Trouble& trouble) {
  const std::string kind(to_string(trouble.kind));
  const std::string host = " at h" + std::to_string(trouble.host);
  if (is_of_process(trouble.kind)) {
    return kind + host + ", call " + std::to_string(trouble.call);
  }
  const auto call = static_cast<std::size_t>(trouble.call) % kCalls.size();
  return kind + host + ", '" + std::string(kCalls.at(call)) + "' " + std::to_string(trouble.nth);
}

std::vector<std::string> inventory(const model::Network& network) {
  // What really runs has incarnations with the same id, in the order of their processes.
  std::map<model::TaskId, std::vector<std::string>> processes;
  for (const auto& deployment : network.deployments) {
    for (const auto& placement : deployment.tasks) {
      processes[placement.task].push_back(to_string(deployment.key()));
    }
  }
  const auto plain = [](const model::PortRef& port) {
    return task_host::plain_id(port.task).str() + "." + port.port;
  };
  std::vector<std::string> all;
  for (const auto& task : network.tasks) {
    auto& places = processes[task.id];
    const std::string place = places.empty() ? "the runtime's process" : places.front();
    places.erase(places.begin(), places.begin() + (places.empty() ? 0 : 1));
    all.push_back(place + ": " + task_host::plain_id(task.id).str() + " " +
                  std::string(to_string(task.state)));
  }
  for (const auto& connection : network.connections) {
    all.push_back(plain(connection.from) + " -> " + plain(connection.to));
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<std::string> changes_between(const model::Network& before, const model::Network& after) {
  return changes_between(inventory(before), inventory(after));
}

std::vector<std::string> changes_between(const std::vector<std::string>& was,
                                         const std::vector<std::string>& is) {
  std::vector<std::string> changes;
  std::set_difference(was.begin(), was.end(), is.begin(), is.end(), std::back_inserter(changes));
  for (auto& change : changes) {
    change = "'" + change + "' is missing";
  }
  std::vector<std::string> more;
  std::set_difference(is.begin(), is.end(), was.begin(), was.end(), std::back_inserter(more));
  for (const auto& change : more) {
    changes.push_back("'" + change + "' is new");
  }
  return changes;
}

}  // namespace segue::distributed::testing
