// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/base/text.hpp>
#include <segue/base/virtual_clock.hpp>
#include <segue/convert/concurrent_run.hpp>
#include <segue/mission/mission_index.hpp>
#include <segue/mission/mission_io.hpp>
#include <segue/mission_engine/engine.hpp>
#include <segue/mission_engine/interrupted_journal.hpp>
#include <segue/type/json.hpp>
#include <segue/type/yaml.hpp>

#include <support/paths.hpp>

#include <gtest/gtest.h>

#include <unistd.h>
#include <algorithm>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <utility>

/// Runs tests/cases/mission/run/*.yaml in virtual time, as they are written and concurrently; README.md there
/// describes the format. A new case needs no C++.
namespace segue::mission {
namespace {

using type::Value;
using type::ValueMap;

const std::filesystem::path kCases = segue::paths::in_sources("/tests/cases/mission/run/*.yaml");

std::string json(const Value& value) {
  return type::to_json(value, -1);
}

/// An execution of a case: its run, and the notes of its callbacks.
class Trial {
 public:
  explicit Trial(const Value& test) : test_(test) { add_callbacks(); }

  /// Writes a journal, or resumes from one that was cut.
  void keep_journal(std::filesystem::path file, bool resume) {
    journal_ = std::move(file);
    resume_ = resume;
  }

  void execute() {
    ASSERT_NO_FATAL_FAILURE(compile());
    EngineOptions options;
    options.clock = &clock_;
    options.backward = test_.find("backward") != nullptr;
    options.preemption_grace = std::chrono::milliseconds(1);
    options.facts = facts();
    options.resources = resources();
    options.warn = [this](const std::string& text) { warnings_.emplace_back(text); };
    ASSERT_NO_FATAL_FAILURE(open_journal(false, options.journal));
    auto engine = Engine::create(program_, runners_, std::move(options));
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
    outcome_ = engine_->result();
    world_ = engine_->world().facts();
    for (const auto& [resource, count] : engine_->units().counts())
      units_[resource] = count;
    compare(*test_.find("expect"));
  }

  void execute_concurrently() {
    ASSERT_NO_FATAL_FAILURE(compile());
    convert::RunOptions options;
    options.clock = task_network::ClockKind::Virtual;
    options.facts = facts();
    options.resources = resources();
    options.preemption_grace = std::chrono::milliseconds(1);
    ASSERT_NO_FATAL_FAILURE(open_journal(true, options.journal));
    std::vector<Value> inputs(program_->node(0).input_ports->size());
    if (const Value* given = test_.find("inputs")) {
      for (const auto& [name, value] : given->as_map())
        inputs[position(*program_->node(0).input_ports, name).value()] = value;
    }
    auto run = convert::Run::create(program_, runners_, std::move(inputs), std::move(options));
    ASSERT_TRUE(run) << to_string(run.error());
    run_ = std::move(*run);
    outcome_ = run_->run();
    for (const std::string& fact : run_->network_result().world.texts(run_->plan().network().facts))
      world_.insert(fact);
    const task_network::ResourceTable& resources = run_->plan().network().resources;
    for (std::uint32_t i = 0; i < resources.size(); ++i)
      units_[resources.name(task_network::ResourceId{i})] = run_->network_result().units[i];
    const auto by_text = [](const Value& a, const Value& b) { return json(a) < json(b); };
    std::ranges::sort(notes_, by_text);
    ValueMap expect;
    for (const auto& [key, value] : test_.find("expect")->as_map()) {
      if (key == "trace" || key == "warnings" || key == "end") continue;
      expect.append(key, value);
      if (key == "notes") std::ranges::sort(expect.find(key)->as_list(), by_text);
    }
    compare(expect);
  }

 private:
  void compile() {
    Diagnostics diagnostics;
    auto mission = read_mission(test_.find("mission")->as_string(), "mission", diagnostics);
    ASSERT_TRUE(mission) << to_string(diagnostics);
    auto program = Program::compile(std::move(*mission));
    ASSERT_TRUE(program) << to_string(program.error());
    program_ = std::move(*program);
  }

