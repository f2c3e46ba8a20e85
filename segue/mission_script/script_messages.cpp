// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission/program.hpp>
#include <segue/mission_script/script_data.hpp>
#include <segue/mission_script/script_messages.hpp>
#include <segue/type/json.hpp>
#include <segue/type/value_at.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace segue::mission::detail {

using type::Value;
using type::ValueMap;

namespace {

constexpr std::size_t kHead = 4;
constexpr std::size_t kLongestLine = 4096;

/// The place of a number that JSON cannot represent: ".scan[3]"; nothing if there is none.
std::optional<std::string> not_finite(const Value& value) {
  if (value.kind() == Value::Kind::Float && !std::isfinite(value.as_double())) return "";
  if (value.is_list()) {
    const Value::List& list = value.as_list();
    for (std::size_t i = 0; i < list.size(); ++i) {
      if (auto inside = not_finite(list[i])) return "[" + std::to_string(i) + "]" + *inside;
    }
  }
  if (value.is_map()) {
    for (const auto& [key, item] : value.as_map()) {
      if (auto inside = not_finite(item)) return "." + key + *inside;
    }
  }
  return std::nullopt;
}

Result<Value> inputs_of(const ActionCall& call) {
  ValueMap inputs;
  const auto& ports = call.action().inputs;
  for (std::size_t i = 0; i < ports.size(); ++i) {
    if (ports[i].from_world) continue;
    if (const auto place = not_finite(call.inputs()[i])) {
      return fail(ErrorCode::InvalidArgument,
                  "input " + quote(ports[i].name + *place) +
                      " is infinite or not a number, which cannot be passed to a script");
    }
    inputs.append(ports[i].name, call.inputs()[i]);
  }
  return Value(std::move(inputs));
}

Value outputs_of(ActionCall& call) {
  ValueMap outputs;
  const auto& ports = call.action().outputs;
  for (std::size_t i = 0; i < ports.size(); ++i)
    outputs.append(ports[i].name, call.outputs()[i]);
  return outputs;
}

/// The ports of the type "tuple", which are lists to all but scripts.
Value tuples_of(const std::vector<Port>& ports) {
  Value::List names;
  for (const Port& port : ports) {
    if (port.type == "tuple") names.emplace_back(port.name);
  }
  return names;
}

std::string name_of(const Program& program, StateIndex index) {
  const State& state = program.state(index);
  return state.title.empty() ? state.id.str() : state.title;
}

Value branches_of(const ActionCall& call) {
  Value::List branches;
  for (const BranchResult& branch : call.branches()) {
    branches.push_back(
        Value::map({{"id", call.program().mission().script_id(branch.state)},
                    {"state", call.program().state(branch.state).id.str()},
                    {"name", name_of(call.program(), branch.state)},
                    {"outcome", static_cast<std::int64_t>(branch.outcome)},
                    {"outcome_name", call.program().outcome_name(branch.state, branch.outcome)},
                    {"error", branch.error}}));
  }
  return branches;
}

/// The states around that of the call, the outermost first. Libraries appear as in RAFCON: the state that
/// stands for one, then the root of its machine.
Value parents_of(const ActionCall& call) {
  const Program& program = call.program();
  const std::string path = call.path();
  Value::List parents;
  StateIndex here = 0;
  std::size_t end = 0;
  const auto add = [&] {
    parents.push_back(Value::map({{"name", name_of(program, here)},
                                  {"state", program.mission().script_id(here)},
                                  {"path", path.substr(0, end == 0 ? 0 : end - 1)}}));
  };
  while (here != call.state()) {
    add();
    if (program.node(here).kind == StateKind::Library) {
      here = program.node(here).library;
      continue;
    }
    if (end >= path.size()) break;
    const std::size_t next = std::min(path.find('/', end), path.size());
    const std::string id = path.substr(end, next - end);
    const auto& children = program.node(here).children;
    const auto child =
        std::ranges::find_if(children, [&](StateIndex each) { return program.state(each).id.str() == id; });
    if (child == children.end()) break;
    here = *child;
    end = next + 1;
  }
  return parents;
}

std::string folder_of(const Mission& mission) {
  Action of_the_mission;
  of_the_mission.run = Script{};
  return script_file(mission, of_the_mission).parent_path().string();
}

/// The script, and the folder from which it may import modules: its own, or that of the mission file.
void add_script(ValueMap& message, const Action& action, const Mission& mission) {
  const auto& script = std::get<Script>(action.run);
  const std::filesystem::path file = script_file(mission, action);
  if (script.text.empty()) {
    message.append("file", file.string());
  } else {
    message.append("text", script.text);
  }
  message.append("folder", file.parent_path().string());
}

ValueMap shown_data(const WorldView& world) {
  ValueMap shown;
  for (const auto& [name, data] : world.data()) {
    if (Value value = data->shown(); !value.is_null()) shown.append(name, std::move(value));
  }
  return shown;
}

/// Empty: the script may use one.
std::string why_no_robot(const ActionCall& call, bool has_robot) {
  if (!call.action().controllers)
    return "the action does not declare 'controllers' (which may be empty), so it uses no robot";
  if (!has_robot) return "there is no robot: the mission runs without one";
  return call.backward() ? "an action that is undone uses no robot" : "";
}

}  // namespace

