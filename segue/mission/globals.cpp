// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/files.hpp>
#include <segue/mission/globals.hpp>

#include <condition_variable>
#include <map>
#include <mutex>

namespace segue::mission {

struct Globals::Variables {
  struct Variable {
    type::Value value;
    std::string type = "any";
    Key holder = 0;
  };

  std::mutex mutex;
  std::condition_variable unlocked;
  std::map<std::string, Variable, std::less<>> by_name;
  Key last_key = 0;
};

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
  for (const Port& port : declared)
    variables_->by_name.try_emplace(port.name, Variables::Variable{port.value, port.type, 0});
}

std::optional<type::Value> Globals::get(std::string_view name) const {
  const std::lock_guard guard(variables_->mutex);
  const auto found = variables_->by_name.find(name);
  if (found == variables_->by_name.end()) return std::nullopt;
  return found->second.value;
}

Result<void> Globals::set(const std::string& name, type::Value value, Key key, std::string_view type) {
  const std::lock_guard guard(variables_->mutex);
  const auto found = variables_->by_name.find(name);
  const bool fresh = found == variables_->by_name.end();
  if (!fresh && found->second.holder != 0 && found->second.holder != key) return locked(name);
  const std::string wanted = !fresh ? found->second.type : type.empty() ? type_of(value) : std::string(type);
  if (!accepts(wanted, value)) {
    return fail(ErrorCode::TypeMismatch, "the global variable " + quote(name) + " is of type " + wanted +
                                             ", not " + std::string(type::describe(value.kind())));
  }
  if (fresh) {
    variables_->by_name.emplace(name, Variables::Variable{std::move(value), wanted, 0});
  } else {
    found->second.value = std::move(value);
  }
  return {};
}

Result<void> Globals::erase(const std::string& name) {
  const std::lock_guard guard(variables_->mutex);
  const auto found = variables_->by_name.find(name);
  if (found == variables_->by_name.end()) return {};
  if (found->second.holder != 0) return locked(name);
  variables_->by_name.erase(found);
  return {};
}

Result<Globals::Key> Globals::lock(const std::string& name, Duration timeout) {
  std::unique_lock guard(variables_->mutex);
  // Looked up each time: another thread may erase the variable while this one waits.
  const auto holder = [&]() -> Key& { return variables_->by_name[name].holder; };
  if (!variables_->unlocked.wait_for(guard, timeout, [&] { return holder() == 0; }))
    return fail(ErrorCode::DeadlineExceeded, "the global variable " + quote(name) + " stayed locked");
  return holder() = ++variables_->last_key;
}

Result<void> Globals::unlock(const std::string& name, Key key, bool force) {
  const std::lock_guard guard(variables_->mutex);
  const auto found = variables_->by_name.find(name);
  if (found == variables_->by_name.end())
    return fail(ErrorCode::NotFound, "there is no global variable " + quote(name));
  if (!force && found->second.holder != key) return locked(name);
  found->second.holder = 0;
  variables_->unlocked.notify_all();
  return {};
}

bool Globals::is_locked(std::string_view name, Key key) const {
  const std::lock_guard guard(variables_->mutex);
  const auto found = variables_->by_name.find(name);
  return found != variables_->by_name.end() && found->second.holder != 0 && found->second.holder != key;
}

type::Value Globals::snapshot() const {
  const std::lock_guard guard(variables_->mutex);
  type::ValueMap map;
  for (const auto& [name, variable] : variables_->by_name)
    map.append(name, variable.value);
  return map;
}

}  // namespace segue::mission
