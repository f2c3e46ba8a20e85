// SPDX-License-Identifier: Apache-2.0
#include "installation.hpp"

#include <segue/base/child_process.hpp>
#include <segue/base/file.hpp>
#include <segue/base/folders.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/pipe.hpp>
#include <segue/base/text.hpp>
#include <segue/type/yaml.hpp>

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <map>

namespace ros2 {
namespace {

namespace fs = std::filesystem;
using segue::ErrorCode;
using segue::fail;
using segue::quote;
using segue::Result;
using segue::type::Value;
using Environment = std::vector<std::pair<std::string, std::string>>;

/// How long setup.sh may take.
constexpr std::chrono::seconds kPatience{20};

/// Empty: there is no place for it.
fs::path file_of_installations() {
  const char* chosen = std::getenv("SEGUE_ROS2_INSTALLATIONS");
  if (chosen != nullptr && *chosen != '\0') return chosen;
  const auto folder = segue::configuration_folder();
  return folder ? *folder / "ros2.yaml" : fs::path();
}

segue::Error problem(const fs::path& file, const std::string& text) {
  return fail(ErrorCode::ParseError, file.string() + ": " + text);
}

Result<Installation> read_installation(const fs::path& file, const std::string& name, const Value& entry) {
  Installation found{name, {}, {}};
  if (!entry.is_map())
    return problem(file,
                   "installation " + quote(name) + ": expected {prefix: FOLDER, environment: {NAME: TEXT}}");
  for (const auto& [key, value] : entry.as_map()) {
    if (key == "prefix" && value.is_string()) {
      found.prefix = file.parent_path() / value.as_string();
    } else if (key == "environment" && value.is_map()) {
      for (const auto& [variable, text] : value.as_map()) {
        if (!text.is_string() && text.source_text().empty() && !text.is_number())
          return problem(file,
                         "installation " + quote(name) + ": environment." + variable + " is not a text");
        found.environment.emplace_back(variable,
                                       text.is_string() ? text.as_string() : segue::type::to_yaml(text));
      }
    } else {
      return problem(file, "installation " + quote(name) + ": " + quote(key) +
                               " is not a valid prefix (a text) or environment (a map)");
    }
  }
  if (found.prefix.empty()) return problem(file, "installation " + quote(name) + " has no prefix");
  return found;
}

Result<std::vector<Installation>> read_installations(const fs::path& file) {
  auto content = segue::type::load_yaml(file);
  if (!content) return content.error();
  const Value* entries = content->find("installations");
  if (entries == nullptr || !entries->is_map())
    return problem(file, "expected 'installations', a map of names");
  std::vector<Installation> found;
  for (const auto& [name, entry] : entries->as_map()) {
    auto one = read_installation(file, name, entry);
    if (!one) return one.error();
    found.push_back(std::move(*one));
  }
  return found;
}

std::vector<Installation> stock_installations() {
  std::vector<Installation> found;
  std::error_code failed;
  for (fs::directory_iterator each("/opt/ros", failed), end; !failed && each != end; each.increment(failed)) {
    if (fs::exists(each->path() / "setup.sh", failed))
      found.push_back({each->path().filename().string(), each->path(), {}});
  }
  std::ranges::sort(found, {}, &Installation::name);
  return found;
}

/// A shell that prints its environment after setup.sh, as NAME=VALUE and a zero byte each.
Result<pid_t> start_shell(const fs::path& prefix, const segue::Descriptor& output) {
  segue::ChildProcess shell(3);
  if (auto done = shell.open_null(STDIN_FILENO); !done) return done.error();
  if (auto done = shell.hand_over(output.get(), STDOUT_FILENO); !done) return done.error();
  if (auto done = shell.hand_over(STDERR_FILENO, STDERR_FILENO); !done) return done.error();
  return shell.start("/bin/sh", {"sh", "-c", ". \"$1/setup.sh\" >&2 && exec env -0", "sh", prefix.string()});
}

Result<std::string> environment_after_setup(const fs::path& prefix) {
  auto output = segue::make_pipe();
  if (!output) return output.error();
  auto pid = start_shell(prefix, output->write);
  if (!pid) return pid.error();
  output->write = segue::Descriptor();
  auto text = segue::read_to_end(output->read, kPatience);
  segue::wait_for_end(*pid, text ? segue::Duration(kPatience) : segue::Duration::zero());
  if (!text && text.error().code == ErrorCode::DeadlineExceeded)
    return fail(ErrorCode::DeadlineExceeded,
                (prefix / "setup.sh").string() + " takes longer than " + segue::format_duration(kPatience));
  if (!text) return text;
  if (text->find("AMENT_PREFIX_PATH=") == std::string::npos)
    return fail(ErrorCode::NotFound, (prefix / "setup.sh").string() +
                                         " does not set AMENT_PREFIX_PATH: it is not that of a ROS 2");
  return *text;
}

Environment split_environment(std::string_view text) {
  Environment found;
  while (!text.empty()) {
    const auto end = std::min(text.find('\0'), text.size());
    const std::string_view entry = text.substr(0, end);
    if (const auto equals = entry.find('='); equals != std::string_view::npos)
      found.emplace_back(entry.substr(0, equals), entry.substr(equals + 1));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return found;
}

/// The environment in that prefix, which is the same as long as this process runs.
Result<Environment> environment_of(const fs::path& prefix) {
  static segue::Mutex mutex;
  static std::map<fs::path, Environment> known;
  const segue::Lock lock(mutex);  // the first one of a prefix, for all that start at once
  if (const auto found = known.find(prefix); found != known.end()) return found->second;
  std::error_code ignored;
  if (!fs::exists(prefix / "setup.sh", ignored))
    return fail(ErrorCode::NotFound,
                quote(prefix.string()) + " has no setup.sh: it is not the prefix of a ROS 2");
  auto text = environment_after_setup(prefix);
  if (!text) return text.error();
  return known[prefix] = split_environment(*text);
}

Result<Installation> choose(const std::vector<Installation>& all, const std::string& name,
                            const std::string& place) {
  std::string names;
  for (const Installation& each : all) {
    if (each.name == name || (name.empty() && all.size() == 1)) return each;
    names += (names.empty() ? "" : ", ") + each.name;
  }
  if (all.empty())
    return fail(ErrorCode::NotFound, "no installation of ROS 2 is named on this computer: there is neither " +
                                         place + " nor one in /opt/ros");
  return fail(ErrorCode::NotFound,
              (name.empty() ? "name one of the installations of ROS 2: "
                            : "installation " + quote(name) + " is not known; there are ") +
                  names);
}

}  // namespace

Result<Installation> find_installation(const std::string& name) {
  const fs::path file = file_of_installations();
  std::error_code ignored;
  const bool has_file = !file.empty() && fs::exists(file, ignored);
  auto all = has_file ? read_installations(file) : Result<std::vector<Installation>>(stock_installations());
  if (!all) return all.error();
  auto found = choose(*all, name, file.string());
  if (!found) return found;
  auto environment = environment_of(found->prefix);
  if (!environment) return environment.error();
  std::swap(found->environment, *environment);
  for (const auto& [key, value] : *environment)
    found->set_variable(key, value);
  return found;
}

std::string_view Installation::variable(std::string_view name_of_it) const {
  const auto known = std::ranges::find(environment, name_of_it, &Environment::value_type::first);
  return known == environment.end() ? std::string_view() : std::string_view(known->second);
}

void Installation::set_variable(const std::string& name_of_it, const std::string& value) {
  const auto known = std::ranges::find(environment, name_of_it, &Environment::value_type::first);
  if (known == environment.end()) {
    environment.emplace_back(name_of_it, value);
  } else {
    known->second = value;
  }
}

Result<fs::path> Installation::find_program(const std::string& package, const std::string& executable) const {
  std::string_view rest = variable("AMENT_PREFIX_PATH");
  std::string others;
  std::error_code failed;
  while (!rest.empty()) {
    const auto end = std::min(rest.find(':'), rest.size());
    const fs::path folder = fs::path(rest.substr(0, end)) / "lib" / package;
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (fs::is_regular_file(folder / executable, failed) &&
        ::access((folder / executable).c_str(), X_OK) == 0)
      return folder / executable;
    for (fs::directory_iterator each(folder, failed), last; !failed && each != last; each.increment(failed)) {
      if (each->is_regular_file(failed) && ::access(each->path().c_str(), X_OK) == 0)
        others += (others.empty() ? "" : ", ") + each->path().filename().string();
    }
  }
  if (others.empty())
    return fail(ErrorCode::NotFound,
                "installation " + name + " has no programs of a package " + quote(package));
  return fail(ErrorCode::NotFound, "package " + package + " of installation " + name + " has no program " +
                                       quote(executable) + "; it has " + others);
}

}  // namespace ros2
