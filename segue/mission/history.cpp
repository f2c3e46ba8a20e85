// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/history.hpp>
#include <segue/type/json.hpp>

#include <algorithm>
#include <set>

namespace segue::mission {

namespace {

/// "{port}" as the value of that input; anything else as it is.
std::string ground(const std::string& argument, const Action& action, std::span<const type::Value> inputs) {
  if (argument.size() < 2 || argument.front() != '{' || argument.back() != '}') return argument;
  const auto port = std::ranges::find(action.inputs, argument.substr(1, argument.size() - 2), &Port::name);
  const auto place = static_cast<std::size_t>(port - action.inputs.begin());
  if (place >= inputs.size()) return argument;
  const type::Value& value = inputs[place];
  return value.is_string() ? value.as_string() : type::to_json(value, -1);
}

}  // namespace

void History::add_effects(std::uint32_t item, const Action& action, std::span<const type::Value> inputs) {
  for (Fact fact : action.effects) {
    for (std::string& argument : fact.arguments)
      argument = ground(argument, action, inputs);
    effects_.push_back({item, fact.positive, to_string(fact)});
  }
}

std::vector<std::string> History::world() const {
  std::set<std::string> facts;
  for (const Effect& effect : effects_) {
    if (items_[effect.item].undone) continue;
    if (effect.holds)
      facts.insert(effect.fact);
    else
      facts.erase(effect.fact);
  }
  return {facts.begin(), facts.end()};
}

std::string History::path(const Program& program, std::uint32_t item) const {
  std::vector<const std::string*> ids;
  for (; item != kNone; item = items_[item].parent) {
    // A root has no name of its own within what uses it.
    const StateIndex state = items_[item].state;
    if (program.node(state).parent != kNoState) ids.push_back(&program.state(state).id.str());
  }
  std::string text;
  for (auto id = ids.rbegin(); id != ids.rend(); ++id)
    text += (text.empty() ? "" : "/") + **id;
  return text;
}

}  // namespace segue::mission
