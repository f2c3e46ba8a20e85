// SPDX-License-Identifier: Apache-2.0
#include <segue/model/component_parts.hpp>
#include <segue/model/orogen_text.hpp>
#include <segue/model/rock_symbol.hpp>
#include <segue/type/scalar_text.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <utility>

namespace segue::model::detail {

using type::Value;
using type::ValueMap;

namespace {

/// Statements that say nothing of a component's interface.
constexpr std::array kWithoutMeaning = {"attribute",
                                        "extended_state_support",
                                        "fixed_initial_state",
                                        "import_types_from",
                                        "needs_configuration",
                                        "opaque_autoconversion",
                                        "provides",
                                        "require",
                                        "ros_type_export_policy",
                                        "type_export_policy",
                                        "typekit",
                                        "using_library",
                                        "using_ros_package",
                                        "using_task_library",
                                        "using_typekit",
                                        "version",
                                        "worstcase_processing_time",
                                        "worstcase_trigger_latency",
                                        "max_sizes",
                                        "doc_author"};

/// Collects what an .orogen file says as an interface summary, the form that read_rock_interface() reads.
class OrogenReader {
 public:
  explicit OrogenReader(const Source& source) : source_(source) {}

  Value read(const std::vector<RubyStatement>& statements) {
    for (const RubyStatement& statement : statements)
      read(statement);
    if (!blocks_.empty()) error("a block has no 'end'", statements.back());
    finish_task();
    Value root{ValueMap()};
    root.as_map().append("tasks", std::move(tasks_));
    return root;
  }

 private:
  enum class Block : std::uint8_t { Task, Transformer, Other };

  void read(const RubyStatement& statement) {
    if (statement.closes_block) return close(statement);
    Block opened = Block::Other;
    if (!is_ignored()) opened = interpret(statement);
    if (statement.opens_block) blocks_.push_back(opened);
  }

  /// Whether it is in a block whose statements say nothing of an interface, or that is not understood.
  [[nodiscard]] bool is_ignored() const { return std::ranges::find(blocks_, Block::Other) != blocks_.end(); }

  void close(const RubyStatement& statement) {
    if (blocks_.empty()) return error("an 'end' has no block", statement);
    if (blocks_.back() == Block::Task) finish_task();
    blocks_.pop_back();
  }

  Block interpret(const RubyStatement& statement) {
    if (!statement.understood) {
      warn("this Ruby code is not evaluated, so the component may lack what it adds", statement);
      return Block::Other;
    }
    const RubyCall& call = statement.calls.front();
    if (call.name == "name") project_ = text(call, 0);
    if (call.name == "task_context") return begin_task(statement);
    if (task_.empty()) return Block::Other;
    if (!blocks_.empty() && blocks_.back() == Block::Transformer) {
      add_to_transformer(call);
      return Block::Other;
    }
    return read_in_task(statement);
  }

  Block begin_task(const RubyStatement& statement) {
    const RubyCall& call = statement.calls.front();
    task_ = qualified(text(call, 0));
    fields_ = ValueMap();
    for (const char* list : {"input_ports", "output_ports", "dynamic_ports", "properties", "operations"})
      fields_.append(list, Value::List());
    where_ = statement.where;
    if (const Value* parent = call.options.find("subclasses")) set_parent(*parent);
    if (!statement.opens_block) finish_task();
    return Block::Task;
  }

  void finish_task() {
    if (task_.empty()) return;
    Value task(std::move(fields_));
    task.set_mark(where_);
    tasks_.set(std::move(task_), std::move(task));
    task_.clear();
  }

