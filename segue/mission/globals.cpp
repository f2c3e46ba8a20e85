// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/files.hpp>
#include <segue/mission/globals_store.hpp>

#include <set>

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
              "the global variable " + quote(name) + " is locked by another holder");
}

}  // namespace

Globals::Globals(const std::vector<Port>& declared) : variables_(std::make_shared<Variables>()) {
  for (const Port& port : declared) {
    auto content = std::make_shared<const Content>(Content{port.value, port.type});
    variables_->by_name.try_emplace(port.name, Entry{{std::move(content), 0}});
  }
}

std::optional<type::Value> Globals::get(std::string_view name) const {
  const std::lock_guard guard(variables_->mutex);
  const Variable variable = look(name);
  if (!variable.content) return std::nullopt;
  return variable.content->value;
}

Result<void> Globals::set(const std::string& name, type::Value value, Key key, std::string_view type) {
  const std::lock_guard guard(variables_->mutex);
  Variable variable = look(name);
  if (variable.holder != 0 && variable.holder != key) return locked(name);
  const std::string wanted = variable.content ? variable.content->type
                             : type.empty()   ? type_of(value)
                                              : std::string(type);
  if (!accepts(wanted, value)) {
    return fail(ErrorCode::TypeMismatch, "the global variable " + quote(name) + " is of type " + wanted +
                                             ", not " + std::string(type::describe(value.kind())));
  }
  variable.content = std::make_shared<const Content>(Content{std::move(value), wanted});
  return put(name, std::move(variable));
}

Result<void> Globals::erase(const std::string& name) {
  const std::lock_guard guard(variables_->mutex);
  const Variable variable = look(name);
  if (!variable.content) return {};
  if (variable.holder != 0) return locked(name);
  return put(name, {});
}

Result<Globals::Key> Globals::lock(const std::string& name, Duration timeout) {
  std::unique_lock guard(variables_->mutex);
  // Looked up each time: another thread may erase the variable while this one waits.
  if (!variables_->unlocked.wait_for(guard, timeout, [&] { return look(name).holder == 0; }))
    return fail(ErrorCode::DeadlineExceeded, "the global variable " + quote(name) + " stayed locked");
  Variable variable = look(name);
  if (!variable.content) variable.content = std::make_shared<const Content>();
  const Key key = variable.holder = ++variables_->last_key;
  if (auto done = put(name, std::move(variable)); !done) return done.error();
  return key;
}

Result<void> Globals::unlock(const std::string& name, Key key, bool force) {
  const std::lock_guard guard(variables_->mutex);
  Variable variable = look(name);
  if (!variable.content) return fail(ErrorCode::NotFound, "there is no global variable " + quote(name));
  if (!force && variable.holder != key) return locked(name);
  variable.holder = 0;
  return put(name, std::move(variable));
}

bool Globals::is_locked(std::string_view name, Key key) const {
  const std::lock_guard guard(variables_->mutex);
  const Variable variable = look(name);
  return variable.content && variable.holder != 0 && variable.holder != key;
}

type::Value Globals::snapshot() const {
  const std::lock_guard guard(variables_->mutex);
  std::set<std::string, std::less<>> names;
  for (const auto& [name, entry] : variables_->by_name)
    names.insert(name);
  if (view_ && view_->kept_aside) {
    view_->all = true;
    for (const auto& [name, use] : view_->uses)
      names.insert(name);
  }
  type::ValueMap map;
  for (const std::string& name : names) {
    if (const Variable variable = look(name); variable.content) map.append(name, variable.content->value);
  }
  return map;
}

}  // namespace segue::mission
