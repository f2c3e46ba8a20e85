// SPDX-License-Identifier: Apache-2.0
#include <segue/model/file_parts.hpp>
#include <segue/model/files.hpp>
#include <segue/model/halt_parts.hpp>
#include <segue/model/pools.hpp>

#include <algorithm>
#include <charconv>
#include <limits>
#include <utility>

namespace segue::model {

using detail::Fields;
using detail::Source;
using type::Value;

namespace {

/// "local", "tcp://10.0.0.2:7447" or "tcp://[fe80::1]:7447".
bool is_address(std::string_view address) {
  constexpr std::string_view kScheme = "tcp://";
  if (address == "local" || (address.starts_with("unix:") && address.size() > 5)) return true;
  if (!address.starts_with(kScheme)) return false;
  address.remove_prefix(kScheme.size());
  const auto colon = address.rfind(':');
  if (colon == std::string_view::npos || colon == 0) return false;
  const std::string_view digits = address.substr(colon + 1);
  int port = 0;
  const auto [end, status] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  return status == std::errc{} && end == digits.data() + digits.size() && port >= 1 && port <= 65535 &&
         address.find('/') == std::string_view::npos;
}

Host read_host(const std::string& name, const Value& value, const Source& source) {
  const std::string what = "host " + quote(name);
  detail::check_name(name, what, value, source);
  Host host;
  host.name = HostName(name);
  if (value.is_string()) {
    host.address = value.as_string();
  } else {
    Fields fields(value, what, source);
    fields.require("address", "'local' or an address such as 'tcp://10.0.0.2:7447'");
    host.address = fields.text("address");
    host.credentials = fields.text("credentials");
    host.optional = fields.boolean("optional", false);
    fields.finish();
    if (host.address.empty()) return host;
  }
  if (!is_address(host.address)) {
    source.error(
        "bad-address",
        what + ": expected 'local' or an address such as 'tcp://10.0.0.2:7447', got " + quote(host.address),
        value);
  }
  return host;
}

RestartPolicy read_restart(const Value& value, const Source& source) {
  Fields fields(value, "the restart policy", source);
  RestartPolicy policy;
  policy.max = static_cast<int>(fields.integer("max", 0, 1'000'000, "bad-value").value_or(policy.max));
  policy.backoff = fields.duration("backoff").value_or(policy.backoff);
  if (policy.backoff < Duration::zero()) {
    source.error("bad-duration", "the restart policy: 'backoff' must not be negative", value);
  }
  fields.finish();
  return policy;
}

void read_policies(Fields& robot, Robot& result, const Source& source) {
  const Value* policies = robot.find("policies", Value::Kind::Map);
  if (policies == nullptr) return;
  Fields fields(*policies, "the policies", source);
  if (const auto policy = detail::read_failure_policy(fields)) result.policies.on_failure = *policy;
  if (const Value* restart = fields.find("restart", Value::Kind::Map)) {
    result.policies.restart = read_restart(*restart, source);
  }
  result.policies.watch = fields.duration("watch").value_or(result.policies.watch);
  if (result.policies.watch <= Duration::zero()) {
    source.error("bad-duration", "the policies: 'watch' must be longer than nothing", *fields.find("watch"));
  }
  if (result.policies.on_failure == FailurePolicy::Fallback && !result.fallback) {
    source.error("no-fallback",
                 "the policies: 'on_failure: fallback' needs the robot's 'fallback' controller",
                 *fields.find("on_failure"));
  }
  fields.finish();
}

void read_look_ahead(Fields& robot, Robot& result, const Source& source) {
  const Value* look_ahead = robot.find("look_ahead", Value::Kind::Map);
  if (look_ahead == nullptr) return;
  Fields fields(*look_ahead, "the look-ahead", source);
  LookAhead& budget = result.look_ahead;
  budget.processes =
      static_cast<int>(fields.integer("processes", 0, 10'000, "bad-value").value_or(budget.processes));
  budget.memory = fields.size("memory", "bad-value").value_or(budget.memory);
  fields.finish();
}

void read_planner(Fields& robot, Robot& result, const Source& source) {
  const Value* planner = robot.find("planner", Value::Kind::Map);
  if (planner == nullptr) return;
  Fields fields(*planner, "the planner", source);
  PlannerProgram program;
  program.command = fields.texts("command");
  if (program.command.empty() || program.command.front().empty()) {
    source.error("no-command",
                 "the planner needs a 'command', such as [my-planner, \"{domain}\", \"{problem}\"]",
                 *planner);
  }
  program.timeout = fields.duration("timeout").value_or(program.timeout);
  if (program.timeout <= Duration::zero())
    source.error("bad-duration", "the planner: 'timeout' must be longer than nothing",
                 *fields.find("timeout"));
  program.memory = fields.size("memory", "bad-value").value_or(program.memory);
  fields.finish();
  result.planner = std::move(program);
}

/// "screws: 40" or "screws: {count: 40}".
UnitStock read_unit_stock(const std::string& name, const Value& value, const Source& source) {
  const std::string what = "the units " + quote(name);
  if (name.empty() || name.find_first_of("{}*\n") != std::string::npos)
    source.error("invalid-name", what + ": expected the name of a resource of missions, such as 'screws'",
                 value);
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  if (value.is_map()) {
    Fields fields(value, what, source);
    fields.require("count", "how many units there are at first");
    const auto count = fields.integer("count", 0, kMost, "bad-count").value_or(0);
    fields.finish();
    return {name, static_cast<std::uint32_t>(count)};
  }
  if (value.kind() == Value::Kind::Int && value.as_int() >= 0 && value.as_int() <= kMost)
    return {name, static_cast<std::uint32_t>(value.as_int())};
  source.error("bad-count",
               what + ": expected how many there are at first, a number between 0 and " +
                   std::to_string(kMost) + ", or {count: NUMBER}",
               value);
  return {name, 0};
}

void read_units(Fields& robot, Robot& result, const Source& source) {
  const Value* units = robot.find("units", Value::Kind::Map);
  if (units == nullptr) return;
  for (const auto& [name, value] : units->as_map())
    result.units.push_back(read_unit_stock(name, value, source));
}

/// Libraries are names, never paths: they are loaded from the folders that the host is configured with.
void check_libraries(const Robot& robot, Fields& fields, const Source& source) {
  for (const std::string& library : robot.libraries) {
    detail::check_name(library, "the robot: 'libraries' (names, never paths)", *fields.find("libraries"),
                       source);
  }
}

Robot read_robot_body(const Value& root, const Source& source) {
  Fields fields(root, "the robot", source);
  Robot robot;
  robot.where = source.at(root);
  robot.name = fields.required_name("robot", "give it a name");
  if (const Value* hosts = fields.find("hosts", Value::Kind::Map)) {
    for (const auto& [name, value] : hosts->as_map())
      robot.hosts.push_back(read_host(name, value, source));
  }
  robot.libraries = fields.texts("libraries");
  check_libraries(robot, fields, source);
  robot.models = fields.texts("models");
  robot.controllers = fields.texts("controllers");
  robot.transitions = fields.texts("transitions");
  robot.missions = fields.texts("missions");
  if (const std::string fallback = fields.name("fallback"); !fallback.empty()) {
    robot.fallback = NetworkName(fallback);
  }
  robot.halt = detail::read_halt(fields, source);
  read_policies(fields, robot, source);
  read_look_ahead(fields, robot, source);
  robot.pools = detail::read_pools(fields, source);
  robot.pool_budget = detail::read_pool_budget(fields, source);
  read_units(fields, robot, source);
  read_planner(fields, robot, source);
  fields.finish();
  return robot;
}

}  // namespace

std::optional<Robot> read_robot(std::string_view text, const std::string& file, Diagnostics& diagnostics) {
  const std::size_t errors_before = diagnostics.error_count();
  auto robot = read_robot_parts(text, file, diagnostics);
  return diagnostics.error_count() > errors_before ? std::nullopt : std::move(robot);
}

std::optional<Robot> read_robot_parts(std::string_view text, const std::string& file,
                                      Diagnostics& diagnostics) {
  const Source source(file, diagnostics);
  const auto root = source.parse(text);
  if (!root) return std::nullopt;
  Robot robot = read_robot_body(*root, source);
  robot.folder = std::filesystem::path(file).parent_path();
  return robot;
}

std::optional<Robot> load_robot(const std::filesystem::path& file, Diagnostics& diagnostics) {
  const auto text = detail::read_text(file, diagnostics);
  return text ? read_robot(*text, file.string(), diagnostics) : std::nullopt;
}

}  // namespace segue::model