  Block read_in_task(const RubyStatement& statement) {
    const RubyCall& call = statement.calls.front();
    const std::string& what = call.name;
    if (what == "property") {
      add_property(statement);
    } else if (what == "input_port" || what == "output_port") {
      add(what + "s", port_of(statement));
    } else if (what == "dynamic_input_port" || what == "dynamic_output_port") {
      add_family(statement);
    } else if (what == "operation" || what == "hidden_operation") {
      add_operation(statement);
    } else if (what == "runtime_states" || what == "error_states") {
      add_states(what, call);
    } else if (what == "subclasses") {
      if (!call.arguments.empty()) set_parent(call.arguments.front());
    } else if (what == "abstract") {
      fields_.set("abstract", true);
    } else if (what == "doc") {
      fields_.set("note", text(call, 0));
    } else if (what == "transformer" || what == "stream_aligner") {
      fields_.set("transformer", ValueMap());
      return Block::Transformer;
    } else if (!read_activity(call) && std::ranges::find(kWithoutMeaning, what) == kWithoutMeaning.end()) {
      warn(quote(what) + " is not known and has no effect", statement);
    }
    return Block::Other;
  }

  /// True for the statements that say when the component is updated.
  bool read_activity(const RubyCall& call) {
    ValueMap activity;
    if (call.name == "periodic" || call.name == "default_activity") {
      const std::size_t period = call.name == "periodic" ? 0 : 1;
      const std::string kind = period == 0 ? "periodic" : bare(text(call, 0));
      activity.set("type", kind == "triggered" ? "port_driven" : kind);
      if (period < call.arguments.size()) activity.set("period", call.arguments[period]);
    } else if (call.name == "port_driven" || call.name == "triggered" || call.name == "aperiodic") {
      activity.set("type", "port_driven");
      const Value::List ports = texts(call);
      if (!ports.empty()) activity.set("ports", ports);
    } else if (call.name == "fd_driven") {
      activity.set("type", "fd_driven");
    } else {
      return false;
    }
    fields_.set("default_activity", std::move(activity));
    return true;
  }

  void add_to_transformer(const RubyCall& call) {
    Value& transformer = fields_["transformer"];
    const auto add_entry = [&](const char* list, ValueMap entry) {
      Value& entries = transformer.as_map()[list];
      if (!entries.is_list()) entries = Value::List();
      entries.as_list().emplace_back(std::move(entry));
    };
    if (call.name == "transform" || call.name == "transformation") {
      ValueMap entry;
      entry.set("from", text(call, 0));
      entry.set("to", text(call, 1));
      add_entry("transformations", std::move(entry));
    } else if (call.name == "align_port") {
      ValueMap entry;
      entry.set("port", text(call, 0));
      if (call.arguments.size() > 1) entry.set("period", call.arguments[1]);
      add_entry("aligned_ports", std::move(entry));
    } else if (call.name == "max_latency" && !call.arguments.empty()) {
      transformer.as_map().set("max_latency", call.arguments.front());
    }
  }

  void add_property(const RubyStatement& statement) {
    const RubyCall& call = statement.calls.front();
    ValueMap property = named(statement);
    property.set("type", text(call, 1));
    if (call.arguments.size() > 2) property.set("default", call.arguments[2]);
    if (has(statement, "dynamic")) property.set("dynamic", true);
    add("properties", std::move(property));
  }

  static ValueMap port_of(const RubyStatement& statement) {
    ValueMap port = named(statement);
    port.set("type", text(statement.calls.front(), 1));
    return port;
  }

  void add_family(const RubyStatement& statement) {
    const RubyCall& call = statement.calls.front();
    ValueMap family;
    family.set("pattern", text(call, 0));
    family.set("direction", call.name == "dynamic_input_port" ? "input" : "output");
    if (call.arguments.size() > 1 && !call.arguments[1].is_null()) family.set("type", text(call, 1));
    add("dynamic_ports", std::move(family));
  }