  void open_journal(bool concurrent, std::shared_ptr<RunJournal>& journal) const {
    if (journal_.empty()) return;
    const auto& mission = program_->mission();
    auto opened =
        resume_ ? RunJournal::resume(journal_, mission, concurrent, UnderWay::Again)
                : RunJournal::create(journal_, mission,
                                     {.inputs = {}, .facts = {}, .start_at = {}, .concurrent = concurrent});
    ASSERT_TRUE(opened) << to_string(opened.error());
    journal = std::move(*opened);
  }

  [[nodiscard]] std::vector<Fact> facts() const {
    std::vector<Fact> facts;
    if (const Value* given = test_.find("facts")) {
      for (const Value& fact : given->as_list())
        facts.push_back(parse_initial_fact(fact.as_string()).value());
    }
    return facts;
  }

  [[nodiscard]] UnitCounts resources() const {
    UnitCounts counts;
    if (const Value* given = test_.find("resources")) {
      for (const auto& [name, count] : given->as_map())
        counts.emplace_back(name, static_cast<std::uint32_t>(count.as_uint()));
    }
    return counts;
  }

  void do_step(const Value& step) {
    const std::string verb = step.find("do")->as_string();
    if (const Value* breaks = step.find("break")) {
      std::vector<std::string> paths;
      for (const Value& path : breaks->as_list())
        paths.push_back(path.as_string());
      ASSERT_TRUE(engine_->set_breakpoints(paths));
    }
    if (verb == "pause") engine_->pause();
    if (verb == "stop") engine_->stop();
    if (verb == "resume") engine_->resume();
    if (verb == "into") engine_->step_into();
    if (verb == "over") engine_->step_over();
    if (verb == "out") engine_->step_out();
    if (verb.starts_with("to ")) engine_->run_to(verb.substr(3));
    Engine::Progress progress = Engine::Progress::Held;
    Result<void> done;
    if (verb == "back") done = engine_->step_back();
    if (verb.starts_with("at ")) done = engine_->go_on_at(verb.substr(3));
    const Value* refused = step.find("refused");
    ASSERT_EQ(done.has_value(), refused == nullptr) << verb;
    if (refused != nullptr) {
      EXPECT_NE(done.error().message.find(refused->as_string()), std::string::npos) << done.error().message;
    }
    if (verb != "back") progress = engine_->run();
    if (const Value* values = step.find("values")) {
      for (const auto& [path, wanted] : values->as_map())
        EXPECT_EQ(json(engine_->values_of(path).value()), json(wanted)) << path << " after " << verb;
    }
    if (const Value* world = step.find("world")) {
      EXPECT_EQ(json(listed(engine_->world().facts())), json(*world)) << "after " << verb;
    }
    if (const Value* units = step.find("units")) {
      for (const auto& [name, count] : units->as_map())
        EXPECT_EQ(engine_->units().counts()[name], count.as_uint()) << name << " after " << verb;
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
      // Completed actions are not repeated and take no time.
      if (resume_ && (key == "notes" || key == "warnings" || key == "end")) continue;
      const Value found = part(key, wanted);
      EXPECT_TRUE(found == wanted) << key << ":\n  found  " << json(found) << "\n  wanted " << json(wanted);
    }
  }

