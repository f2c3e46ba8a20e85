// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

/// The command line: one file per verb, and what they share.
namespace segue::cli {

/// What every verb ends with; tools may rely on it.
enum Exit : int {
  kDone = 0,
  kFailed = 1,      ///< the thing asked failed or was refused
  kUsage = 2,       ///< the command line is wrong
  kUnreachable = 3  ///< no runtime answered
};

enum class Format { Text, Json };

/// What is known once the command line is read. `action` runs afterwards and answers the exit status.
struct Context {
  Format format = Format::Text;
  std::string robot;  ///< --robot
  std::function<int()> action;
  [[nodiscard]] bool json() const { return format == Format::Json; }
};

/// A verb with --format and an example in its help. `run` becomes the context's action if the verb is given.
CLI::App* add_verb(CLI::App& parent, Context& context, const std::string& name,
                   const std::string& description, const std::string& examples, std::function<int()> run);

/// --robot, for verbs that talk to a running robot.
void add_robot_option(CLI::App& verb, Context& context);

/// An option that takes "500ms" or "3 s".
CLI::Option* add_duration(CLI::App& verb, const std::string& name, Duration& target, const std::string& help);

/// --order seamless|paper.
CLI::Option* add_order_option(CLI::App& verb, std::string& order);

/// Verbs, in the order of the help.
void add_init(CLI::App& app, Context& context);
void add_check(CLI::App& app, Context& context);
void add_diff(CLI::App& app, Context& context);
void add_apply(CLI::App& app, Context& context);
void add_run(CLI::App& app, Context& context);
void add_switch(CLI::App& app, Context& context);
void add_prepare(CLI::App& app, Context& context);
void add_status(CLI::App& app, Context& context);
void add_top(CLI::App& app, Context& context);
void add_task(CLI::App& app, Context& context);
void add_read(CLI::App& app, Context& context);
void add_set(CLI::App& app, Context& context);
void add_call(CLI::App& app, Context& context);
void add_events(CLI::App& app, Context& context);
void add_history(CLI::App& app, Context& context);
void add_log(CLI::App& app, Context& context);
void add_reset_belief(CLI::App& app, Context& context);
void add_host(CLI::App& app, Context& context);
void add_component(CLI::App& app, Context& context);
void add_mission(CLI::App& app, Context& context);
void add_bench(CLI::App& app, Context& context);
void add_completion(CLI::App& app, Context& context);

}  // namespace segue::cli