  void add_operation(const RubyStatement& statement) {
    ValueMap operation = named(statement);
    Value::List arguments;
    for (const RubyCall& call : statement.calls) {
      if (call.name == "returns") operation.set("returns", text(call, 0));
      if (call.name == "runs_in_caller_thread") operation.set("runs_in", "caller_thread");
      if (call.name != "argument") continue;
      ValueMap argument;
      argument.set("name", text(call, 0));
      argument.set("type", text(call, 1));
      if (call.arguments.size() > 2) argument.set("doc", text(call, 2));
      arguments.emplace_back(std::move(argument));
    }
    operation.set("arguments", std::move(arguments));
    add("operations", std::move(operation));
  }

  void add_states(const std::string& list, const RubyCall& call) {
    Value& states = fields_[list];
    if (!states.is_list()) states = Value::List();
    for (Value& state : texts(call))
      states.as_list().push_back(std::move(state));
  }

  void add(const std::string& list, ValueMap entry) {
    fields_[list].as_list().emplace_back(std::move(entry));
  }

  /// A map with the name that the first argument is, and what `doc` says of it.
  static ValueMap named(const RubyStatement& statement) {
    ValueMap entry;
    entry.set("name", text(statement.calls.front(), 0));
    for (const RubyCall& call : statement.calls) {
      if (call.name == "doc") entry.set("doc", text(call, 0));
    }
    return entry;
  }

  static bool has(const RubyStatement& statement, std::string_view call) {
    return std::ranges::find(statement.calls, call, &RubyCall::name) != statement.calls.end();
  }

  /// The text of an argument, "" if it has none; symbols without their colon.
  static std::string text(const RubyCall& call, std::size_t argument) {
    if (argument >= call.arguments.size()) return {};
    const Value& value = call.arguments[argument];
    return is_symbol(value) ? bare(value.as_string()) : scalar_text(value).value_or("");
  }

  static std::string bare(const std::string& symbol) {
    return symbol.starts_with(':') ? symbol.substr(1) : symbol;
  }

  /// All texts among the arguments, those of lists too.
  static Value::List texts(const RubyCall& call) {
    Value::List all;
    const auto add = [&](const Value& value) {
      if (value.is_string()) all.push_back(is_symbol(value) ? symbol_text(value) : value);
    };
    for (const Value& argument : call.arguments) {
      if (!argument.is_list()) {
        add(argument);
        continue;
      }
      for (const Value& item : argument.as_list())
        add(item);
    }
    return all;
  }

  void set_parent(const Value& parent) {
    const std::string name = scalar_text(parent).value_or("");
    if (!name.starts_with("RTT::")) fields_.set("subclasses", qualified(name));
  }

  /// Components of the file's own project need not name it.
  [[nodiscard]] std::string qualified(const std::string& name) const {
    return name.find("::") == std::string::npos ? project_ + "::" + name : name;
  }

  static Value at(const RubyStatement& statement) {
    Value value;
    value.set_mark(statement.where);
    return value;
  }
  void warn(std::string message, const RubyStatement& statement) const {
    source_.warning("not-evaluated", std::move(message), at(statement));
  }
  void error(std::string message, const RubyStatement& statement) const {
    source_.error("parse-error", std::move(message), at(statement));
  }

  const Source& source_;
  std::string project_;
  ValueMap tasks_;
  std::string task_;  ///< the name of the component that is being read; empty: none
  ValueMap fields_;   ///< of that component
  type::Mark where_;
  std::vector<Block> blocks_;
};

}  // namespace

bool is_orogen(const std::string& file) {
  return file.ends_with(".orogen");
}

void read_orogen(std::string_view text, ComponentCatalog& catalog, const Source& source) {
  if (type::detail::valid_utf8(text) != text)
    return source.error("parse-error", "the file is not valid UTF-8", Value());
  auto statements = read_ruby(text, source.file());
  if (!statements) return source.error("parse-error", statements.error().message, Value());
  const Value root = OrogenReader(source).read(*statements);
  if (!root.find("tasks")->as_map().empty()) read_rock_interface(root, catalog, source);
}

}  // namespace segue::model::detail