  Value part(const std::string& key, const Value& wanted) {
    if (key == "outcome") return outcome_.outcome_name;
    if (key == "error") return outcome_.error;
    if (key == "trace") return trace();
    if (key == "world") return listed(world_);
    if (key == "notes") return notes_;
    if (key == "warnings") return warnings_;
    if (key == "end") return format_duration(clock_.now().time_since_epoch());
    ValueMap map;
    if (key == "outputs") {
      const auto& ports = *program_->node(0).output_ports;
      for (std::size_t i = 0; i < ports.size(); ++i)
        map.append(ports[i].name, outcome_.outputs[i]);
    } else if (key == "globals") {
      const Globals& globals = engine_ ? engine_->globals() : run_->globals();
      for (const auto& [name, value] : wanted.as_map())
        map.append(name, globals.get(name).value_or("(none)"));
    } else if (key == "units") {
      for (const auto& [name, count] : wanted.as_map())
        map.append(name, units_.contains(name) ? Value(units_.at(name)) : Value());
    } else {
      return "no case expects a " + key;
    }
    return map;
  }

  static Value listed(const World::Facts& facts) { return Value::List(facts.begin(), facts.end()); }

  /// Actions in the order in which they began, "path", or "path: outcome" unless that is the first outcome.
  Value trace() {
    Value::List list;
    const auto& items = engine_->history().items();
    for (std::uint32_t i = 0; i < items.size(); ++i) {
      if (!is_leaf(engine_->program().node(items[i].state).kind)) continue;
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
    runners_.add("echo", [](ActionCall& call) {
      for (const Port& port : call.action().inputs)
        call.set_output(port.name, call.input(port.name));
      return Ending{};
    });
    runners_.add("note", [this](ActionCall& call) {
      Value::List inputs(call.inputs().begin(), call.inputs().end());
      std::string line = call.path();
      if (call.backward()) line += " back";
      for (const Value& input : inputs)
        line += " " + json(input);
      if (!call.error_before().empty()) line += " after " + call.error_before();
      notes_.emplace_back(line);
      return Ending{};
    });
    runners_.add("increment", [](ActionCall& call) {
      if (!call.backward()) call.set_output("x", Value(call.input("x").as_int() + 1));
      return Ending{};
    });
    runners_.add("fail", [](ActionCall&) { return Ending{kAborted, "failed on purpose"}; });
    runners_.add("preempted", [](ActionCall&) { return Ending{kPreempted, {}}; });
    runners_.add("unknown", [](ActionCall&) { return Ending{99, {}}; });
    runners_.add("throw", [](ActionCall&) -> Ending { throw std::runtime_error("thrown"); });
    runners_.add("stop", [this](ActionCall&) {
      engine_ ? engine_->stop() : run_->stop();
      return Ending{};
    });
    runners_.add("pause", [this](ActionCall&) {
      engine_->pause();
      return Ending{};
    });
    runners_.add("set_global", [](ActionCall& call) {
      const auto set = call.globals().set(call.input("name").as_string(), call.input("value"));
      return set ? Ending{} : Ending{kAborted, set.error().message};
    });
    runners_.add("deaf", std::make_shared<Deaf>(0));
    runners_.add("polite", std::make_shared<Deaf>(1));
  }

  /// Runs until it is preempted; then it ends with its first outcome, or ignores the preemption.
  class Deaf final : public ActionRunner {
   public:
    explicit Deaf(int ears) : ears_(ears) {}
    std::optional<Ending> start(ActionCall& call) override {
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
  std::shared_ptr<const Program> program_;
  std::unique_ptr<Engine> engine_;
  std::unique_ptr<convert::Run> run_;
  MissionResult outcome_;
  World::Facts world_;
  std::map<std::string, std::uint64_t> units_;
  Value::List notes_;
  Value::List warnings_;
  std::filesystem::path journal_;
  bool resume_ = false;
};

/// Each ended action began once, unless it was in progress at a cut.
void expect_nothing_done_twice(const std::string& journal) {
  std::map<Execution, bool> ended;
  std::size_t begin = 0;
  for (std::size_t end = journal.find('\n'); end != std::string::npos; end = journal.find('\n', begin)) {
    const Value line = type::parse_json(journal.substr(begin, end - begin)).value();
    begin = end + 1;
    const auto execution = [&](const Value& path) {
      const Value* loops = line.find("loops");
      return Execution{path.as_string(), line.find("n")->as_uint(), loops ? loops->as_string() : ""};
    };
    if (const Value* begun = line.find("begun")) {
      EXPECT_FALSE(ended[execution(*begun)]) << begun->as_string();
    } else if (const Value* done = line.find("ended")) {
      EXPECT_FALSE(std::exchange(ended[execution(*done)], true)) << done->as_string();
    }
  }
}

class MissionRunCase : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(MissionRunCase, GoesAsItExpects) {
  const auto root = type::load_yaml(GetParam());
  ASSERT_TRUE(root) << to_string(root.error());
  ASSERT_TRUE(root->find("mission") != nullptr && root->find("expect") != nullptr);
  Trial(*root).execute();
}

TEST_P(MissionRunCase, GoesSoConcurrently) {
  const auto root = type::load_yaml(GetParam());
  ASSERT_TRUE(root) << to_string(root.error());
  for (const char* sequential_only : {"steps", "start_at", "backward"}) {
    if (root->find(sequential_only) != nullptr)
      GTEST_SKIP() << "only a sequential run has " << sequential_only;
  }
  Trial(*root).execute_concurrently();
}

/// Why a run of the case cannot be broken off and resumed by itself, or "".
std::string led_by_hand(const Value& test, bool concurrent) {
  for (const char* hand : {"steps", "start_at", "inputs"}) {
    if (test.find(hand) != nullptr) return "it is led by hand";
  }
  if (concurrent && test.find("backward") != nullptr) return "only a sequential run has steps back";
  const std::string& mission = test.find("mission")->as_string();
  for (const char* hand : {"callback: stop", "callback: pause", "callback: deaf"}) {
    if (mission.find(hand) != std::string::npos)
      return "an action of it stops the engine, or would not be stopped";
  }
  return {};
}

/// Runs that were cut off after any line of their journal, or within one, resume to the same end.
void expect_to_go_on_from_everywhere(const Value& test, void (Trial::*execute)()) {
  const auto file =
      std::filesystem::path(::testing::TempDir()) / ("segue_run_" + std::to_string(::getpid()) + ".journal");
  std::filesystem::remove(file);
  Trial whole(test);
  whole.keep_journal(file, false);
  (whole.*execute)();
  const std::string journal = read_file(file).value();
  for (std::size_t cut = journal.find('\n', journal.find('\n') + 1) + 1; cut + 2 < journal.size();
       cut = std::min(journal.find('\n', cut) + 1, cut + 100)) {
    if (journal.find("\"finished\"", 0) < cut) break;
    ASSERT_TRUE(write_file(file, mission::interrupted_journal(journal, cut)));
    Trial rest(test);
    rest.keep_journal(file, true);
    (rest.*execute)();
    if (::testing::Test::HasFailure()) FAIL() << "after\n" << journal.substr(0, cut);
    expect_nothing_done_twice(read_file(file).value());
  }
  std::filesystem::remove(file);
}

TEST_P(MissionRunCase, GoesOnFromWhereverItBrokeOff) {
  const auto test = type::parse_yaml(*read_file(GetParam()));
  ASSERT_TRUE(test);
  if (const auto why = led_by_hand(*test, false); !why.empty()) GTEST_SKIP() << why;
  expect_to_go_on_from_everywhere(*test, &Trial::execute);
}

TEST_P(MissionRunCase, GoesOnConcurrentlyFromWhereverItBrokeOff) {
  const auto test = type::parse_yaml(*read_file(GetParam()));
  ASSERT_TRUE(test);
  if (const auto why = led_by_hand(*test, true); !why.empty()) GTEST_SKIP() << why;
  expect_to_go_on_from_everywhere(*test, &Trial::execute_concurrently);
}

INSTANTIATE_TEST_SUITE_P(Files, MissionRunCase, ::testing::ValuesIn(glob_files(kCases)),
                         [](const auto& one) { return one.param.stem().string(); });

}  // namespace
}  // namespace segue::mission
