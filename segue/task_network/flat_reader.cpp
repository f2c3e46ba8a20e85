// SPDX-License-Identifier: Apache-2.0
#include "flat_reader.hpp"

#include <segue/base/likelihood.hpp>
#include <segue/base/text.hpp>
#include <segue/base/unknown_key.hpp>

#include <algorithm>
#include <cmath>

namespace segue::task_network::detail {

using type::Value;

void FlatReader::error(std::string code, std::string message, const Value& at) {
  diagnostics_.error(std::move(code), std::move(message),
                     {file_, static_cast<int>(at.mark().line), static_cast<int>(at.mark().column)});
}

void FlatReader::refuse_unknown(const Value& map, const std::string& what,
                                std::initializer_list<std::string_view> known) {
  const std::vector<std::string> names(known.begin(), known.end());
  for (const auto& [key, value] : map.as_map()) {
    if (const auto problem = problem_of_key(key, names)) error("unknown-key", what + ": " + *problem, value);
  }
}

/// The value of the key, or null; a value of another kind is an error.
const Value* FlatReader::find(const Value& map, std::string_view key, Value::Kind kind) {
  const Value* value = map.find(key);
  if (value == nullptr || value->is_null()) return nullptr;
  if (value->kind() == kind) return value;
  error("wrong-kind", quote(key) + " must be " + std::string(describe(kind)) + ", not " + describe(*value),
        *value);
  return nullptr;
}

const Value::List& FlatReader::list(const Value& map, std::string_view key) {
  static const Value::List kEmpty;
  const Value* value = find(map, key, Value::Kind::List);
  return value == nullptr ? kEmpty : value->as_list();
}

std::string FlatReader::text(const Value& map, std::string_view key) {
  const Value* value = find(map, key, Value::Kind::String);
  return value == nullptr ? std::string() : value->as_string();
}

bool FlatReader::flag(const Value& map, std::string_view key, bool fallback) {
  const Value* value = find(map, key, Value::Kind::Bool);
  return value == nullptr ? fallback : value->as_bool();
}

std::uint32_t FlatReader::count(const Value& map, std::string_view key, std::uint32_t fallback) {
  constexpr std::int64_t kMost = 1'000'000'000;
  const Value* value = find(map, key, Value::Kind::Int);
  if (value == nullptr) return fallback;
  if (value->as_int() >= 0 && value->as_int() <= kMost) return static_cast<std::uint32_t>(value->as_int());
  error("bad-count", quote(key) + " must be between 0 and " + std::to_string(kMost), *value);
  return fallback;
}

void FlatReader::read(const Value& root) {
  if (!root.is_map()) return error("wrong-kind", "a task network must be a map", root);
  refuse_unknown(root, "the network", {"name", "source", "initial_world", "goal", "resources", "nodes"});
  network_.name = text(root, "name");
  read_world(root);
  read_resources(root);
  order_nodes(root);
  for (Entry& entry : entries_)
    read_node(entry);
  join_releases();
  for (Entry& entry : entries_) {
    network_.append(entry.spec);
    flat_.trials.push_back(std::move(entry.trial));
  }
}

std::optional<Literal> FlatReader::literal(const Value& value) {
  if (!value.is_string()) {
    error("bad-fact", "a fact must be text like on(box1,table), not " + describe(value), value);
    return std::nullopt;
  }
  const auto read = network_.facts.intern_literal(value.as_string());
  if (read) return *read;
  error("bad-fact", read.error().message, value);
  return std::nullopt;
}

/// "+p(a)" or "-p(a)".
std::optional<Literal> FlatReader::effect(const Value& value) {
  const std::string text = value.is_string() ? value.as_string() : std::string();
  if (!text.starts_with('+') && !text.starts_with('-')) {
    error("bad-effect",
          "an effect must be text like +on(box1,base) or -on(box1,table), not " + describe(value), value);
    return std::nullopt;
  }
  const auto fact = network_.facts.intern(std::string_view(text).substr(1));
  if (fact) return Literal{*fact, text.front() == '+'};
  error("bad-effect", fact.error().message, value);
  return std::nullopt;
}

void FlatReader::read_world(const Value& root) {
  for (const Value& entry : list(root, "initial_world")) {
    if (const auto fact = literal(entry)) network_.initial_world.set(*fact);
  }
  for (const Value& entry : list(root, "goal")) {
    if (const auto fact = literal(entry)) network_.goal.push_back(*fact);
  }
}

void FlatReader::read_resources(const Value& root) {
  const Value* resources = find(root, "resources", Value::Kind::Map);
  if (resources == nullptr) return;
  for (const auto& [name, value] : resources->as_map()) {
    if (!value.is_map()) {
      error("wrong-kind", "resource " + quote(name) + " must be a map", value);
      continue;
    }
    refuse_unknown(value, "resource " + quote(name), {"class", "count", "commutes"});
    ResourceRecord& resource = network_.resources[network_.resources.intern(name)];
    resource.count = count(value, "count", 1);
    resource.commutes = flag(value, "commutes", false);
    const std::string kind = text(value, "class");
    if (kind.empty()) continue;
    const auto known = std::ranges::find(kResourceClasses, kind);
    if (known == kResourceClasses.end())
      error("unknown-class",
            quote(kind) + " is not a valid class; one of system, process, module, world, task", value);
    else
      resource.kind = static_cast<ResourceClass>(known - kResourceClasses.begin());
  }
}

void FlatReader::order_nodes(const Value& root) {
  std::vector<std::pair<std::int64_t, const Value*>> order;
  for (const Value& value : list(root, "nodes")) {
    if (!value.is_map()) {
      error("wrong-kind", "a node must be a map", value);
      continue;
    }
    const Value* seq = find(value, "seq", Value::Kind::Int);
    order.emplace_back(seq == nullptr ? static_cast<std::int64_t>(order.size()) : seq->as_int(), &value);
  }
  std::ranges::stable_sort(order, {}, &std::pair<std::int64_t, const Value*>::first);
  for (const auto& [seq, value] : order) {
    Entry& entry = entries_.emplace_back();
    entry.value = value;
    entry.spec.name = text(*value, "name");
    if (entry.spec.name.empty()) error("missing-name", "a node needs a name", *value);
    const auto number = static_cast<std::uint32_t>(entries_.size() - 1);
    if (!numbers_.emplace(entry.spec.name, number).second)
      error("duplicate-node", "a second node " + quote(entry.spec.name), *value);
  }
}

/// The number of a node, which must come before `before` in program order.
std::optional<std::uint32_t> FlatReader::node_named(const Value& name, std::uint32_t before) {
  const auto found = name.is_string() ? numbers_.find(name.as_string()) : numbers_.end();
  if (found == numbers_.end()) {
    error("unknown-node", "there is no node " + describe(name), name);
    return std::nullopt;
  }
  if (found->second < before) return found->second;
  error("later-node",
        quote(found->first) + " does not come before " + quote(entries_[before].spec.name) +
            ", which depends on it",
        name);
  return std::nullopt;
}

void FlatReader::read_node(Entry& entry) {
  const std::string what = "node " + quote(entry.spec.name);
  refuse_unknown(*entry.value, what,
                 {"seq", "name", "duration_s", "pia", "control_flow", "preconditions", "effects", "resources",
                  "data_flows", "condition_deps", "sensing", "outcome", "actual_effects", "fails", "opaque",
                  "uncertain", "cannot_fail", "strict", "expected"});
  read_class(entry);
  read_duration(entry);
  read_facts(entry);
  read_claims(entry);
  read_flows(entry);
  read_conditions(entry);
  read_trial(entry);
}

void FlatReader::read_class(Entry& entry) {
  const Value& value = *entry.value;
  NodeSpec& spec = entry.spec;
  if (!flag(value, "pia", true)) spec.kind = ActionClass::Pure;
  if (flag(value, "sensing", false)) {
    if (spec.kind == ActionClass::Irreversible && value.find("pia") != nullptr)
      error("bad-class", "a node cannot be both irreversible ('pia') and 'sensing'", value);
    spec.kind = ActionClass::Sensing;
  }
  const std::string flow = text(value, "control_flow");
  if (!flow.empty() && flow != "plain" && flow != "condition" && flow != "routine")
    error("bad-control-flow", quote(flow) + " is none of plain, condition, routine", value);
  spec.opaque_subtree = flow == "routine";
  spec.cannot_fail = flag(value, "cannot_fail", false);
  spec.strict = flag(value, "strict", false);
  const bool silent = value.find("preconditions") == nullptr && value.find("effects") == nullptr &&
                      value.find("resources") == nullptr;
  spec.opaque = flag(value, "opaque", silent && spec.kind == ActionClass::Irreversible);
  spec.uncertain = flag(value, "uncertain", value.find("actual_effects") != nullptr);
  if (const std::string expected = text(value, "expected"); !expected.empty())
    spec.expected = network_.outcome(expected);
}

void FlatReader::read_duration(Entry& entry) {
  constexpr double kMost = 1e9;
  const Value* value = entry.value->find("duration_s");
  if (value == nullptr) return;
  const double seconds = value->is_number() ? value->as_double() : -1;
  if (!(seconds >= 0) || seconds > kMost)
    return error("bad-duration", "'duration_s' must be a number of seconds from 0 to a billion", *value);
  entry.spec.duration = Duration(std::llround(seconds * 1e9));
}

void FlatReader::read_facts(Entry& entry) {
  NodeSpec& spec = entry.spec;
  for (const Value& value : list(*entry.value, "preconditions")) {
    const auto read = literal(value);
    if (!read) continue;
    if (std::ranges::find(spec.preconditions, Literal{read->fact, !read->value}) != spec.preconditions.end())
      error("contradiction", network_.facts.text(read->fact) + " cannot be both true and false", value);
    spec.preconditions.push_back(*read);
  }
  for (const Value& value : list(*entry.value, "effects")) {
    if (const auto read = effect(value)) spec.effects.push_back(*read);
  }
}

void FlatReader::read_claims(Entry& entry) {
  for (const Value& value : list(*entry.value, "resources")) {
    if (!value.is_map() || text(value, "name").empty()) {
      error("bad-resource", "a resource of a node is a map with name and op", value);
      continue;
    }
    refuse_unknown(value, "a resource of node " + quote(entry.spec.name), {"name", "op", "count"});
    const std::string op = text(value, "op");
    const auto known = std::ranges::find(kResourceOps, op);
    if (known == kResourceOps.end()) {
      error("unknown-operation",
            quote(op) + " is not a valid operation; one of " +
                "create, consume, delete, block, release, exists",
            value);
      continue;
    }
    Claim claim;
    claim.resource = network_.resources.intern(text(value, "name"));
    claim.op = static_cast<ResourceOp>(known - kResourceOps.begin());
    claim.count = count(value, "count", 1);
    const auto takes = [](ResourceOp one) {
      return one == ResourceOp::Block || one == ResourceOp::Consume || one == ResourceOp::Delete;
    };
    for (const Claim& other : entry.spec.claims) {
      if (other.resource == claim.resource && other.op != claim.op && takes(other.op) && takes(claim.op))
        error("contradiction", "a node can block, consume or delete a resource, only one of these", value);
    }
    entry.spec.claims.push_back(claim);
  }
}

/// [from node, output, to node, input]; the node that holds it is `to`.
void FlatReader::read_flows(const Entry& entry) {
  for (const Value& value : list(*entry.value, "data_flows")) {
    const bool texts =
        value.is_list() && value.as_list().size() == 4 &&
        std::ranges::all_of(value.as_list(), [](const Value& part) { return part.is_string(); });
    if (!texts) {
      error("bad-data-flow", "a data flow is a list: from node, output, to node, input", value);
      continue;
    }
    const Value::List& parts = value.as_list();
    const auto to = node_named(parts[2], static_cast<std::uint32_t>(entries_.size()));
    if (!to) continue;
    const auto from = node_named(parts[0], *to);
    if (!from) continue;
    entries_[*to].spec.inputs.push_back({NodeId{*from}, network_.names.intern(parts[1].as_string()),
                                         network_.names.intern(parts[3].as_string())});
  }
}

void FlatReader::read_conditions(Entry& entry) {
  const auto number = static_cast<std::uint32_t>(&entry - entries_.data());
  for (const Value& value : list(*entry.value, "condition_deps")) {
    const Value* name = value.is_map() ? find(value, "node", Value::Kind::String) : &value;
    const auto node = node_named(name == nullptr ? value : *name, number);
    if (!node) continue;
    Condition condition{NodeId{*node}, kSuccess};
    if (value.is_map()) {
      refuse_unknown(value, "a condition of node " + quote(entry.spec.name),
                     {"node", "outcome", "likelihood"});
      if (const std::string outcome = text(value, "outcome"); !outcome.empty())
        condition.outcome = network_.outcome(outcome);
      read_likelihood(value, condition);
    }
    NodeSpec& other = entries_[*node].spec;
    other.branches = true;
    other.handles_abort = other.handles_abort || condition.outcome == kAborted;
    entry.spec.conditions.push_back(condition);
  }
}

void FlatReader::read_likelihood(const Value& value, Condition& condition) {
  const Value* likelihood = value.find("likelihood");
  if (likelihood == nullptr) return;
  const double share = likelihood->is_number() ? likelihood->as_double() : -1;
  if (!is_likelihood(share))
    return error("bad-likelihood",
                 "a likelihood must be a number between 0 and 1, not " + describe(*likelihood), *likelihood);
  condition.likelihood = static_cast<std::uint16_t>(std::round(share * Condition::kCertain));
}

void FlatReader::read_trial(Entry& entry) {
  entry.trial.outcome = entry.spec.expected;
  if (const std::string outcome = text(*entry.value, "outcome"); !outcome.empty())
    entry.trial.outcome = network_.outcome(outcome);
  if (flag(*entry.value, "fails", false)) entry.trial.outcome = kAborted;
  if (find(*entry.value, "actual_effects", Value::Kind::List) == nullptr) return;
  entry.trial.effects.emplace();
  for (const Value& value : list(*entry.value, "actual_effects")) {
    if (const auto read = effect(value)) entry.trial.effects->push_back(*read);
  }
}

/// A release and the nearest block before it are the two ends of one lock.
void FlatReader::join_releases() {
  std::unordered_map<std::uint32_t, Claim*> blocks;
  for (Entry& entry : entries_) {
    for (Claim& claim : entry.spec.claims) {
      if (claim.op == ResourceOp::Block) blocks[index(claim.resource)] = &claim;
      if (claim.op != ResourceOp::Release) continue;
      const auto block = blocks.find(index(claim.resource));
      if (block == blocks.end()) {
        error("release-without-block",
              quote(entry.spec.name) + " releases " + quote(network_.resources.name(claim.resource)) +
                  ", which no node before it blocks",
              *entry.value);
        continue;
      }
      claim.group = block->second->group = network_.add_group(claim.resource, block->second->count);
      blocks.erase(block);
    }
  }
}

}  // namespace segue::task_network::detail
