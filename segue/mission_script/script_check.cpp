// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_script/script_check.hpp>

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_script/script_messages.hpp>
#include <segue/mission_script/script_process.hpp>
#include <segue/type/value_at.hpp>

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace segue::mission {

using type::Value;
using type::ValueMap;

namespace {

constexpr Duration kLongestCompilation = std::chrono::seconds(10);
constexpr std::size_t kPieceOfAnswer = std::size_t{16} << 10U;

/// A script of a mission, and whose it is.
struct Named {
  const Script* script = nullptr;
  SourcePlace owner;
  std::string what;
};

std::vector<Named> scripts_of(const Mission& mission) {
  std::vector<Named> scripts;
  for (const Action& action : mission.actions) {
    if (const auto* script = std::get_if<Script>(&action.run))
      scripts.push_back({script, action.where, "action " + quote(action.name.str())});
  }
  for (const DeclaredData& data : mission.world_data)
    scripts.push_back({&data.functions, data.where, "the world data " + quote(data.name)});
  return scripts;
}

std::string_view line_of(std::string_view text, int number) {
  for (int i = 1; i < number; ++i) {
    const auto end = text.find('\n');
    if (end == std::string_view::npos) return {};
    text.remove_prefix(end + 1);
  }
  return text.substr(0, text.find('\n'));
}

/// Where a place of a text is in the file that it stands in. A block of YAML ("|") begins in the line after
/// its mark and is indented; in other texts of YAML lines cannot be told, so that is where the text begins.
SourceLocation place_in(const SourcePlace& text, int line, int column) {
  if (text.line == 0) return {text.file, line, column};
  const std::string file = read_file(text.file).value_or(std::string());
  const std::string_view begin = line_of(file, text.line);
  const bool block = static_cast<std::size_t>(text.column) <= begin.size() &&
                     begin[static_cast<std::size_t>(text.column) - 1] == '|';
  if (!block) return text;
  std::size_t indent = std::string_view::npos;
  for (int i = text.line + 1; indent == std::string_view::npos; ++i) {
    const std::string_view next = line_of(file, i);
    if (next.data() == nullptr) break;
    indent = next.find_first_not_of(" \r");
  }
  const int shift = indent == std::string_view::npos ? 0 : static_cast<int>(indent);
  return {text.file, text.line + line, column + shift};
}

int integer_at(const Value& map, std::string_view key) {
  const Value* value = map.find(key);
  return value == nullptr || value->kind() != Value::Kind::Int ? 0 : static_cast<int>(value->as_int());
}

}  // namespace

class ScriptCompiler::Impl {
 public:
  explicit Impl(ScriptOptions options) : options_(std::move(options)) {}

  void check(const Mission& mission, Diagnostics& diagnostics) {
    const std::vector<Named> scripts = scripts_of(mission);
    if (scripts.empty() || given_up_) return;
    auto answer = compile(mission, scripts);
    if (!answer) {
      given_up_ = true;
      process_.reset();
      diagnostics.warning("no-python", "scripts were not compiled: " + answer.error().message,
                          scripts.front().owner);
      return;
    }
    const Value* errors = answer->find("errors");
    if (errors == nullptr || !errors->is_list()) return;
    for (const Value& error : errors->as_list())
      report(mission, scripts, error, diagnostics);
  }

 private:
  Result<Value> compile(const Mission& mission, const std::vector<Named>& scripts) {
    Value::List texts;
    for (const Named& each : scripts) {
      const Script& script = *each.script;
      texts.push_back(script.text.empty()
                          ? Value::map({{"file", script_file(mission, script, each.owner).string()}})
                          : Value::map({{"text", script.text}}));
    }
    const auto message = detail::framed(Value::map({{"do", "compile"}, {"scripts", std::move(texts)}}),
                                        options_.largest_message);
    if (!message) return message.error();
    if (!process_) {
      if (auto there = detail::check_python(options_); !there) return there.error();
      auto started = detail::ScriptProcess::start(options_);
      if (!started) return started.error();
      process_.emplace(std::move(*started));
    }
    return ask(*message);
  }

  Result<Value> ask(std::string_view message) {
    const TimePoint until = monotonic_now() + kLongestCompilation;
    detail::MessageReader reader(options_.largest_message);
    std::array<char, kPieceOfAnswer> buffer;
    while (monotonic_now() < until) {
      message.remove_prefix(process_->send(message));
      const auto events = process_->wait(-1, !message.empty(), until);
      std::string_view text;
      if (events.output) (void)process_->read_output(buffer, text);
      text = {};
      if (process_->read_messages(buffer, text) == detail::ScriptProcess::Read::Some) reader.append(text);
      auto answer = reader.next();
      if (!answer) return answer.error();
      if (*answer) return std::move(**answer);
      if (events.ended) return fail(ErrorCode::Unavailable, "the Python interpreter has ended");
    }
    return fail(ErrorCode::DeadlineExceeded, "the Python interpreter has not answered within 10 s");
  }

  void report(const Mission& mission, const std::vector<Named>& scripts, const Value& error,
              Diagnostics& diagnostics) const {
    const auto number = static_cast<std::size_t>(integer_at(error, "script"));
    if (number >= scripts.size()) return;
    const Named& owner = scripts[number];
    const int line = integer_at(error, "line");
    const int column = integer_at(error, "column");
    const std::string message = text_at(error, "message");
    if (owner.script->text.empty()) {
      const std::string file = script_file(mission, *owner.script, owner.owner).string();
      return diagnostics.error("bad-script", owner.what + ": " + message, {file, line, column});
    }
    diagnostics.error("bad-script",
                      owner.what + ": line " + std::to_string(line) + " of its script: " + message,
                      place_in(owner.script->where, line, column));
  }

  const ScriptOptions options_;
  std::optional<detail::ScriptProcess> process_;
  bool given_up_ = false;
};

ScriptCompiler::ScriptCompiler(ScriptOptions options) : impl_(std::make_unique<Impl>(std::move(options))) {}
ScriptCompiler::~ScriptCompiler() = default;

void ScriptCompiler::check(const Mission& mission, Diagnostics& diagnostics) {
  impl_->check(mission, diagnostics);
}

}  // namespace segue::mission
