// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/model/network.hpp>

#include <algorithm>
#include <string_view>
#include <unordered_map>
#include <unordered_set>
#include <utility>

namespace segue::model {
namespace {

/// Collects sentences up to a limit; the comparison stops early once it is full().
class Findings {
 public:
  explicit Findings(std::size_t limit) : limit_(limit) {}
  [[nodiscard]] bool full() const { return sentences_.size() >= limit_; }
  void add(std::string sentence) {
    if (!full()) sentences_.push_back(std::move(sentence));
  }
  std::vector<std::string> take() && { return std::move(sentences_); }

 private:
  std::size_t limit_;
  std::vector<std::string> sentences_;
};

template <class Items, class Key>
auto index_by(const Items& items, Key key) {
  using Item = typename Items::value_type;
  std::unordered_map<std::decay_t<decltype(key(items.front()))>, const Item*> index;
  index.reserve(items.size());
  for (const Item& item : items)
    index.try_emplace(key(item), &item);
  return index;
}

std::string word_of(const std::optional<FailurePolicy>& policy) {
  return policy ? std::string(to_string(*policy)) : "nothing";
}

void compare_tasks(const Task& a, const Task& b, Findings& findings) {
  auto compare = [&](bool equal, std::string_view what, const std::string& first, const std::string& second) {
    if (equal) return;
    findings.add("task " + quote(a.id.str()) + ": " + std::string(what) + " is " + second + ", expected " +
                 first);
  };
  compare(a.component == b.component, "component", a.component.str(), b.component.str());
  compare(a.state == b.state, "state", std::string(to_string(a.state)), std::string(to_string(b.state)));
  compare(a.config_names == b.config_names, "list of configuration sections",
          "[" + listed(a.config_names) + "]", "[" + listed(b.config_names) + "]");
  compare(a.properties == b.properties, "value of the properties", type::describe(a.properties),
          type::describe(b.properties) + " of other content");
  compare(a.activity == b.activity, "activity", a.activity ? "given" : "default",
          b.activity ? "given, other" : "default");
  compare(a.exclusive == b.exclusive, "list of devices", "[" + listed(a.exclusive) + "]",
          "[" + listed(b.exclusive) + "]");
  compare(a.takes_over == b.takes_over, "takes_over", a.takes_over ? a.takes_over->str() : "nothing",
          b.takes_over ? b.takes_over->str() : "nothing");
  compare(a.on_failure == b.on_failure, "on_failure", word_of(a.on_failure), word_of(b.on_failure));
}

std::string_view name_of(const Task& task) {
  return task.id.str();
}

void compare_all_tasks(const Network& a, const Network& b, Findings& findings) {
  const auto in_a = index_by(a.tasks, name_of);
  const auto in_b = index_by(b.tasks, name_of);
  for (const Task& task : a.tasks) {
    if (findings.full()) return;
    auto other = in_b.find(name_of(task));
    if (other == in_b.end()) {
      findings.add("task " + quote(task.id.str()) + " is missing");
    } else if (!(task == *other->second)) {
      compare_tasks(task, *other->second, findings);
    }
  }
  for (const Task& task : b.tasks) {
    if (findings.full()) return;
    if (!in_a.contains(name_of(task))) findings.add("task " + quote(task.id.str()) + " is not expected");
  }
  if (a.tasks.size() != b.tasks.size() && in_a.size() == in_b.size()) {
    findings.add("a task occurs twice in one of them");
  }
}

/// Names inside the process by tasks.
using Placements = std::unordered_map<std::string_view, std::string_view>;

/// The placements of tasks that the network has.
Placements placements(const Deployment& deployment, const std::unordered_set<std::string_view>& tasks) {
  Placements result;
  for (const Placement& placement : deployment.tasks) {
    const std::string_view task = placement.task.str();
    if (tasks.contains(task)) result.try_emplace(task, placement.name);
  }
  return result;
}

std::unordered_set<std::string_view> task_ids(const Network& network) {
  std::unordered_set<std::string_view> ids;
  ids.reserve(network.tasks.size());
  for (const Task& task : network.tasks)
    ids.insert(name_of(task));
  return ids;
}

void compare_placements(const std::string& process, const Placements& a, const Placements& b,
                        Findings& findings) {
  for (const auto& [task, name] : a) {
    auto other = b.find(task);
    if (other == b.end()) {
      findings.add("process " + process + " lacks task " + quote(task));
    } else if (other->second != name) {
      findings.add("process " + process + ": task " + quote(task) + " is called " + quote(other->second) +
                   ", expected " + quote(name));
    }
  }
  for (const auto& [task, name] : b) {
    if (!a.contains(task)) {
      findings.add("process " + process + " holds task " + quote(task) + ", which is not expected");
    }
  }
}

void compare_deployments(const Network& a, const Network& b, Findings& findings) {
  const auto in_a = index_by(a.deployments, [](const Deployment& d) { return d.key(); });
  const auto in_b = index_by(b.deployments, [](const Deployment& d) { return d.key(); });
  const auto tasks_a = task_ids(a);
  const auto tasks_b = task_ids(b);
  for (const auto& [key, deployment] : in_a) {
    if (findings.full()) return;
    auto other = in_b.find(key);
    if (other == in_b.end()) {
      findings.add("process " + to_string(key) + " is missing");
      continue;
    }
    if (!deployment->same_process(*other->second)) {
      findings.add("process " + to_string(key) + ": attributes differ");
    }
    compare_placements(to_string(key), placements(*deployment, tasks_a), placements(*other->second, tasks_b),
                       findings);
  }
  for (const auto& [key, deployment] : in_b) {
    if (findings.full()) return;
    if (!in_a.contains(key)) findings.add("process " + to_string(key) + " is not expected");
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

void compare_connections(const Network& a, const Network& b, Findings& findings) {
  std::unordered_map<const Connection*, int, ConnectionHash, ConnectionEqual> balance;
  balance.reserve(a.connections.size());
  for (const Connection& connection : a.connections)
    ++balance[&connection];
  for (const Connection& connection : b.connections)
    --balance[&connection];
  for (const auto& [connection, count] : balance) {
    if (findings.full()) return;
    if (count > 0) findings.add("connection " + to_string(*connection) + " is missing");
    if (count < 0) findings.add("connection " + to_string(*connection) + " is not expected");
  }
}

}  // namespace

std::vector<std::string> differences(const Network& expected, const Network& found, std::size_t limit) {
  Findings findings(limit);
  compare_all_tasks(expected, found, findings);
  compare_deployments(expected, found, findings);
  compare_connections(expected, found, findings);
  return std::move(findings).take();
}

bool equivalent(const Network& a, const Network& b) {
  return differences(a, b, 1).empty();
}

}  // namespace segue::model
