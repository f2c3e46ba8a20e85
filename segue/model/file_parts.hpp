// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/model/network.hpp>
#include <segue/model/reader.hpp>

#include <optional>
#include <string>

/// Readers and writers of the parts that network, transition and component model files have in common.
/// Internal.
namespace segue::model::detail {

/// Larger buffers are refused as a mistake, since they would be allocated.
inline constexpr std::int64_t kLargestBuffer = 1'000'000;
inline constexpr int kMostCpus = 1024;

/// The error in an activity, or nothing.
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

/// A file that a network includes: its path from the folder of the file that includes it.
struct Include {
  std::string file;
  SourceLocation where;
};
/// The part of a network that stands in one file.
struct NetworkPart {
  Network network;
  std::vector<Include> includes;
};
/// The key `include`: the path of a file, or a list of them.
std::vector<Include> read_includes(Fields& fields, const Source& source);

/// A warning where tasks name sections of Rock's property files that were not found.
void warn_of_sections(const Network& network, Diagnostics& diagnostics);

/// Reads the keys component, config_names, properties, activity, exclusive and on_failure.
void read_definition(Fields& fields, Task& task, const Source& source);
/// A task from its entry in `tasks`, its id being the key.
Task read_task(const std::string& id, const type::Value& value, const Source& source);
type::Value write_task(const Task& task);

/// Reads the keys from, to, policy, size, link and init.
std::optional<Connection> read_connection(Fields& fields, const Source& source);
void write_connection(type::ValueMap& map, const Connection& connection);
Policy read_policy(Fields& fields, const Source& source);

/// The error in limits, or nothing.
std::optional<std::string> problem_of(const ResourceLimits& limits);
/// Reads the map under `limits`: {memory: 512MB, open_files: 1024, cpu_time: 60s, core: 0}.
ResourceLimits read_limits(const type::Value& value, const std::string& what, const Source& source);
type::Value write_limits(const ResourceLimits& limits);

/// The key `on_failure`.
std::optional<FailurePolicy> read_failure_policy(Fields& fields);
/// Reads the keys host, deployer, scheduler, priority, cpu, optional, environment and limits; not process and
/// tasks.
void read_process(Fields& fields, Deployment& deployment, const Source& source);
void write_process(type::ValueMap& map, const Deployment& deployment);

/// The name of what a file holds, where the file does not say it: "controllers/goal.cnd.yml" holds "goal".
std::string name_from_file(const std::string& file);

/// "localhost" and "local" are the same host.
HostName host_named(std::string name);

type::Value text_list(const std::vector<std::string>& texts);

/// Whether it is a Rock component network definition (CND): by the keys of its entries, else by the file
/// name.
bool is_cnd(const type::Value& root, const std::string& file);
NetworkPart read_cnd(const type::Value& root, const Source& source);

}  // namespace segue::model::detail
