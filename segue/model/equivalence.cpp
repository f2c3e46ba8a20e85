// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/base/utf8.hpp>
#include <segue/model/file_parts.hpp>
#include <segue/model/files.hpp>
#include <segue/model/network.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <utility>

namespace segue::model {

using type::Value;

namespace {

/// How the two networks relate, which decides the words.
enum class Wording {
  Drift,  ///< what is expected, and what was found
  Edit    ///< before and after a change
};

/// Collects sentences up to a limit; the comparison stops early once it is full().
class Findings {
 public:
  Findings(Wording wording, std::size_t limit) : wording_(wording), limit_(limit) {}
  [[nodiscard]] bool full() const { return sentences_.size() >= limit_; }
  [[nodiscard]] std::size_t size() const { return sentences_.size(); }
  void add(std::string sentence) {
    if (!full()) sentences_.push_back(std::move(sentence));
  }
  /// Only the first network has it; `why`, where that is known.
  void add_missing(const std::string& what, const std::string& why = {}) {
    const std::string sentence = what + (wording_ == Wording::Drift ? " is missing" : " is removed");
    add(why.empty() ? sentence : sentence + ": " + why);
  }
  /// Only the second network has it.
  void add_extra(const std::string& what) {
    add(what + (wording_ == Wording::Drift ? " is not expected" : " is added"));
  }
  void add_changed(const std::string& what, const std::string& first, const std::string& second) {
    add(wording_ == Wording::Drift ? what + " is " + second + ", expected " + first
                                   : what + ": " + first + " -> " + second);
  }
  std::vector<std::string> take() && { return std::move(sentences_); }

 private:
  Wording wording_;
  std::size_t limit_;
  std::vector<std::string> sentences_;
};

std::unordered_map<DeploymentKey, const Deployment*> deployments_by_key(const Network& network) {
  std::unordered_map<DeploymentKey, const Deployment*> index;
  index.reserve(network.deployments.size());
  for (const Deployment& deployment : network.deployments)
    index.try_emplace(deployment.key(), &deployment);
  return index;
}

std::string word_of(const std::optional<FailurePolicy>& policy) {
  return policy ? std::string(to_string(*policy)) : "nothing";
}

/// The value as JSON, on one line, cut where it would be too long to read.
std::string text_of(const Value* value) {
  constexpr std::size_t kLongest = 100;
  if (value == nullptr || value->is_null()) return "not set";
  const std::string text = type::to_json(*value, -1);
  return text.size() <= kLongest ? text : std::string(beginning_of(text, kLongest)) + "...";
}

/// One sentence for each part of a value that differs, with both values: "`what` 'pose.x' is 2, expected 1".
class ValueComparison {
 public:
  ValueComparison(std::string what, Findings& findings) : what_(std::move(what)), findings_(findings) {}

  void compare(const std::string& path, const Value* expected, const Value* found) {
    if (findings_.full() || (expected != nullptr && found != nullptr && *expected == *found)) return;
    const auto* map = map_in(expected);
    const auto* found_map = map_in(found);
    if (map != nullptr && found_map != nullptr) return compare_maps(path, *map, *found_map);
    const auto* list = list_in(expected);
    const auto* found_list = list_in(found);
    if (list != nullptr && found_list != nullptr && list->size() == found_list->size())
      return compare_lists(path, *list, *found_list);
    findings_.add_changed(what_ + (path.empty() ? "" : ' ' + quote(path)), text_of(expected), text_of(found));
  }

 private:
  static const type::ValueMap* map_in(const Value* value) {
    return value != nullptr && value->is_map() ? &value->as_map() : nullptr;
  }
  static const Value::List* list_in(const Value* value) {
    return value != nullptr && value->is_list() ? &value->as_list() : nullptr;
  }

  void compare_maps(const std::string& path, const type::ValueMap& expected, const type::ValueMap& found) {
    const auto inner = [&](const std::string& key) { return path.empty() ? key : path + '.' + key; };
    for (const auto& [key, value] : expected)
      compare(inner(key), &value, found.find(key));
    for (const auto& [key, value] : found) {
      if (expected.find(key) == nullptr) compare(inner(key), nullptr, &value);
    }
  }

  void compare_lists(const std::string& path, const Value::List& expected, const Value::List& found) {
    for (std::size_t i = 0; i < expected.size(); ++i)
      compare(path + '[' + std::to_string(i) + ']', &expected[i], &found[i]);
  }

