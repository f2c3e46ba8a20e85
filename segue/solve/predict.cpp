// SPDX-License-Identifier: Apache-2.0
#include <segue/solve/simulation.hpp>
#include <segue/solve/solve.hpp>

#include <cstdint>
#include <vector>

namespace segue::solve {

namespace {

/// An action may only wait for actions that stand before it in the list, and for none of a later phase, since
/// phases are executed in sequence.
class Order {
 public:
  explicit Order(const std::vector<model::Action>& actions) : actions_(actions), seen_(actions.size()) {}

  /// Checks each action in list order.
  Result<> check(const model::Action& action) {
    for (const int id : action.after) {
      const model::Action* before = seen(id);
      if (before == nullptr) {
        return fail(ErrorCode::InvalidState, "it waits for action " + std::to_string(id) +
                                                 ", which does not stand before it in the list");
      }
      if (before->phase > action.phase) {
        return fail(ErrorCode::InvalidState, "it is of the phase " + std::string(to_string(action.phase)) +
                                                 ", but waits for action " + std::to_string(id) + " (" +
                                                 before->label() + "), which is of " +
                                                 std::string(to_string(before->phase)));
      }
    }
    if (seen(action.id) != nullptr)
      return fail(ErrorCode::InvalidState, "another action before it has the same id");
    seen_.insert(hash(action.id), static_cast<int>(&action - actions_.data()));
    return {};
  }

 private:
  static std::size_t hash(int id) { return (static_cast<std::uint32_t>(id) * 0x9e3779b97f4a7c15ULL) >> 32; }

  /// The action of that id that stands before; nullptr: none does.
  [[nodiscard]] const model::Action* seen(int id) const {
    const auto is_it = [&](int place) { return actions_[detail::as_index(place)].id == id; };
    const int place = seen_.find(hash(id), is_it);
    return place == detail::kNone ? nullptr : &actions_[detail::as_index(place)];
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
