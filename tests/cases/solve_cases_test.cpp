// SPDX-License-Identifier: Apache-2.0
#include <segue/base/file.hpp>
#include <segue/model/files.hpp>
#include <segue/solve/solve.hpp>
#include <segue/type/yaml.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <support/network_of.hpp>
#include <support/paths.hpp>
#include <support/strict_machine.hpp>

#include <filesystem>
#include <map>
#include <set>

/// Runs tests/cases/solve/*.yaml and the Artemis tables; README.md there describes the format. A new case
/// needs no C++.
namespace segue::solve {
namespace {

using model::Action;
using model::Transition;
using type::Value;
using Labels = std::vector<std::string>;

const std::filesystem::path kFolder =
    std::filesystem::path(segue::paths::kSourceFolder) / "tests/cases/solve";
const std::filesystem::path kControllers =
    std::filesystem::path(segue::paths::kSourceFolder) / "examples/04_artemis/controllers";

Labels texts(const Value* list) {
  Labels found;
  if (list == nullptr) return found;
  for (const Value& item : list->as_list())
    found.push_back(item.as_string());
  return found;
}

struct Case {
  model::ComponentCatalog catalog;
  model::Network current;
  model::Network target;
  Options options;
  Value expect;

  [[nodiscard]] Result<Transition> solve(model::Order order) const {
    Options asked = options;
    asked.order = order;
    return diff(current, target, catalog, asked);
  }
};

model::Network network_of(const Value* value, const std::string& file) {
  return value == nullptr ? model::Network{} : segue::testing::network_of(type::to_yaml(*value), file);
}

model::ComponentModel component_of(const std::string& name, const Value& value) {
  model::ComponentModel component;
  component.name = model::ComponentName(name);
  for (const std::string& port : texts(value.find("dynamic"))) {
    component.ports.push_back({port, model::Direction::Input, "", true, false, ""});
    component.ports.push_back({port, model::Direction::Output, "", true, false, ""});
  }
  for (const std::string& property : texts(value.find("live"))) {
    component.properties.push_back({property, "", {}, true, ""});
  }
  component.exclusive = texts(value.find("exclusive"));
  return component;
}

Options options_of(const Value* value) {
  Options options;
  if (value == nullptr) return options;
  for (const auto& [key, on] : value->as_map()) {
    EXPECT_TRUE(key == "side_by_side" || key == "force") << "no option is called " << key;
    (key == "force" ? options.force : options.side_by_side) = on.as_bool();
  }
  return options;
}

Case load_case(const std::filesystem::path& file) {
  Case found;
  const auto value = type::load_yaml(file);
  if (!value) {
    ADD_FAILURE() << to_string(value.error());
    return found;
  }
  for (const auto& [key, part] : value->as_map()) {
    static const std::set<std::string> kKeys = {"rule",    "components", "options",
                                                "current", "target",     "expect"};
    EXPECT_TRUE(kKeys.contains(key)) << "no case has a part " << key;
  }
  found.current = network_of(value->find("current"), file.string());
  found.target = network_of(value->find("target"), file.string());
  if (const Value* components = value->find("components")) {
    for (const auto& [name, component] : components->as_map())
      found.catalog.add(component_of(name, component));
  }
  found.options = options_of(value->find("options"));
  found.expect = *value->find("expect");
  return found;
}

Labels labels(const Transition& transition) {
  Labels found;
  for (const Action& action : transition.actions)
    found.push_back(action.label());
  return found;
}

Labels labels(const Transition& transition, model::Phase phase) {
  Labels found;
  for (const Action& action : transition.actions) {
    if (action.phase == phase) found.push_back(action.label());
  }
  return found;
}

void check_phases(const Transition& seamless, const Value& expected) {
  for (const auto& [name, list] : expected.as_map()) {
    const auto* const known = std::find(model::kPhaseNames.begin(), model::kPhaseNames.end(), name);
    ASSERT_NE(known, model::kPhaseNames.end()) << "no phase " << name;
    const auto phase = static_cast<model::Phase>(known - model::kPhaseNames.begin());
    EXPECT_EQ(labels(seamless, phase), texts(&list)) << name;
  }
}

void check_after(const Transition& seamless, const Value& expected) {
  for (const auto& [label, list] : expected.as_map()) {
    const auto action =
        std::find_if(seamless.actions.begin(), seamless.actions.end(),
                     [&label = label](const Action& other) { return other.label() == label; });
    ASSERT_NE(action, seamless.actions.end()) << "no action " << label;
    Labels before;
    for (const int id : action->after) {
      before.push_back(seamless.actions[static_cast<std::size_t>(id - 1)].label());
    }
    EXPECT_THAT(before, ::testing::UnorderedElementsAreArray(texts(&list)))
        << "what " << label << " waits for";
  }
}

void check_counts(const Transition& transition, const Value& expected) {
  const model::ActionCounts counts = transition.counts();
  for (const auto& [name, count] : expected.as_map()) {
    if (name == "from" || name == "to") continue;
    const auto* const kind = std::find(model::kActionKindNames.begin(), model::kActionKindNames.end(), name);
    if (name == "total") {
      EXPECT_EQ(counts.total(), count.as_int());
    } else if (name == "state_changes") {
      EXPECT_EQ(counts.state_changes(), count.as_int());
    } else {
      ASSERT_NE(kind, model::kActionKindNames.end()) << "no kind " << name;
      EXPECT_EQ(counts.by_kind[static_cast<std::size_t>(kind - model::kActionKindNames.begin())],
                count.as_int())
          << name;
    }
  }
}

void check_definition(const Transition& paper, const Value& expected) {
  for (const auto& [id, properties] : expected.as_map()) {
    const auto action =
        std::find_if(paper.actions.begin(), paper.actions.end(), [&id = id](const Action& other) {
          return other.kind == model::ActionKind::ApplyConfig && other.task()->str() == id;
        });
    ASSERT_NE(action, paper.actions.end()) << "no configuration of " << id << " is applied";
    EXPECT_EQ(std::get<model::ConfigAction>(action->what).definition.properties, properties) << id;
  }
}

Labels killed(const Transition& transition) {
  Labels found;
  for (const Action& action : transition.actions) {
    const auto* what = std::get_if<model::DeploymentAction>(&action.what);
    if (what != nullptr && what->kill) found.push_back(action.label());
  }
  return found;
}

Labels names(const std::vector<model::TaskId>& ids) {
  Labels found;
  for (const auto& id : ids)
    found.push_back(id.str());
  return found;
}

void check_expectation(const Case& test, const Transition& paper, const Transition& seamless) {
  for (const auto& [key, value] : test.expect.as_map()) {
    if (key == "paper") {
      EXPECT_EQ(labels(paper), texts(&value));
    } else if (key == "phases") {
      check_phases(seamless, value);
    } else if (key == "after") {
      check_after(seamless, value);
    } else if (key == "counts") {
      check_counts(seamless, value);
    } else if (key == "applied") {
      check_definition(paper, value);
    } else if (key == "killed") {
      EXPECT_EQ(killed(seamless), texts(&value));
    } else if (key == "removes") {
      EXPECT_EQ(names(seamless.removes), texts(&value));
    } else if (key == "redefines") {
      Labels found;
      for (const auto& task : seamless.redefines)
        found.push_back(task.id.str());
      EXPECT_EQ(found, texts(&value));
    } else {
      ADD_FAILURE() << "no expectation is called " << key;
    }
  }
}

/// For every case: the target is reached, both by prediction and on the strict machine.
void check_result(const Case& test, const Transition& transition) {
  const auto result = predict(test.current, transition, test.catalog);
  ASSERT_TRUE(result) << to_string(result.error());
  EXPECT_THAT(model::differences(*result, test.target), ::testing::IsEmpty());
  segue::testing::StrictMachine machine(test.current, test.target, test.catalog, test.options.side_by_side);
  for (const Action& action : transition.actions)
    EXPECT_EQ(machine.execute(action), "") << action.label();
  EXPECT_EQ(machine.finish(transition, test.target), "");
}

std::vector<std::filesystem::path> case_files() {
  return glob_files(kFolder / "*.yaml");
}

class SolveCase : public ::testing::TestWithParam<std::filesystem::path> {};

TEST_P(SolveCase, Holds) {
  const Case test = load_case(GetParam());
  if (HasFailure()) return;
  const auto paper = test.solve(model::Order::Paper);
  const auto seamless = test.solve(model::Order::Seamless);
  if (const Value* error = test.expect.find("error")) {
    ASSERT_FALSE(paper);
    ASSERT_FALSE(seamless);
    EXPECT_THAT(to_string(seamless.error()), ::testing::HasSubstr(error->as_string()));
    return;
  }
  ASSERT_TRUE(paper) << to_string(paper.error());
  ASSERT_TRUE(seamless) << to_string(seamless.error());
  check_expectation(test, *paper, *seamless);
  check_result(test, *paper);
  check_result(test, *seamless);
}

INSTANTIATE_TEST_SUITE_P(Files, SolveCase, ::testing::ValuesIn(case_files()), [](const auto& parameter) {
  std::string name = parameter.param.stem().string();
  std::replace_if(
      name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
  return name;
});

TEST(SolveCases, AreFound) {
  EXPECT_GE(case_files().size(), 20U);
}

// The four controllers of the Artemis rover: all numbers of the paper's Table 7, and which actions they are.

model::Network controller(const Value& name) {
  Diagnostics diagnostics;
  const auto network = model::load_network(kControllers / (name.as_string() + ".cnd"), diagnostics);
  EXPECT_TRUE(network) << to_string(diagnostics);
  return network.value_or(model::Network{});
}

Value artemis(const char* file) {
  const auto value = type::load_yaml(kFolder / "artemis" / file);
  EXPECT_TRUE(value) << to_string(value.error());
  return value.value_or(Value());
}

class Artemis : public ::testing::TestWithParam<model::Order> {
 protected:
  Case pair(const Value& row) {
    return {{}, controller(*row.find("from")), controller(*row.find("to")), {}, {}};
  }
};

TEST_P(Artemis, HasTheCountsOfTable7) {
  const Value table = artemis("table7.yaml");
  const auto& rows = table.find("transitions")->as_list();
  ASSERT_EQ(rows.size(), 12U);
  for (const Value& row : rows) {
    SCOPED_TRACE(type::to_yaml(row));
    ASSERT_EQ(row.as_map().size(), 9U) << "from, to and seven numbers";
    const Case test = pair(row);
    const auto found = diff(test.current, test.target, {}, {GetParam()});
    ASSERT_TRUE(found) << to_string(found.error());
    check_counts(*found, row);
    check_result(test, *found);
  }
}

/// "stop" and its subjects, sorted, in the form of the file.
std::map<std::string, std::multiset<std::string>> by_kind(const Transition& transition) {
  std::map<std::string, std::multiset<std::string>> found;
  for (const Action& action : transition.actions) {
    const std::string kind(to_string(action.kind));
    found[kind].insert(action.label().substr(kind.size() + 1));
  }
  return found;
}

TEST_P(Artemis, TakesTheExpectedActions) {
  const Value expected = artemis("expected_transitions.yaml");
  ASSERT_EQ(expected.as_list().size(), 12U);
  for (const Value& row : expected.as_list()) {
    SCOPED_TRACE(row.find("from")->as_string() + " to " + row.find("to")->as_string());
    const Case test = pair(row);
    const auto transition = diff(test.current, test.target, {}, {GetParam()});
    ASSERT_TRUE(transition);
    auto found = by_kind(*transition);
    std::size_t kinds = 0;
    for (const auto& [kind, list] : row.find("actions")->as_map()) {
      const Labels subjects = texts(&list);
      EXPECT_EQ(found[kind], std::multiset<std::string>(subjects.begin(), subjects.end())) << kind;
      ++kinds;
    }
    EXPECT_EQ(found.size(), kinds) << "unexpected kinds of actions";
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, Artemis, ::testing::Values(model::Order::Seamless, model::Order::Paper),
                         [](const auto& parameter) { return std::string(to_string(parameter.param)); });

}  // namespace
}  // namespace segue::solve
