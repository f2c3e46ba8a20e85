// SPDX-License-Identifier: Apache-2.0

#include <fmt/core.h>

#include <memory>

#include "../output.hpp"
#include "init_files.hpp"

namespace segue::cli {

namespace {

struct InitOptions {
  std::string folder;
  std::string name;
  bool library = false;
};

void report_files(const InitOptions& options, const std::vector<NewFile>& files, const Context& context) {
  if (context.json()) {
    type::Value::List names;
    for (const NewFile& file : files)
      names.emplace_back(file.path);
    return print_json(type::Value::map({{"folder", options.folder}, {"files", std::move(names)}}));
  }
  for (const NewFile& file : files)
    print_line("  " + options.folder + '/' + file.path);
  print_line(
      fmt::format("the robot is ready; try\n  cd {}\n  segue check robot.yaml\n"
                  "  segue run robot.yaml --controller explore",
                  options.folder));
}

int init_robot(const InitOptions& options, const Context& context) {
  const std::string name = options.name.empty() ? robot_name_of(options.folder) : options.name;
  if (const auto valid = check_robot_name(name); !valid) return failed(context, valid.error());
  if (const auto empty = check_new_folder(options.folder); !empty) return failed(context, empty.error());
  const auto files = init_files(name, options.library);
  if (const auto written = write_new_folder(options.folder, files); !written)
    return failed(context, written.error());
  report_files(options, files, context);
  return kDone;
}

}  // namespace

void add_init(Verb& app, Context& context) {
  const auto options = std::make_shared<InitOptions>();
  Verb& verb = add_verb(app, context, "init", "create a small working robot to start from",
                        "  segue init my_robot && cd my_robot && segue run robot.yaml --controller explore",
                        [options, &context] { return init_robot(*options, context); });
  verb.option("DIR", options->folder, "a folder that does not exist yet or is empty").required();
  verb.option("--name NAME", options->name, "the robot's name (default: the folder's)");
  verb.flag("--library", options->library, "also create a component library with one component");
}

}  // namespace segue::cli
