// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/pool_actions.hpp>

#include <segue/base/text.hpp>
#include <segue/mission/checks.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

using type::Value;

namespace {

template <class Items>
std::vector<std::string> listed_names(const Items& items) {
  std::vector<std::string> names;
  for (const auto& item : items)
    names.push_back(item.name);
  return names;
}

void claim(Mission& mission, const std::string& pool) {
  auto found = std::ranges::find(mission.resources, pool, &Resource::name);
  if (found == mission.resources.end()) {
    mission.resources.emplace_back().name = pool;
    found = mission.resources.end() - 1;
  }
  found->kind = ResourceClass::Process;
  found->commutes = true;
}

void hold_unit(Action& action, const std::string& pool) {
  const bool holds = std::ranges::any_of(action.resources, [&](const ResourceUse& use) {
    return use.operation == ResourceOperation::Block && use.resource == pool;
  });
  if (holds) return;
  ResourceUse use;
  use.resource = pool;
  use.where = action.where;
  action.resources.push_back(std::move(use));
}

/// The type of a field of a type; nullptr if it has none.
const type::Type* type_of(const type::Type* type, std::string_view field) {
  if (field == "value") return type;
  while (type != nullptr && !field.empty()) {
    const std::size_t end = std::min(field.find('.'), field.size());
    const auto found = std::ranges::find(type->fields, field.substr(0, end), &type::Field::name);
    type = found == type->fields.end() ? nullptr : found->type;
    field.remove_prefix(std::min(end + 1, field.size()));
  }
  return type;
}

/// Checks that a pool has the operation that one action calls, with fitting inputs and outputs.
class CallCheck {
 public:
  CallCheck(const Action& action, const PoolCall& call, Diagnostics& diagnostics)
      : action_(action), call_(call), diagnostics_(diagnostics) {}

  void run(const std::vector<model::Pool>& pools, const model::ComponentCatalog& catalog) {
    const auto pool = std::ranges::find(pools, call_.pool, &model::Pool::name);
    if (pool == pools.end()) {
      return error(
          "unknown-pool",
          "the robot has no pool " + quote(call_.pool) + did_you_mean(call_.pool, listed_names(pools)),
          action_.where);
    }
    const auto* component = catalog.find(pool->task.component);
    if (component == nullptr) return;
    const auto operation =
        std::ranges::find(component->operations, call_.operation, &model::OperationModel::name);
    if (operation == component->operations.end()) {
      return error("unknown-operation",
                   "in pool " + quote(call_.pool) + ", component " + quote(component->name.str()) +
                       " has no operation " + quote(call_.operation) +
                       did_you_mean(call_.operation, listed_names(component->operations)),
                   call_.where);
    }
    check_arguments(*operation);
    check_fields(catalog.types().find(operation->result), operation->result);
  }

 private:
  void error(std::string code, const std::string& message, const SourcePlace& where) {
    diagnostics_.error(std::move(code), "action " + quote(action_.name.str()) + ": " + message, where);
  }

  [[nodiscard]] std::string operation() const { return call_.pool + "." + call_.operation; }

  void check_arguments(const model::OperationModel& operation) {
    const auto names = listed_names(operation.arguments);
    for (const std::string& name : names) {
      if (call_.arguments.find(name) != nullptr) continue;
      error("missing-argument", this->operation() + " needs the argument " + quote(name), call_.where);
    }
    if (!call_.arguments.is_map()) return;
    for (const auto& [name, value] : call_.arguments.as_map()) {
      if (std::ranges::find(names, name) != names.end()) continue;
      error("unknown-argument",
            this->operation() + " has no argument " + quote(name) + did_you_mean(name, names), call_.where);
    }
  }

  void check_fields(const type::Type* result, const std::string& name) {
    if (result == nullptr && !name.empty()) return;  // a type that is not known may have anything
    const auto check = [&](const std::string& field, const SourcePlace& where) {
      if (type_of(result, field) != nullptr) return;
      std::vector<std::string> names;
      if (result != nullptr) names = listed_names(result->fields);
      error("unknown-field",
            (name.empty() ? operation() + " answers nothing, so there is no field "
                          : operation() + " answers " + name + ", which has no field ") +
                quote(field) + did_you_mean(field, names),
            where);
    };
    for (const ResultField& one : call_.outputs)
      check(one.field, one.where);
    if (!call_.outcome_from.empty()) check(call_.outcome_from, call_.where);
  }

  const Action& action_;
  const PoolCall& call_;
  Diagnostics& diagnostics_;
};

}  // namespace

const Value* field_of(const Value& answer, std::string_view field) {
  if (field == "value") return &answer;
  const Value* part = &answer;
  while (part != nullptr && !field.empty()) {
    const std::size_t end = std::min(field.find('.'), field.size());
    part = part->is_map() ? part->find(field.substr(0, end)) : nullptr;
    field.remove_prefix(std::min(end + 1, field.size()));
  }
  return part;
}

bool uses_pools(const Mission& mission) {
  return std::ranges::any_of(
      mission.actions, [](const Action& action) { return std::holds_alternative<PoolCall>(action.run); });
}

void claim_pools(Mission& mission) {
  for (Action& action : mission.actions) {
    const auto* call = std::get_if<PoolCall>(&action.run);
    if (call == nullptr) continue;
    claim(mission, call->pool);
    hold_unit(action, call->pool);
  }
}

Result<UnitCounts> pool_units(const Mission& mission, const std::vector<PoolView>& pools) {
  UnitCounts counts;
  for (const Action& action : mission.actions) {
    const auto* call = std::get_if<PoolCall>(&action.run);
    if (call == nullptr) continue;
    const auto pool = std::ranges::find(pools, call->pool, &PoolView::name);
    if (pool == pools.end()) {
      return fail(ErrorCode::NotFound,
                  "action " + quote(action.name.str()) + ": the robot has no pool " + quote(call->pool) +
                      did_you_mean(call->pool, listed_names(pools)),
                  action.name.str(), action.where);
    }
    const bool known = std::ranges::any_of(counts, [&](const auto& one) { return one.first == call->pool; });
    if (!known) counts.emplace_back(call->pool, pool->most);
  }
  return counts;
}

void check_pools(const Mission& mission, const std::vector<model::Pool>& pools,
                 const model::ComponentCatalog& catalog, Diagnostics& diagnostics) {
  for (const Action& action : mission.actions) {
    if (const auto* call = std::get_if<PoolCall>(&action.run))
      CallCheck(action, *call, diagnostics).run(pools, catalog);
  }
}

namespace detail {

void check_pools(const Mission& mission, Diagnostics& diagnostics) {
  for (const Action& action : mission.actions) {
    const auto* call = std::get_if<PoolCall>(&action.run);
    if (call == nullptr) continue;
    check_inputs(action, call->arguments, call->where, diagnostics);
    for (const ResultField& one : call->outputs) {
      if (position(action.outputs, one.output)) continue;
      diagnostics.error("unknown-port",
                        "action " + quote(action.name.str()) + ": it has no output " + quote(one.output) +
                            suggestion(action.outputs, one.output),
                        one.where);
    }
  }
}

}  // namespace detail
}  // namespace segue::mission
