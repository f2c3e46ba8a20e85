// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <system_error>

#include "init_files.hpp"
#include "output.hpp"

namespace segue::cli {

namespace {

struct InitOptions {
  std::string folder;
  std::string name;
  bool library = false;
};

/// The folder's name as an identifier, for the robot.
std::string name_from(const std::filesystem::path& folder) {
  std::string name;
  const auto full = std::filesystem::absolute(folder).lexically_normal();
  for (const char c : (full.has_filename() ? full : full.parent_path()).filename().string()) {
    name += std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  }
  return is_identifier(name) ? name : "my_robot";
}

Result<void> check_empty(const std::filesystem::path& folder) {
  std::error_code failed_to;
  if (!std::filesystem::exists(folder, failed_to)) return {};
  if (std::filesystem::is_directory(folder, failed_to) && std::filesystem::is_empty(folder, failed_to))
    return {};
  return fail(
      ErrorCode::AlreadyExists,
      quote(folder.native()) + " exists and is not an empty folder; name one that does not exist yet");
}

Result<void> write_all(const std::filesystem::path& folder, const std::vector<InitFile>& files) {
  for (const InitFile& file : files) {
    const auto path = folder / file.path;
    std::error_code failed_to;
    std::filesystem::create_directories(path.parent_path(), failed_to);
    if (failed_to) {
      return fail(ErrorCode::IoError, "cannot create the folder " + quote(path.parent_path().native()) +
                                          ": " + failed_to.message());
    }
    if (auto written = write_file(path, file.text); !written) return written;
  }
  return {};
}

void report_files(const InitOptions& options, const std::vector<InitFile>& files, const Context& context) {
  if (context.json()) {
    type::Value::List names;
    for (const InitFile& file : files)
      names.emplace_back(file.path);
    return print_json(type::Value::map({{"folder", options.folder}, {"files", std::move(names)}}));
  }
  for (const InitFile& file : files)
    print_line("  " + options.folder + '/' + file.path);
  print_line(
      fmt::format("the robot is ready; try\n  cd {}\n  segue check robot.yaml\n"
                  "  segue run robot.yaml --controller explore",
                  options.folder));
}

int init_robot(const InitOptions& options, const Context& context) {
  const std::string name = options.name.empty() ? name_from(options.folder) : options.name;
  if (!is_identifier(name)) {
    return failed(
        context,
        fail(ErrorCode::InvalidArgument,
             quote(name) +
                 " is not a valid robot name; it must begin with a letter, followed by letters, digits, "
                 "'_', '-' or '.'"));
  }
  if (const auto empty = check_empty(options.folder); !empty) return failed(context, empty.error());
  const auto files = init_files(name, options.library);
  if (const auto written = write_all(options.folder, files); !written)
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