  std::string what_;
  Findings& findings_;
};

/// Adds the differences of values that are not equal; at least one sentence.
void compare_values(const std::string& what, const Value& expected, const Value& found, Findings& findings) {
  const std::size_t before = findings.size();
  ValueComparison(what, findings).compare("", &expected, &found);
  if (findings.size() == before) findings.add(what + " differs");
}

/// "the default" for the activity of the component.
Value value_of(const std::optional<Activity>& activity) {
  return activity ? detail::write_activity(*activity) : Value("the default");
}

void compare_tasks(const Task& a, const Task& b, Findings& findings) {
  auto compare = [&](bool equal, std::string_view what, const std::string& first, const std::string& second) {
    if (equal) return;
    findings.add_changed("task " + quote(a.id.str()) + ": " + std::string(what), first, second);
  };
  compare(a.component == b.component, "component", a.component.str(), b.component.str());
  compare(a.state == b.state, "state", std::string(to_string(a.state)), std::string(to_string(b.state)));
  compare(a.config_names == b.config_names, "list of configuration sections",
          "[" + listed(a.config_names) + "]", "[" + listed(b.config_names) + "]");
  const std::string task = "task " + quote(a.id.str());
  if (!(a.properties == b.properties))
    compare_values(task + ": property", a.properties, b.properties, findings);
  if (!(a.activity == b.activity))
    compare_values(task + ": activity", value_of(a.activity), value_of(b.activity), findings);
  compare(a.exclusive == b.exclusive, "list of devices", "[" + listed(a.exclusive) + "]",
          "[" + listed(b.exclusive) + "]");
  compare(a.takes_over == b.takes_over, "takes_over", a.takes_over ? a.takes_over->str() : "nothing",
          b.takes_over ? b.takes_over->str() : "nothing");
  compare(a.on_failure == b.on_failure, "on_failure", word_of(a.on_failure), word_of(b.on_failure));
}

void compare_all_tasks(const Network& a, const TaskIndex& in_a, const Network& b, const TaskIndex& in_b,
                       Findings& findings) {
  for (const Task& task : a.tasks) {
    if (findings.full()) return;
    const Task* other = in_b.find(task.id);
    if (other == nullptr) {
      findings.add_missing("task " + quote(task.id.str()));
    } else if (!(task == *other)) {
      compare_tasks(task, *other, findings);
    }
  }
  for (const Task& task : b.tasks) {
    if (findings.full()) return;
    if (in_a.find(task.id) == nullptr) findings.add_extra("task " + quote(task.id.str()));
  }
  if (a.tasks.size() != b.tasks.size() && in_a.size() == in_b.size()) {
    findings.add("a task occurs twice in one of them");
  }
}

/// Names inside the process by tasks.
using Placements = std::unordered_map<std::string_view, std::string_view>;

/// The placements of tasks that the network has.
Placements placements(const Deployment& deployment, const TaskIndex& tasks) {
  Placements result;
  for (const Placement& placement : deployment.tasks) {
    if (tasks.find(placement.task) != nullptr) result.try_emplace(placement.task.str(), placement.name);
  }
  return result;
}

void compare_placements(const std::string& process, const Placements& a, const Placements& b,
                        Findings& findings) {
  for (const auto& [task, name] : a) {
    auto other = b.find(task);
    if (other == b.end()) {
      findings.add_missing("the placement of task " + quote(task) + " in process " + process);
    } else if (other->second != name) {
      findings.add_changed("the name of task " + quote(task) + " in process " + process, quote(name),
                           quote(other->second));
    }
  }
  for (const auto& [task, name] : b) {
    if (!a.contains(task)) {
      findings.add_extra("the placement of task " + quote(task) + " in process " + process);
    }
  }
}

/// Without its tasks, which are compared on their own.
Value attributes(Deployment deployment) {
  deployment.tasks.clear();
  return to_value(deployment);
}

void compare_deployments(const Network& a, const TaskIndex& tasks_a, const Network& b,
                         const TaskIndex& tasks_b, Findings& findings) {
  const auto in_a = deployments_by_key(a);
  const auto in_b = deployments_by_key(b);
  for (const auto& [key, deployment] : in_a) {
    if (findings.full()) return;
    auto other = in_b.find(key);
    if (other == in_b.end()) {
      findings.add_missing("process " + to_string(key));
      continue;
    }
    if (!deployment->same_process(*other->second)) {
      compare_values("process " + to_string(key) + ": attribute", attributes(*deployment),
                     attributes(*other->second), findings);
    }
    compare_placements(to_string(key), placements(*deployment, tasks_a), placements(*other->second, tasks_b),
                       findings);
  }
  for (const auto& [key, deployment] : in_b) {
    if (findings.full()) return;
    if (!in_a.contains(key)) findings.add_extra("process " + to_string(key));
  }
}

struct ConnectionHash {
  std::size_t operator()(const Connection* c) const noexcept {
    return combine_hashes(std::hash<PortRef>{}(c->from), std::hash<PortRef>{}(c->to));
  }
};
struct ConnectionEqual {
  bool operator()(const Connection* a, const Connection* b) const { return *a == *b; }
};

void compare_connections(const Network& a, const Network& b, const WhyMissing& why_missing,
                         Findings& findings) {
  std::unordered_map<const Connection*, int, ConnectionHash, ConnectionEqual> balance;
  balance.reserve(a.connections.size());
  for (const Connection& connection : a.connections)
    ++balance[&connection];
  for (const Connection& connection : b.connections)
    --balance[&connection];
  for (const auto& [connection, count] : balance) {
    if (findings.full()) return;
    if (count > 0)
      findings.add_missing("connection " + to_string(*connection),
                           why_missing ? why_missing(*connection) : std::string());
    if (count < 0) findings.add_extra("connection " + to_string(*connection));
  }
}

std::vector<std::string> compare(const Network& first, const Network& second, const WhyMissing& why_missing,
                                 Findings findings) {
  const TaskIndex tasks_of_first(first);
  const TaskIndex tasks_of_second(second);
  compare_all_tasks(first, tasks_of_first, second, tasks_of_second, findings);
  compare_deployments(first, tasks_of_first, second, tasks_of_second, findings);
  compare_connections(first, second, why_missing, findings);
  return std::move(findings).take();
}

}  // namespace

std::vector<std::string> differences(const Network& expected, const Network& found, std::size_t limit,
                                     const WhyMissing& why_missing) {
  return compare(expected, found, why_missing, Findings(Wording::Drift, limit));
}

std::vector<std::string> changes(const Network& before, const Network& after, std::size_t limit) {
  return compare(before, after, {}, Findings(Wording::Edit, limit));
}

bool equivalent(const Network& a, const Network& b) {
  return differences(a, b, 1).empty();
}

}  // namespace segue::model
