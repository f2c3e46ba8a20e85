// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/model/reader.hpp>

#include <optional>
#include <string>

/// The parts that network, transition and component model files have in common. Internal.
namespace segue::model::detail {

/// Anything larger is a slip of the pen, and would be allocated.
inline constexpr std::int64_t kLargestBuffer = 1'000'000;
inline constexpr int kMostCpus = 1024;

/// Why an activity cannot be, or nothing.
std::optional<std::string> problem_of(const Activity& activity);
std::optional<Activity> read_activity(const type::Value& value, const std::string& what,
                                      const Source& source);
type::Value write_activity(const Activity& activity);

/// The attributes of a thread or process: scheduler, priority, cpu.
struct Scheduling {
  Scheduler scheduler = Scheduler::Normal;
  int priority = 0;
  std::vector<int> cpus;
};
Scheduling read_scheduling(Fields& fields, const Source& source);
void write_scheduling(type::ValueMap& map, Scheduler scheduler, int priority, const std::vector<int>& cpus);

/// A task from its entry in `tasks`, its id being the key.
Task read_task(const std::string& id, const type::Value& value, const Source& source);
type::Value write_task(const Task& task);

/// From the keys from, to, policy, size, link, init.
std::optional<Connection> read_connection(Fields& fields, const Source& source);
void write_connection(type::ValueMap& map, const Connection& connection);
Policy read_policy(Fields& fields, const Source& source);

/// Why limits cannot be, or nothing.
std::optional<std::string> problem_of(const ResourceLimits& limits);
/// From the map under `limits`: {memory: 512MB, open_files: 1024, cpu_time: 60s, core: 0}.
ResourceLimits read_limits(const type::Value& value, const std::string& what, const Source& source);
type::Value write_limits(const ResourceLimits& limits);

/// From the keys host, deployer, scheduler, priority, cpu, optional, environment, limits; not process and
/// tasks.
/// The key `on_failure`.
std::optional<FailurePolicy> read_failure_policy(Fields& fields);
void read_process(Fields& fields, Deployment& deployment, const Source& source);
void write_process(type::ValueMap& map, const Deployment& deployment);

/// "localhost" and "local" are the same host.
HostName host_named(std::string name);

type::Value text_list(const std::vector<std::string>& texts);

}  // namespace segue::model::detail
