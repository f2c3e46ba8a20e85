// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/mission/engine.hpp>
#include <segue/mission/files.hpp>
#include <segue/type/json.hpp>
#include <segue/type/yaml.hpp>

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

/// Runs tests/cases/mission/run/*.yaml in virtual time; README.md there tells the format. A new case needs no
/// C++.
namespace segue::mission {
namespace {

using type::Value;
using type::ValueMap;

const std::filesystem::path kCases = SEGUE_SOURCE_DIR "/tests/cases/mission/run/*.yaml";

std::string json(const Value& value) {
  return type::to_json(value, -1);
}

/// An execution of a case: the engine, and what its callbacks have noted.
class Trial {
 public:
  explicit Trial(const Value& test) : test_(test) { add_callbacks(); }

  void execute() {
    Diagnostics diagnostics;
    auto mission = read_mission(test_.find("mission")->as_string(), "mission", diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics);
    auto program = Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << to_string(program.error());
    EngineOptions options;
    options.clock = &clock_;
    options.backward = test_.find("backward") != nullptr;
    options.preemption_grace = std::chrono::milliseconds(1);
    options.warn = [this](const std::string& text) { warnings_.emplace_back(text); };
    auto engine = Engine::create(*program, runners_, std::move(options));
    ASSERT_TRUE(engine) << to_string(engine.error());
    engine_ = std::move(*engine);
    if (const Value* inputs = test_.find("inputs")) {
      for (const auto& [name, value] : inputs->as_map())
        ASSERT_TRUE(engine_->set_input(name, value));
    }
    if (const Value* path = test_.find("start_at")) {
      ASSERT_TRUE(engine_->start_at(path->as_string()));
    }
    const Value* steps = test_.find("steps");
    if (steps == nullptr) {
      ASSERT_EQ(engine_->run(), Engine::Progress::Ended) << "held";
    } else {
      for (const Value& step : steps->as_list())
        do_step(step);
    }
    compare(*test_.find("expect"));
  }

 private:
  void do_step(const Value& step) {
    const std::string verb = step.find("do")->as_string();
    if (verb == "pause") engine_->pause();
    if (verb == "stop") engine_->stop();
    if (verb == "resume") engine_->resume();
    if (verb == "into") engine_->step_into();
    if (verb == "over") engine_->step_over();
    if (verb == "out") engine_->step_out();
    if (verb.starts_with("to ")) engine_->run_to(verb.substr(3));
    Engine::Progress progress = Engine::Progress::Held;
    if (verb == "back") {
      const auto back = engine_->step_back();
      const Value* refused = step.find("refused");
      ASSERT_EQ(back.has_value(), refused == nullptr) << verb;
      if (refused != nullptr) {
        EXPECT_NE(back.error().message.find(refused->as_string()), std::string::npos);
      }
    } else {
      progress = engine_->run();
    }
    const Value* held = step.find("held");
    ASSERT_EQ(held != nullptr, progress == Engine::Progress::Held) << verb;
    if (held == nullptr) return;
    Value::List paths;
    for (const std::string& path : engine_->held_at())
      paths.emplace_back(path);
    EXPECT_EQ(json(paths), json(*held)) << "after " << verb;
  }

  void compare(const Value& expect) {
    for (const auto& [key, wanted] : expect.as_map()) {
      const Value found = part(key, wanted);
      EXPECT_TRUE(found == wanted) << key << ":\n  found  " << json(found) << "\n  wanted " << json(wanted);
    }
  }

  Value part(const std::string& key, const Value& wanted) {
    if (key == "outcome") return engine_->result().outcome_name;
    if (key == "error") return engine_->result().error;
    if (key == "trace") return trace();
    if (key == "notes") return notes_;
    if (key == "warnings") return warnings_;
    if (key == "end") return format_duration(clock_.now().time_since_epoch());
    ValueMap map;
    if (key == "outputs") {
      const auto& ports = *engine_->program().node(0).output_ports;
      for (std::size_t i = 0; i < ports.size(); ++i)
        map.append(ports[i].name, engine_->result().outputs[i]);
    } else if (key == "globals") {
      for (const auto& [name, value] : wanted.as_map())
        map.append(name, engine_->globals().get(name).value_or("(none)"));
    } else {
      return "no case expects a " + key;
    }
    return map;
  }

