// SPDX-License-Identifier: Apache-2.0
#include <segue/model/robot_condition.hpp>

#include <segue/base/text.hpp>
#include <segue/model/condition_parts.hpp>

#include <utility>

namespace segue::model {

using type::Value;

namespace {

std::string sentence_of(const TaskReaches& when) {
  return "task " + quote(when.task) + " is " + when.state;
}
std::string sentence_of(const SampleShows& when) {
  return "a sample of " + to_string(when.port) + " showed " + when.what.text;
}
std::string sentence_of(const OperationAnswers& when) {
  return to_string(when.operation) + " answered " + type::describe(when.is);
}

std::string denial_of(const TaskReaches& when) {
  return "task " + quote(when.task) + " is not " + when.state;
}
std::string denial_of(const SampleShows& when) {
  return "no sample of " + to_string(when.port) + " shows " + when.what.text;
}
std::string denial_of(const OperationAnswers& when) {
  return to_string(when.operation) + " does not answer " + type::describe(when.is);
}

Value written(const TaskReaches& when) {
  return Value::map({{"task", when.task}, {"state", when.state}});
}
Value written(const SampleShows& when) {
  return Value::map({{"port", to_string(when.port)}, {"where", when.what.text}});
}
Value written(const OperationAnswers& when) {
  return Value::map({{"call", to_string(when.operation)}, {"is", when.is}});
}

}  // namespace

Member parse_member(std::string_view text) {
  const auto dot = text.find('.');
  if (dot == std::string_view::npos) return {};
  return {std::string(text.substr(0, dot)), std::string(text.substr(dot + 1))};
}

std::string to_string(const Member& member) {
  return member.task + '.' + member.name;
}

const std::string& task_of(const RobotCondition& condition) {
  if (const auto* reaches = std::get_if<TaskReaches>(&condition)) return reaches->task;
  if (const auto* shows = std::get_if<SampleShows>(&condition)) return shows->port.task;
  return std::get<OperationAnswers>(condition).operation.task;
}

std::string sentence(const RobotCondition& condition) {
  return std::visit([](const auto& when) { return sentence_of(when); }, condition);
}

std::string denial(const RobotCondition& condition) {
  return std::visit([](const auto& when) { return denial_of(when); }, condition);
}

namespace detail {

Member read_member(std::string_view text, std::string_view example, const std::string& what, const Value& at,
                   const Source& source) {
  Member member = parse_member(text);
  if (!is_identifier(member.task) || member.name.empty()) {
    source.error(
        "bad-member",
        what + ": expected a task and a member of it such as " + quote(example) + ", got " + quote(text), at);
  }
  return member;
}

std::vector<RobotCondition> read_conditions(Fields& fields, const Source& source) {
  std::vector<RobotCondition> found;
  if (fields.find("task") != nullptr) {
    fields.require("state", "the state that is meant");
    found.emplace_back(TaskReaches{fields.name("task"), fields.text("state")});
  }
  if (const Value* port = fields.find("port", Value::Kind::String)) {
    auto what = parse_condition(fields.text("where"));
    if (!what) source.error("bad-condition", fields.what() + ": " + what.error().message, *port);
    found.emplace_back(
        SampleShows{read_member(port->as_string(), "planner.status", fields.what(), *port, source),
                    what ? std::move(*what) : Condition{}});
  }
  if (const Value* operation = fields.find("call", Value::Kind::String)) {
    const Value* is = fields.require("is", "the answer that is meant");
    found.emplace_back(OperationAnswers{
        read_member(operation->as_string(), "planner.failed", fields.what(), *operation, source),
        is == nullptr ? Value() : *is});
  }
  return found;
}

Value write_condition(const RobotCondition& condition) {
  return std::visit([](const auto& when) { return written(when); }, condition);
}

}  // namespace detail
}  // namespace segue::model
