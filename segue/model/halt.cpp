// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/condition_parts.hpp>
#include <segue/model/controller_names.hpp>
#include <segue/model/halt_parts.hpp>
#include <segue/model/member_check.hpp>
#include <segue/model/validate.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

namespace segue::model {

using type::Value;

namespace {

constexpr std::string_view kNoun = "the robot's 'halt'";

std::vector<HaltCondition> read_all(detail::Fields& halt, std::string_view key,
                                    const detail::Source& source) {
  std::vector<HaltCondition> all;
  for (const Value& item : halt.entries(key)) {
    detail::Fields fields(item, quote(key) + " of " + std::string(kNoun), source);
    auto found = detail::read_conditions(fields, source);
    fields.finish();
    if (found.size() == 1) {
      all.push_back({std::move(found.front()), source.at(item)});
    } else {
      source.error("bad-condition",
                   fields.what() + ": expected exactly one of {task, state}, {port, where} and {call, is}",
                   item);
    }
  }
  return all;
}

/// The controllers that bring the robot to rest together; an unknown one is left out.
std::vector<const Network*> controllers_of(const Halt& halt, const std::vector<Network>& networks) {
  std::vector<const Network*> found;
  for (const NetworkName& name : controllers_in(halt.controller.str())) {
    const auto network = std::ranges::find(networks, name, &Network::name);
    if (network != networks.end()) found.push_back(&*network);
  }
  return found;
}

const Network* with_task(const std::vector<const Network*>& networks, const std::string& task) {
  const auto found = std::ranges::find_if(
      networks, [&](const Network* network) { return network->find_task(TaskId(task)) != nullptr; });
  return found == networks.end() ? nullptr : *found;
}

std::vector<const Network*> all_of(const std::vector<Network>& networks) {
  std::vector<const Network*> all;
  for (const Network& network : networks)
    all.push_back(&network);
  return all;
}

void check_tasks(const std::vector<HaltCondition>& conditions, const std::vector<const Network*>& networks,
                 const std::string& lacks, Diagnostics& diagnostics) {
  std::vector<std::string> tasks;
  for (const Network* network : networks) {
    for (const Task& task : network->tasks)
      tasks.push_back(task.id.str());
  }
  for (const HaltCondition& one : conditions) {
    const std::string& task = task_of(one.condition);
    if (with_task(networks, task) != nullptr) continue;
    diagnostics.error("unknown-task",
                      std::string(kNoun) + ": " + lacks + ' ' + quote(task) + did_you_mean(task, tasks),
                      one.where);
  }
}

}  // namespace

std::optional<Halt> detail::read_halt(Fields& robot, const Source& source) {
  const Value* value = robot.find("halt", Value::Kind::Map);
  if (value == nullptr) return std::nullopt;
  Fields fields(*value, std::string(kNoun), source);
  Halt halt;
  halt.where = source.at(*value);
  fields.require("controller",
                 "the controller that brings it to rest, such as 'hold', or several: 'hold+guard'");
  const std::string controller = fields.text("controller");
  halt.controller = joined_name(controllers_in(controller));
  for (const NetworkName& name : controllers_in(controller))
    check_name(name.str(), std::string(kNoun) + ": 'controller'", *value, source);
  halt.at_rest = read_all(fields, "at_rest", source);
  halt.within = fields.duration("within").value_or(halt.within);
  if (halt.within <= Duration::zero()) {
    source.error("bad-duration", std::string(kNoun) + ": 'within' must be longer than nothing", *value);
  }
  halt.when = read_all(fields, "when", source);
  fields.finish();
  return halt;
}

void detail::check_halt(const Robot& robot, const std::vector<Network>& networks, Diagnostics& diagnostics) {
  if (!robot.halt) return;
  const Halt& halt = *robot.halt;
  std::vector<std::string> names;
  for (const Network& network : networks)
    names.push_back(network.name.str());
  bool is_known = true;
  for (const NetworkName& name : controllers_in(halt.controller.str())) {
    if (std::ranges::find(names, name.str()) != names.end()) continue;
    is_known = false;
    diagnostics.error("unknown-controller",
                      std::string(kNoun) + ": " + quote(name.str()) + " is none of the robot's controllers" +
                          did_you_mean(name.str(), names),
                      halt.where);
  }
  if (!is_known) return;
  check_tasks(halt.at_rest, controllers_of(halt, networks),
              "controller " + quote(halt.controller.str()) + " has no task", diagnostics);
  check_tasks(halt.when, all_of(networks), "no controller has a task", diagnostics);
}

void check_halt_members(const Robot& robot, const std::vector<Network>& networks,
                        const ComponentCatalog& catalog, Diagnostics& diagnostics) {
  if (!robot.halt) return;
  const Halt& halt = *robot.halt;
  const auto check = [&](const HaltCondition& one, const std::vector<const Network*>& where) {
    const Network* network = with_task(where, task_of(one.condition));
    if (network == nullptr) return;
    MemberCheck(std::string(kNoun), *network, catalog, diagnostics).condition(one.condition, one.where);
  };
  for (const HaltCondition& one : halt.at_rest)
    check(one, controllers_of(halt, networks));
  for (const HaltCondition& one : halt.when)
    check(one, all_of(networks));
}

}  // namespace segue::model