Result<std::string> framed(const Value& message, std::size_t largest) {
  const std::string body = type::to_json(message, -1);
  if (body.size() > largest) {
    return fail(ErrorCode::ResourceExhausted, std::to_string(body.size()) + " bytes are more than the " +
                                                  std::to_string(largest) +
                                                  " that can be passed to a script");
  }
  std::string text(kHead, '\0');
  for (std::size_t i = 0; i < kHead; ++i)
    text[i] = static_cast<char>((body.size() >> (8 * i)) & 0xFFU);
  return text + body;
}

void MessageReader::append(std::string_view text) {
  if (read_ > 0) text_.erase(0, std::exchange(read_, 0));
  text_ += text;
}

Result<std::optional<Value>> MessageReader::next() {
  const std::string_view left = std::string_view(text_).substr(read_);
  if (left.size() < kHead) return std::optional<Value>();
  std::size_t size = 0;
  for (std::size_t i = 0; i < kHead; ++i)
    size |= static_cast<std::size_t>(static_cast<unsigned char>(left[i])) << (8 * i);
  if (size > largest_) {
    return fail(ErrorCode::ResourceExhausted, "a message of " + std::to_string(size) +
                                                  " bytes, where at most " + std::to_string(largest_) +
                                                  " are allowed");
  }
  if (left.size() - kHead < size) return std::optional<Value>();
  read_ += kHead + size;
  auto value = type::parse_json(left.substr(kHead, size));
  if (!value) return value.error();
  return std::optional<Value>(std::move(*value));
}

void LineReader::append(std::string_view text) {
  if (read_ > 0) text_.erase(0, std::exchange(read_, 0));
  text_ += text;
}

std::optional<std::string> LineReader::next() {
  const std::string_view left = std::string_view(text_).substr(read_);
  const std::size_t end = left.find('\n');
  if (end == std::string_view::npos && left.size() < kLongestLine) return std::nullopt;
  const std::size_t size = std::min({end, left.size(), kLongestLine});
  read_ += size == end ? size + 1 : size;
  return std::string(left.substr(0, size));
}

std::string LineReader::rest() {
  std::string text = text_.substr(read_);
  text_.clear();
  read_ = 0;
  return text;
}

std::string path_of(const ActionCall& call) {
  const std::string path = call.path();
  return path.empty() ? call.program().mission().name : path;
}

Result<Value> execute_message(std::uint64_t id, const std::string& run, ActionCall& call, bool has_robot,
                              const WorldView* world) {
  auto inputs = inputs_of(call);
  if (!inputs) return inputs.error();
  const Program& program = call.program();
  const State& state = program.state(call.state());
  ValueMap message;
  message.append("do", "execute");
  message.append("id", id);
  message.append("run", run);
  message.append("backward", call.backward());
  message.append("discardable", call.may_be_discarded());
  if (const auto memory = call.memory()) message.append("after", *memory);
  if (world != nullptr) {
    message.append("world", Value::List(world->facts().begin(), world->facts().end()));
    message.append("world_data", shown_data(*world));
    message.append("computed_data", ScriptData(*world).names());
  }
  message.append("no_robot", why_no_robot(call, has_robot));
  message.append("path", path_of(call));
  message.append("state", program.mission().script_id(call.state()));
  message.append("name", name_of(program, call.state()));
  message.append("description", state.description);
  message.append("notes", state.notes);
  message.append("parents", parents_of(call));
  message.append("mission", program.mission().name);
  message.append("mission_folder", folder_of(program.mission()));
  add_script(message, call.action(), program.mission());
  message.append("inputs", std::move(*inputs));
  if (!call.error_before().empty()) message.append("error_before", call.error_before());
  message.append("input_tuples", tuples_of(call.action().inputs));
  message.append("output_tuples", tuples_of(call.action().outputs));
  message.append("outputs", outputs_of(call));
  message.append("outcomes", Value::List(call.action().outcomes.begin(), call.action().outcomes.end()));
  if (state.kind == StateKind::Decider) message.append("branches", branches_of(call));
  return Value(std::move(message));
}

