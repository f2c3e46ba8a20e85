// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/log.hpp>

#include <functional>
#include <string>

#include "options.hpp"

/// The command line: one file per verb, and what they share.
namespace segue::cli {

/// The exit status of every verb; tools may rely on it.
enum Exit : int {
  kDone = 0,
  kFailed = 1,       ///< the request failed or was refused
  kUsage = 2,        ///< the command line is wrong
  kUnreachable = 3,  ///< cannot connect to the runtime
  kChanges = 4,      ///< `plan --exit-code`: `apply` would change something
  kTrouble = 5       ///< `status --exit-code`: something that the robot needs is missing or faulty
};

inline constexpr Duration kLongestWait = std::chrono::hours(24 * 366);

/// More lines or samples than that are a mistake.
inline constexpr std::size_t kMostLines = 1'000'000'000;

enum class Format { Text, Json };

/// The result of parsing the command line. `action` runs afterwards and returns the exit status.
struct Context {
  Format format = Format::Text;
  std::string robot;  ///< --robot
  std::function<int()> action;
  [[nodiscard]] bool json() const { return format == Format::Json; }
};

/// A verb with --format and an example in its help. `run` becomes the context's action if the verb is given.
Verb& add_verb(Verb& parent, Context& context, const std::string& name, const std::string& description,
               const std::string& examples, std::function<int()> run);

/// --robot, for verbs that talk to a running robot.
void add_robot_option(Verb& verb, Context& context);

/// --log-level debug|info|warning|error. `what`: "messages shown".
Option add_log_level_option(Verb& verb, LogLevel& level, const std::string& what);

/// --order seamless|paper.
Option add_order_option(Verb& verb, std::string& order);

/// Verbs, in the order of the help.
void add_init(Verb& app, Context& context);
void add_check(Verb& app, Context& context);
void add_diff(Verb& app, Context& context);
void add_predict(Verb& app, Context& context);
void add_run(Verb& app, Context& context);
void add_plan(Verb& app, Context& context);
void add_apply(Verb& app, Context& context);
void add_switch(Verb& app, Context& context);
void add_repair(Verb& app, Context& context);
void add_restart(Verb& app, Context& context);
void add_cancel(Verb& app, Context& context);
void add_stop(Verb& app, Context& context);
void add_prepare(Verb& app, Context& context);
void add_status(Verb& app, Context& context);
void add_top(Verb& app, Context& context);
void add_task(Verb& app, Context& context);
void add_chain(Verb& app, Context& context);
void add_graph(Verb& app, Context& context);
void add_hz(Verb& app, Context& context);
void add_bw(Verb& app, Context& context);
void add_delay(Verb& app, Context& context);
void add_read(Verb& app, Context& context);
void add_plot(Verb& app, Context& context);
void add_set(Verb& app, Context& context);
void add_write(Verb& app, Context& context);
void add_call(Verb& app, Context& context);
void add_events(Verb& app, Context& context);
void add_history(Verb& app, Context& context);
void add_log(Verb& app, Context& context);
void add_reset_belief(Verb& app, Context& context);
void add_doctor(Verb& app, Context& context);
void add_units(Verb& app, Context& context);
void add_host(Verb& app, Context& context);
void add_host_list(Verb& host, Context& context);          ///< verbs of `host`
void add_host_certificates(Verb& host, Context& context);  ///< verbs of `host`
void add_component(Verb& app, Context& context);
void add_ros2(Verb& app, Context& context);
void add_ros2_graph(Verb& ros2, Context& context);  ///< verbs of `ros2`
void add_import(Verb& app, Context& context);
void add_import(Verb& app, Context& context);
void add_types(Verb& app, Context& context);
void add_mission(Verb& app, Context& context);
void add_studio(Verb& app, Context& context);
void add_bench(Verb& app, Context& context);
void add_bench_transitions(Verb& bench, Context& context);  ///< a verb of `bench`
void add_bench_mission(Verb& bench, Context& context);      ///< a verb of `bench`
void add_completion(Verb& app, Context& context);

}  // namespace segue::cli
