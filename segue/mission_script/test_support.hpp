// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/condition_variable.hpp>
#include <segue/base/log.hpp>
#include <segue/base/mutex.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine.hpp>
#include <segue/mission_script/script_runner.hpp>
#include <segue/mission_script/scripted_data.hpp>

#include <support/eventually.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <thread>

namespace segue::mission {

using namespace std::chrono_literals;
using segue::testing::eventually;
using segue::testing::kPatience;
using std::filesystem::path;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using type::Value;

/// Python that never gives up the interpreter's lock.
const std::string kHold = "re.match('(a+)+$', 'a' * 100 + 'b')";

/// Collects the lines that scripts print and log, as they come.
class Lines {
 public:
  Lines() {
    set_log_level(LogLevel::Debug);
    set_log_sink([this](LogLevel level, std::string_view source, std::string_view text) {
      const Lock guard(mutex_);
      text_ += std::string(to_string(level)) + " " + std::string(source) + ": " + std::string(text) + "\n";
      changed_.notify_all();
    });
  }
  ~Lines() {
    set_log_sink({});
    set_log_level(LogLevel::Info);
  }
  Lines(const Lines&) = delete;
  Lines& operator=(const Lines&) = delete;

  std::string text() {
    const Lock guard(mutex_);
    return text_;
  }
  bool wait_for(const std::string& part) {
    Lock guard(mutex_);
    return changed_.wait_for(mutex_, kPatience, [&] { return text_.find(part) != std::string::npos; });
  }

 private:
  Mutex mutex_;
  ConditionVariable changed_;
  std::string text_;
};

inline bool is_gone(pid_t pid) {
  return ::kill(pid, 0) != 0;
}

/// A script as the text of a YAML block.
inline std::string indented(const std::string& script, const std::string& with) {
  std::string text = with;
  for (const char c : script) {
    text += c;
    if (c == '\n') text += with;
  }
  return text;
}

/// An action of a mission file, `head` being what stands beside `run`.
inline std::string action(const std::string& name, const std::string& script, const std::string& head = "") {
  return "  " + name + ":\n" + (head.empty() ? "" : indented(head, "    ") + "\n") +
         "    run:\n      python:\n        text: |\n" + indented(script, "          ") + "\n";
}

inline std::string execute(const std::string& body) {
  return "def execute(self, inputs, outputs, gvm):\n" + indented(body, "  ");
}

class Scripts : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = ::testing::TempDir() + "segue-script-XXXXXX";
    ASSERT_NE(::mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override {
    engine_.reset();
    runner_.reset();
    std::filesystem::remove_all(folder_);
  }

  void load(const std::string& text) {
    if (!runner_) runner_ = std::make_shared<ScriptRunner>(options_);
    Diagnostics diagnostics;
    auto mission = read_mission(text, (folder_ / "m.yaml").string(), diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics) << text;
    auto program = Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << to_string(program.error());
    Runners runners;
    runners.set_scripts(runner_);
    auto engine = Engine::create(*program, runners, engine_options_);
    ASSERT_TRUE(engine) << to_string(engine.error());
    engine_ = std::move(*engine);
  }
  const MissionResult& run(const std::string& text) {
    load(text);
    if (::testing::Test::HasFatalFailure()) std::abort();
    engine_->run();
    return engine_->result();
  }
  /// A mission of one action.
  const MissionResult& run_one(const std::string& script, const std::string& head = "") {
    return run("mission: m\nactions:\n" + action("a", script, head) + "action: a\n");
  }
  const MissionResult& run_body(const std::string& body, const std::string& head = "") {
    return run_one(execute(body), head);
  }
  /// The only output, `x` of any type, of a script.
  Value output_of(const std::string& body, const std::string& more = "") {
    const auto& result = run_body(body, "outputs: {x: any}" + (more.empty() ? "" : "\n" + more));
    EXPECT_EQ(result.outcome, 0) << result.error;
    return result.outputs.empty() ? Value() : result.outputs.front();
  }
  std::string error_of(const std::string& body, const std::string& head = "") {
    const auto& result = run_body(body, head);
    EXPECT_EQ(result.outcome, kAborted);
    return result.error;
  }
  /// Why a mission with a script cannot start.
  [[nodiscard]] std::string refusal() const {
    Diagnostics diagnostics;
    auto mission = read_mission("mission: m\nactions:\n" + action("a", execute("return 0")) + "action: a\n",
                                (folder_ / "m.yaml").string(), diagnostics);
    Runners runners;
    runners.set_scripts(std::make_shared<ScriptRunner>(options_));
    const auto engine = Engine::create(Program::compile(std::move(*mission)).value(), runners, {});
    return engine ? "" : engine.error().message;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
  }

  path folder_;
  ScriptOptions options_;
  EngineOptions engine_options_;
  Lines lines_;
  std::shared_ptr<ScriptRunner> runner_;
  std::unique_ptr<Engine> engine_;
};

// Endings

inline std::string side_by_side(const std::string& actions, const std::string& decider = "") {
  return "mission: m\nactions:\n" + actions + action("d", execute(decider.empty() ? "return 0" : decider)) +
         "kind: barrier\nstates:\n  left: {title: Left hand}\n  right: {}\n"
         "  decide: {kind: decider, action: d, on: {success: return success}}\n";
}

/// A mission that counts with functions in Python and then looks.
inline std::string counting(const std::string& functions, const std::string& more_states = "") {
  return "mission: m\nworld_data:\n  tally:\n    initial: {count: 0}\n    python:\n      text: |\n" +
         indented(functions, "        ") + "\n    effects: {'+done': add}\nactions:\n" +
         action("work", execute("return 0"), "inputs: {what: text}\neffects: ['+done({what})']") +
         action("die", execute("import os; os._exit(3)"), "resources: []") +
         action("look", execute("outputs['x'] = self.world.data['tally']\nreturn 0"),
                "reads_world: true\noutputs: {x: any}") +
         "start: work\noutputs: {x: any}\nflows: [look.x -> outputs.x]\nstates:\n"
         "  work: {inputs: {what: a}, on: {success: " +
         (more_states.empty() ? "look" : "first") + "}}\n" + more_states +
         "  look: {on: {success: return success}}\n";
}

}  // namespace segue::mission