namespace {

using Answer = Result<Value>;

Globals::Key key_of(const Value& request) {
  const Value* key = request.find("key");
  return key == nullptr || !key->is_integer() ? 0 : key->as_uint();
}

template <class T>
Answer done(const Result<T>& result) {
  if (!result) return result.error();
  if constexpr (std::is_void_v<T>) {
    return Value();
  } else {
    return Value(*result);
  }
}

/// The value of a variable as scripts get it; the number of an object goes into `held`.
Answer passed(const std::string& name, GlobalContent content, const ScriptObjects& objects, ValueMap& held) {
  if (content.object) {
    const auto number = objects.number_of(*content.object);
    if (!number) {
      return fail(ErrorCode::InvalidState,
                  "the global variable " + quote(name) +
                      " holds an object of another Python process, or of one that has ended");
    }
    held.append(name, *number);
  } else if (not_finite(content.value)) {
    return fail(ErrorCode::InvalidArgument,
                "the global variable " + quote(name) +
                    " is infinite or not a number, which cannot be passed to a script");
  }
  return std::move(content.value);
}

/// A list with the value, empty if there is no such variable; null while another holder has its lock.
Answer get(const Globals& globals, const std::string& name, Globals::Key key, const ScriptObjects& objects,
           ValueMap& held) {
  if (globals.is_locked(name, key)) {
    if (key == 0) return Value();
    return fail(ErrorCode::PermissionDenied, "wrong access key for the global variable " + quote(name));
  }
  auto content = globals.content(name);
  if (!content) return Value(Value::List{});
  auto value = passed(name, std::move(*content), objects, held);
  if (!value) return value.error();
  return Value(Value::List{std::move(*value)});
}

/// All values by name. Objects of other processes are passed as what they show.
Answer all(const Globals& globals, const ScriptObjects& objects, ValueMap& held) {
  ValueMap values;
  for (auto& [name, content] : globals.contents()) {
    if (content.object) {
      if (const auto number = objects.number_of(*content.object)) held.append(name, *number);
    }
    values.append(name, std::move(content.value));
  }
  return Value(std::move(values));
}

/// The key; null while another holder has the lock.
Answer lock(Globals& globals, const std::string& name) {
  auto key = globals.lock(name, Duration::zero());
  if (!key && key.error().code == ErrorCode::DeadlineExceeded) return Value();
  return done(key);
}

/// Sets it to the value of the request, or to the object that the process keeps under a number.
Answer set(Globals& globals, const std::string& name, const std::shared_ptr<ScriptObjects>& objects,
           const Value& request) {
  const Value* given = request.find("value");
  Value value = given == nullptr ? Value() : *given;
  const std::string type = text_at(request, "type");
  const Value* number = request.find("object");
  if (number == nullptr || !number->is_integer())
    return done(globals.set(name, std::move(value), key_of(request), type));
  auto object = ScriptObjects::hold(objects, number->as_uint(), std::move(value));
  return done(globals.set_object(name, std::move(object), text_at(request, "kind"), key_of(request), type));
}

Answer erase(Globals& globals, const std::string& name) {
  if (!globals.content(name)) return fail(ErrorCode::NotFound, "there is no global variable " + quote(name));
  return done(globals.erase(name));
}

Answer serve(Globals& globals, const std::shared_ptr<ScriptObjects>& objects, const Value& request,
             ValueMap& held) {
  const std::string call = text_at(request, "call");
  const std::string name = text_at(request, "name");
  const Globals::Key key = key_of(request);
  if (call == "get") return get(globals, name, key, *objects, held);
  if (call == "set") return set(globals, name, objects, request);
  if (call == "lock") return lock(globals, name);
  if (call == "unlock") {
    const Value* force = request.find("force");
    return done(globals.unlock(name, key, force != nullptr && force->is_bool() && force->as_bool()));
  }
  if (call == "delete") return erase(globals, name);
  if (call == "is_locked") return Value(globals.is_locked(name));
  if (call == "all") return all(globals, *objects, held);
  return fail(ErrorCode::Unsupported, "there is no operation " + quote(call) + " of global variables");
}

}  // namespace

ValueMap answer_about_globals(Globals& globals, const std::shared_ptr<ScriptObjects>& objects,
                              const Value& request) {
  ValueMap answer;
  ValueMap held;
  if (auto value = serve(globals, objects, request, held)) {
    answer.append("value", std::move(*value));
    if (!held.empty()) answer.append("objects", std::move(held));
  } else {
    answer.append("error", value.error().message);
    answer.append("code", std::string(to_string(value.error().code)));
  }
  return answer;
}

}  // namespace segue::mission::detail
