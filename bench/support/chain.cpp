// SPDX-License-Identifier: Apache-2.0
#include "chain.hpp"

#include <cstdio>
#include <cstdlib>

namespace bench {
namespace {

segue::TimePoint soon() {
  return segue::RealClock::instance().now() + std::chrono::seconds(5);
}

}  // namespace

void require(const segue::Result<void>& result) {
  if (result) return;
  std::fprintf(stderr, "%s\n", to_string(result.error()).c_str());
  std::exit(1);
}

void Bench::connect(segue::task::OutputPortBase& from, segue::task::InputPortBase& to,
                    const segue::Policy& policy) {
  auto connection = segue::sample_link::connect(from, to, policy);
  if (!connection) require(std::move(connection.error()));
}

void Bench::add(const std::string& id, std::unique_ptr<segue::task::Component> component,
                const segue::Activity& activity) {
  auto executor = executors_.executor_for(id, activity);
  if (!executor) require(std::move(executor.error()));
  auto task = segue::task::Task::create(id, std::move(component), activity, *executor);
  if (!task) require(std::move(task.error()));
  require((*task)->configure(soon()));
  require((*task)->start(soon()));
  tasks_.push_back(std::move(*task));
}

}  // namespace bench
