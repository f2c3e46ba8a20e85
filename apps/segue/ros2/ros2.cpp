// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/ros2/cpp_header.hpp>
#include <segue/ros2/dds_names.hpp>
#include <segue/ros2/interface_library.hpp>
#include <segue/ros2/message_type.hpp>
#include <segue/ros2/type_hash.hpp>

#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <set>

#include "../command.hpp"
#include "../output.hpp"

namespace segue::cli {

namespace {

using ros2::InterfaceLibrary;
using type::Value;

struct Ros2Options {
  std::vector<std::string> folders;
  std::string package;  ///< empty: all
  std::string name;
  std::vector<std::string> names;
  std::string output = ".";
};

InterfaceLibrary library_of(const Ros2Options& options) {
  return InterfaceLibrary({options.folders.begin(), options.folders.end()});
}

int list_interfaces(const Ros2Options& options, const Context& context) {
  std::vector<std::string> names = library_of(options).names();
  if (!options.package.empty()) {
    const std::vector<std::string> all = std::move(names);
    names = {};
    std::set<std::string> packages;
    for (const std::string& name : all) {
      const std::string package = name.substr(0, name.find('/'));
      packages.insert(package);
      if (package == options.package) names.push_back(name);
    }
    if (names.empty()) {
      const std::vector<std::string> known(packages.begin(), packages.end());
      return failed(context, fail(ErrorCode::NotFound, "no package " + quote(options.package) +
                                                           did_you_mean(options.package, known)));
    }
  }
  if (context.json()) {
    print_json(Value(Value::List(names.begin(), names.end())));
    return kDone;
  }
  for (const std::string& name : names)
    print(name + '\n');
  return kDone;
}

std::string text_of(const ros2::MessageDefinition& message) {
  std::string text;
  for (const auto& constant : message.constants)
    text +=
        fmt::format("  {} {}={}\n", to_string(constant.type), constant.name, type::describe(constant.value));
  for (const auto& field : message.fields) {
    text += fmt::format("  {} {}", to_string(field.type), field.name);
    if (field.default_value) text += " " + type::describe(*field.default_value);
    text += '\n';
  }
  return text;
}

Value to_value(const ros2::MessageDefinition& message) {
  Value::List fields;
  for (const auto& field : message.fields)
    fields.push_back(Value::map({{"name", field.name},
                                 {"type", to_string(field.type)},
                                 {"default", field.default_value.value_or(Value())}}));
  Value::List constants;
  for (const auto& constant : message.constants)
    constants.push_back(
        Value::map({{"name", constant.name}, {"type", to_string(constant.type)}, {"value", constant.value}}));
  return Value::map(
      {{"name", message.name}, {"fields", std::move(fields)}, {"constants", std::move(constants)}});
}

int show_interface(const Ros2Options& options, const Context& context) {
  InterfaceLibrary library = library_of(options);
  const auto messages = library.with_parts(options.name);
  if (!messages) return failed(context, messages.error());
  const auto hash = ros2::type_hash(library, options.name);
  if (!hash) return failed(context, hash.error());
  const std::string& full_name = messages->front()->name;
  if (context.json()) {
    Value::List list;
    for (const auto* message : *messages)
      list.push_back(to_value(*message));
    print_json(Value::map({{"name", full_name},
                           {"hash", *hash},
                           {"dds_type", ros2::dds_type_name(full_name)},
                           {"type", ros2::type_name(full_name)},
                           {"messages", std::move(list)}}));
    return kDone;
  }
  for (const auto* message : *messages)
    print(coloured(Colour::Bold, message->name) + '\n' + text_of(*message));
  print(fmt::format("\nhash: {}\ntype on DDS: {}\ntype of ports: {}\n", *hash, ros2::dds_type_name(full_name),
                    ros2::type_name(full_name)));
  return kDone;
}

int write_headers(const Ros2Options& options, const Context& context) {
  InterfaceLibrary library = library_of(options);
  std::set<std::string> written;
  for (const std::string& name : options.names) {
    const auto headers = ros2::cpp_headers(library, name);
    if (!headers) return failed(context, headers.error());
    for (const auto& header : *headers) {
      if (!written.insert(header.path).second) continue;
      const std::filesystem::path path = std::filesystem::path(options.output) / header.path;
      std::error_code problem;
      std::filesystem::create_directories(path.parent_path(), problem);
      if (problem) return failed(context, system_error(path.parent_path().string(), problem.value()));
      if (auto done = write_file(path, header.text); !done) return failed(context, done.error());
    }
  }
  print("wrote " + counted(written.size(), "header") + " to " + options.output + '\n');
  return kDone;
}

void add_folders(Verb& verb, Ros2Options& options) {
  verb.option(
          "--interfaces FOLDER", options.folders,
          "a folder with interface packages, such as /opt/ros/jazzy (repeatable); these go before those that "
          "are built in")
      .takes_one_at_a_time();
}

}  // namespace

void add_ros2(Verb& app, Context& context) {
  const auto options = std::make_shared<Ros2Options>();
  Verb& verb = add_verb(
      app, context, "ros2", "nodes of ROS 2 that run, and interfaces of ROS 2",
      "  segue ros2 describe /planner_server\n  segue ros2 interface sensor_msgs/msg/LaserScan", nullptr);
  verb.require_verb();
  add_ros2_graph(verb, context);
  Verb& lister = add_verb(verb, context, "interfaces", "list all known interfaces",
                          "  segue ros2 interfaces\n  segue ros2 interfaces sensor_msgs",
                          [options, &context] { return list_interfaces(*options, context); });
  lister.option("PACKAGE", options->package, "of this package only");
  add_folders(lister, *options);
  Verb& shower = add_verb(verb, context, "interface", "show an interface and all its parts",
                          "  segue ros2 interface sensor_msgs/msg/LaserScan\n"
                          "  segue ros2 interface my_msgs/srv/Ask --interfaces ~/ws/install",
                          [options, &context] { return show_interface(*options, context); });
  shower.option("NAME", options->name, "the interface").required();
  add_folders(shower, *options);
  Verb& writer = add_verb(verb, context, "headers", "write C++ headers with the structs of messages",
                          "  segue ros2 headers sensor_msgs/msg/LaserScan -o include",
                          [options, &context] { return write_headers(*options, context); });
  writer.option("NAME", options->names, "messages; their parts are written, too").required();
  writer.option("-o,--output FOLDER", options->output, "where they go (default: this folder)");
  add_folders(writer, *options);
}

}  // namespace segue::cli
