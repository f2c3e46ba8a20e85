// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <memory>

#include "../new_folder.hpp"
#include "../output.hpp"
#include "ros2_robot.hpp"
#include "ros2_system.hpp"

namespace segue::cli {

namespace {

using type::Value;

struct ImportRos2Options {
  Ros2SystemOptions system;
  std::string folder;
  std::string name;
  bool running = false;
};

void report(const ImportRos2Options& options, const Ros2Robot& robot, const Context& context) {
  if (context.json()) {
    Value::List files;
    for (const NewFile& file : robot.files)
      files.emplace_back(file.path);
    return print_json(
        Value::map({{"folder", options.folder},
                    {"files", Value(std::move(files))},
                    {"nodes", Value(Value::List(robot.nodes.begin(), robot.nodes.end()))},
                    {"started", Value(Value::List(robot.started.begin(), robot.started.end()))}}));
  }
  for (const NewFile& file : robot.files)
    print_line("  " + options.folder + '/' + file.path);
  print_line(fmt::format(
      "{}, of which the robot starts {}; look at the files, then try\n  cd {}\n  segue check robot.yaml\n"
      "  segue run robot.yaml --controller nodes",
      counted(robot.nodes.size(), "node"), robot.started.size(), options.folder));
}

int import_ros2(const ImportRos2Options& options, const Context& context) {
  const std::string name = options.name.empty() ? robot_name_of(options.folder) : options.name;
  if (const auto valid = check_robot_name(name); !valid) return failed(context, valid.error());
  if (const auto fresh = check_new_folder(options.folder); !fresh) return failed(context, fresh.error());
  const auto seen = look_at_ros2(options.system, Value::map({{"all", true}}));
  if (!seen) return failed(context, seen.error());
  const Ros2Robot robot = ros2_robot(*seen, name, !options.running);
  if (robot.nodes.empty()) {
    return failed(
        context,
        fail(ErrorCode::NotFound,
             "no node of ROS 2 was found, but for those of Segue's tasks: is the domain the right one "
             "(--domain), and would more time help (--wait)?"));
  }
  if (const auto written = write_new_folder(options.folder, robot.files); !written)
    return failed(context, written.error());
  report(options, robot, context);
  print_problems(*seen);
  return kDone;
}

}  // namespace

void add_import(Verb& app, Context& context) {
  const auto options = std::make_shared<ImportRos2Options>();
  Verb& verb = add_verb(app, context, "import", "make a robot of a system that runs",
                        "  segue import ros2 my_robot", nullptr);
  verb.require_verb();
  Verb& ros2 =
      add_verb(verb, context, "ros2", "make a robot of the nodes of ROS 2 that run, with their parameters",
               "  segue import ros2 my_robot && segue check my_robot/robot.yaml",
               [options, &context] { return import_ros2(*options, context); });
  ros2.option("DIR", options->folder, "a folder that does not exist yet or is empty").required();
  ros2.option("--name NAME", options->name, "the robot's name (default: the folder's)");
  ros2.flag("--running", options->running, "the nodes go on running; the robot starts none of them");
  add_ros2_system_options(ros2, options->system, true);
}

}  // namespace segue::cli
