// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/files.hpp>
#include <segue/mission/globals.hpp>

namespace segue::mission {
namespace {

std::string type_of(const type::Value& value) {
  using Kind = type::Value::Kind;
  switch (value.kind()) {
    case Kind::Bool:
      return "bool";
    case Kind::Int:
    case Kind::UInt:
      return "int";
    case Kind::Float:
      return "float";
    case Kind::String:
      return "text";
    case Kind::List:
      return "list";
    case Kind::Map:
      return "map";
    case Kind::Null:
      break;
  }
  return "any";
}

Error locked(const std::string& name) {
  return fail(ErrorCode::PermissionDenied,
              "the global variable " + quote(name) + " is locked by somebody else");
}

}  // namespace

Globals::Globals(const std::vector<Port>& declared) {
  for (const Port& port : declared)
    variables_.try_emplace(port.name, Variable{port.value, port.type, 0});
}

std::optional<type::Value> Globals::get(std::string_view name) const {
  const std::lock_guard guard(mutex_);
  const auto found = variables_.find(name);
  if (found == variables_.end()) return std::nullopt;
  return found->second.value;
}

Result<void> Globals::set(const std::string& name, type::Value value, Key key) {
  const std::lock_guard guard(mutex_);
  const auto [found, fresh] = variables_.try_emplace(name);
  Variable& variable = found->second;
  if (variable.holder != 0 && variable.holder != key) return locked(name);
  if (fresh || variable.type.empty()) variable.type = type_of(value);
  if (!accepts(variable.type, value)) {
    return fail(ErrorCode::TypeMismatch, "the global variable " + quote(name) + " is of type " +
                                             variable.type + ", not " +
                                             std::string(type::describe(value.kind())));
  }
  variable.value = std::move(value);
  return {};
}

Result<void> Globals::erase(const std::string& name) {
  const std::lock_guard guard(mutex_);
  const auto found = variables_.find(name);
  if (found == variables_.end()) return {};
  if (found->second.holder != 0) return locked(name);
  variables_.erase(found);
  return {};
}

Result<Globals::Key> Globals::lock(const std::string& name, Duration timeout) {
  std::unique_lock guard(mutex_);
  variables_.try_emplace(name);
  // Looked up each time: while this waits, others may delete the variable.
  const bool free = unlocked_.wait_for(guard, timeout, [&] { return variables_[name].holder == 0; });
  if (!free) {
    return fail(ErrorCode::DeadlineExceeded, "the global variable " + quote(name) + " stayed locked");
  }
  return variables_[name].holder = ++last_key_;
}

Result<void> Globals::unlock(const std::string& name, Key key, bool force) {
  const std::lock_guard guard(mutex_);
  const auto found = variables_.find(name);
  if (found == variables_.end())
    return fail(ErrorCode::NotFound, "there is no global variable " + quote(name));
  if (!force && found->second.holder != key) return locked(name);
  found->second.holder = 0;
  unlocked_.notify_all();
  return {};
}

type::Value Globals::snapshot() const {
  const std::lock_guard guard(mutex_);
  type::ValueMap map;
  for (const auto& [name, variable] : variables_)
    map.append(name, variable.value);
  return map;
}

}  // namespace segue::mission
