// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/simulation.hpp>
#include <segue/solve/solve.hpp>

#include <cstdint>
#include <vector>

namespace segue::solve {

namespace {

/// An action may only wait for actions that stand before it in the list.
class Order {
 public:
  explicit Order(const std::vector<model::Action>& actions) : actions_(actions), seen_(actions.size()) {}

  /// Checks each action in list order.
  Result<> check(const model::Action& action) {
    for (const int id : action.after) {
      if (!has_seen(id)) {
        return fail(ErrorCode::InvalidState, "it waits for action " + std::to_string(id) +
                                                 ", which does not stand before it in the list");
      }
    }
    if (has_seen(action.id)) return fail(ErrorCode::InvalidState, "another action before it has the same id");
    seen_.insert(hash(action.id), static_cast<int>(&action - actions_.data()));
    return {};
  }

 private:
  static std::size_t hash(int id) { return (static_cast<std::uint32_t>(id) * 0x9e3779b97f4a7c15ULL) >> 32; }

  [[nodiscard]] bool has_seen(int id) const {
    const auto is_it = [&](int place) { return actions_[detail::as_index(place)].id == id; };
    return seen_.find(hash(id), is_it) != detail::kNone;
  }

  const std::vector<model::Action>& actions_;
  detail::HashIndex seen_;
};

Error in_action(const model::Action& action, Error error) {
  error.message =
      "action " + std::to_string(action.id) + " (" + action.label() + ") is not possible: " + error.message;
  error.subject = std::to_string(action.id);
  return error;
}

}  // namespace

Result<model::Network> predict(const model::Network& current, const model::Transition& transition,
                               const model::ComponentCatalog& catalog) {
  auto simulation = detail::Simulation::create(current, catalog);
  if (!simulation) return simulation.error();
  Order order(transition.actions);
  for (const model::Action& action : transition.actions) {
    if (auto done = order.check(action); !done) return in_action(action, done.error());
    if (auto done = simulation->execute(action); !done) return in_action(action, done.error());
  }
  for (const model::TaskId& id : transition.removes) {
    if (auto done = simulation->remove(id); !done) return done.error();
  }
  for (const model::Task& task : transition.redefines) {
    if (auto done = simulation->redefine(task); !done) return done.error();
  }
  auto network = simulation->network();
  if (network) network->name = transition.to;
  return network;
}

}  // namespace segue::solve