  /// Actions in the order in which they began, "path" or "path: outcome" where that is not the first.
  Value trace() {
    Value::List list;
    const auto& items = engine_->history().items();
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      const StateKind kind = engine_->program().node(items[i].state).kind;
      if (kind != StateKind::Execution && kind != StateKind::Decider) continue;
      std::string line = engine_->history().path(engine_->program(), i);
      if (!items[i].ended) line += ": under way";
      if (items[i].ended && items[i].outcome != 0)
        line += ": " + engine_->program().outcome_name(items[i].state, items[i].outcome);
      if (items[i].undone) line += ", undone";
      list.emplace_back(line);
    }
    return list;
  }

  void add_callbacks() {
    runners_.add("echo", [](Call& call) {
      for (const Port& port : call.action().inputs)
        call.set_output(port.name, call.input(port.name));
      return Ending{};
    });
    runners_.add("note", [this](Call& call) {
      Value::List inputs(call.inputs().begin(), call.inputs().end());
      std::string line = call.path();
      if (call.backward()) line += " back";
      for (const Value& input : inputs)
        line += " " + json(input);
      if (!call.error_before().empty()) line += " after " + call.error_before();
      notes_.emplace_back(line);
      return Ending{};
    });
    runners_.add("increment", [](Call& call) {
      if (!call.backward()) call.set_output("x", Value(call.input("x").as_int() + 1));
      return Ending{};
    });
    runners_.add("fail", [](Call&) { return Ending{kAborted, "failed on purpose"}; });
    runners_.add("preempted", [](Call&) { return Ending{kPreempted, {}}; });
    runners_.add("unknown", [](Call&) { return Ending{99, {}}; });
    runners_.add("throw", [](Call&) -> Ending { throw std::runtime_error("thrown"); });
    runners_.add("stop", [this](Call&) {
      engine_->stop();
      return Ending{};
    });
    runners_.add("pause", [this](Call&) {
      engine_->pause();
      return Ending{};
    });
    runners_.add("set_global", [](Call& call) {
      const auto set = call.globals().set(call.input("name").as_string(), call.input("value"));
      return set ? Ending{} : Ending{kAborted, set.error().message};
    });
    runners_.add("deaf", std::make_shared<Deaf>(0));
    runners_.add("polite", std::make_shared<Deaf>(1));
  }

  /// Goes on until it is preempted: then it ends with its first outcome, or does not hear.
  class Deaf final : public ActionRunner {
   public:
    explicit Deaf(int ears) : ears_(ears) {}
    std::optional<Ending> start(Call& call) override {
      auto completer = std::make_shared<Completer>();
      std::vector<Value> outputs(call.outputs().begin(), call.outputs().end());
      *completer = call.defer([this, completer, outputs] {
        if (ears_ > 0) (*completer)({0, {}}, outputs);
      });
      return std::nullopt;
    }

   private:
    int ears_;
  };

  const Value& test_;
  VirtualClock clock_;
  Runners runners_;
  std::unique_ptr<Engine> engine_;
  Value::List notes_;
  Value::List warnings_;
};

class MissionRunCase : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(MissionRunCase, goesAsItExpects) {
  const auto root = type::load_yaml(GetParam());
  ASSERT_TRUE(root) << to_string(root.error());
  ASSERT_TRUE(root->find("mission") != nullptr && root->find("expect") != nullptr);
  Trial(*root).execute();
}

INSTANTIATE_TEST_SUITE_P(Files, MissionRunCase, ::testing::ValuesIn(glob_files(kCases)),
                         [](const auto& one) { return one.param.stem().string(); });

}  // namespace
}  // namespace segue::mission
