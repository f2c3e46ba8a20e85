// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/globals_store.hpp>
#include <segue/mission/mission_io.hpp>

#include <algorithm>
#include <array>
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

/// Whether a variable of type `wanted` may hold an object of type `kind`. Types that missions do not know
/// accept anything, as accepts() does.
bool may_hold(std::string_view wanted, std::string_view kind) {
  constexpr std::array<std::string_view, 6> kKnown = {"bool", "int", "float", "text", "list", "map"};
  return std::ranges::find(kKnown, wanted) == kKnown.end() || wanted == kind ||
         (wanted == "float" && kind == "int");
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
  auto found = content(name);
  if (!found) return std::nullopt;
  return std::move(found->value);
}

std::optional<GlobalContent> Globals::content(std::string_view name) const {
  const Lock guard(variables_->mutex);
  const Variable variable = find(name);
  if (!variable.content) return std::nullopt;
  return GlobalContent{variable.content->shown(), variable.content->object};
}

Result<void> Globals::set(const std::string& name, type::Value value, Key key, std::string_view type) {
  const std::string kind(type::describe(value.kind()));
  return set(name, Content{std::move(value), std::string(type), {}}, key, kind);
}

Result<void> Globals::set_object(const std::string& name, std::shared_ptr<const GlobalObject> object,
                                 std::string_view kind, Key key, std::string_view type) {
  return set(name, Content{{}, std::string(type), std::move(object)}, key, std::string(kind));
}

/// `kind` says what the content is, for messages, and for an object also which variables may hold it. The
/// content has the type that a new variable gets.
Result<void> Globals::set(const std::string& name, Content content, Key key, const std::string& kind) {
  const Lock guard(variables_->mutex);
  Variable variable = find(name);
  if (variable.holder != 0 && variable.holder != key) return locked(name);
  if (variable.content)
    content.type = variable.content->type;
  else if (content.type.empty())
    content.type = content.object ? "any" : type_of(content.value);
  const bool fits = content.object ? may_hold(content.type, kind) : accepts(content.type, content.value);
  if (!fits) {
    return fail(ErrorCode::TypeMismatch,
                "the global variable " + quote(name) + " is of type " + content.type + ", not " + kind);
  }
  variable.content = std::make_shared<const Content>(std::move(content));
  return put(name, std::move(variable));
}

Result<void> Globals::erase(const std::string& name) {
  const Lock guard(variables_->mutex);
  const Variable variable = find(name);
  if (!variable.content) return {};
  if (variable.holder != 0) return locked(name);
  return put(name, {});
}

Result<Globals::Key> Globals::lock(const std::string& name, Duration timeout) {
  Lock guard(variables_->mutex);
  // Looked up each time: another thread may erase the variable while this one waits.
  if (!variables_->unlocked.wait_for(variables_->mutex, timeout, [&]() SEGUE_REQUIRES(variables_->mutex) {
        return find(name).holder == 0;
      }))
    return fail(ErrorCode::DeadlineExceeded, "the global variable " + quote(name) + " stayed locked");
  Variable variable = find(name);
  if (!variable.content) variable.content = std::make_shared<const Content>();
  const Key key = variable.holder = ++variables_->last_key;
  if (auto done = put(name, std::move(variable)); !done) return done.error();
  return key;
}

Result<void> Globals::unlock(const std::string& name, Key key, bool force) {
  const Lock guard(variables_->mutex);
  Variable variable = find(name);
  if (!variable.content) return fail(ErrorCode::NotFound, "there is no global variable " + quote(name));
  if (!force && variable.holder != key) return locked(name);
  variable.holder = 0;
  return put(name, std::move(variable));
}

bool Globals::is_locked(std::string_view name, Key key) const {
  const Lock guard(variables_->mutex);
  const Variable variable = find(name);
  return variable.content && variable.holder != 0 && variable.holder != key;
}

type::Value Globals::snapshot() const {
  type::ValueMap map;
  for (auto& [name, content] : contents())
    map.append(name, std::move(content.value));
  return map;
}

std::vector<std::pair<std::string, GlobalContent>> Globals::contents() const {
  const Lock guard(variables_->mutex);
  std::set<std::string, std::less<>> names;
  for (const auto& [name, entry] : variables_->by_name)
    names.insert(name);
  if (view_ && view_->kept_aside) {
    view_->all = true;
    for (const auto& [name, use] : view_->uses)
      names.insert(name);
  }
  std::vector<std::pair<std::string, GlobalContent>> found;
  for (const std::string& name : names) {
    if (const Variable variable = find(name); variable.content)
      found.emplace_back(name, GlobalContent{variable.content->shown(), variable.content->object});
  }
  return found;
}

}  // namespace segue::mission
