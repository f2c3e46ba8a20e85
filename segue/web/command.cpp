// SPDX-License-Identifier: Apache-2.0
#include <segue/web/command.hpp>

#include <segue/base/text.hpp>
#include <segue/type/json.hpp>
#include <segue/type/yaml.hpp>

#include <algorithm>
#include <utility>

namespace segue::web {

namespace {

using type::Value;

constexpr double kLongestTimeout = 600;

Error argument_error(std::string_view name, std::string_view problem) {
  return fail(ErrorCode::InvalidArgument, "argument " + quote(name) + " " + std::string(problem));
}

}  // namespace

Result<Command> Command::parse(std::string_view text) {
  if (text.size() > kLongestCommand) return fail(ErrorCode::InvalidArgument, "the message is too long");
  const auto message = type::parse_json(text);
  if (!message) return message.error();
  if (!message->is_map()) return fail(ErrorCode::InvalidArgument, "a message is a map");
  for (const auto& [key, value] : message->as_map()) {
    if (key != "id" && key != "verb" && key != "arguments")
      return fail(ErrorCode::InvalidArgument, "a message has no " + quote(key));
  }
  const Value* id = message->find("id");
  const Value* verb = message->find("verb");
  const Value* arguments = message->find("arguments");
  if (id == nullptr || id->kind() != Value::Kind::Int || id->as_int() < 0)
    return fail(ErrorCode::InvalidArgument, "a message needs \"id\", a number");
  if (verb == nullptr || !verb->is_string())
    return fail(ErrorCode::InvalidArgument, "a message needs \"verb\", a text");
  if (arguments != nullptr && !arguments->is_map())
    return fail(ErrorCode::InvalidArgument, "\"arguments\" must be a map");
  Command command;
  command.id_ = id->as_uint();
  command.verb_ = verb->as_string();
  command.arguments_ = arguments != nullptr ? *arguments : Value(type::ValueMap{});
  return command;
}

Result<std::string> Command::text(std::string_view name) const {
  const Value* value = arguments_.find(name);
  if (value == nullptr) return argument_error(name, "is missing");
  if (!value->is_string()) return argument_error(name, "must be text");
  return value->as_string();
}

Result<std::string> Command::text_or(std::string_view name, std::string_view otherwise) const {
  return arguments_.find(name) == nullptr ? Result<std::string>(std::string(otherwise)) : text(name);
}

Result<bool> Command::flag(std::string_view name) const {
  const Value* value = arguments_.find(name);
  if (value == nullptr) return false;
  if (!value->is_bool()) return argument_error(name, "must be true or false");
  return value->as_bool();
}

Result<std::vector<std::string>> Command::texts(std::string_view name) const {
  const Value* value = arguments_.find(name);
  if (value == nullptr) return argument_error(name, "is missing");
  if (!value->is_list() || !std::ranges::all_of(value->as_list(), &Value::is_string))
    return argument_error(name, "must be a list of texts");
  std::vector<std::string> texts;
  for (const Value& text : value->as_list())
    texts.push_back(text.as_string());
  return texts;
}

Result<std::uint64_t> Command::number_or(std::string_view name, std::uint64_t otherwise) const {
  const Value* value = arguments_.find(name);
  if (value == nullptr) return otherwise;
  const bool fits =
      value->kind() == Value::Kind::UInt || (value->kind() == Value::Kind::Int && value->as_int() >= 0);
  if (!fits) return argument_error(name, "must be a non-negative integer");
  return value->as_uint();
}

Result<Value> Command::value() const {
  const Value* value = arguments_.find("value");
  const Value* yaml = arguments_.find("yaml");
  if ((value == nullptr) == (yaml == nullptr))
    return fail(ErrorCode::InvalidArgument, "either \"value\" or \"yaml\" is needed");
  if (value != nullptr) return *value;
  if (!yaml->is_string()) return argument_error("yaml", "must be text");
  return type::parse_yaml(yaml->as_string(), "the value");
}

Result<TimePoint> Command::deadline(Duration otherwise) const {
  const Value* value = arguments_.find("timeout_s");
  if (value == nullptr) return monotonic_now() + otherwise;
  if (!value->is_number() || !(value->as_double() >= 0 && value->as_double() <= kLongestTimeout))
    return argument_error("timeout_s", "must be a number from 0 to 600");
  return monotonic_now() +
         std::chrono::duration_cast<Duration>(std::chrono::duration<double>(value->as_double()));
}

Result<void> Command::only(const std::vector<std::string>& names) const {
  for (const auto& [key, value] : arguments_.as_map()) {
    if (std::ranges::find(names, key) == names.end())
      return fail(ErrorCode::InvalidArgument,
                  quote(verb_) + " has no argument " + quote(key) + did_you_mean(key, names));
  }
  return {};
}

}  // namespace segue::web
