// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/mission_engine/engine_core.hpp>
#include <segue/mission_robot/fact_observer.hpp>
#include <segue/mission_script/scripted_data.hpp>

#include <algorithm>

namespace segue::mission {

using Mode = detail::EngineCore::Mode;

Engine::Engine(std::unique_ptr<detail::EngineCore> core) : core_(std::move(core)) {}
Engine::~Engine() = default;

Result<std::unique_ptr<Engine>> Engine::create(std::shared_ptr<const Program> program, const Runners& runners,
                                               EngineOptions options) {
  if (options.journal != nullptr && (options.backward || options.part)) {
    return fail(ErrorCode::Unsupported,
                "a run with a journal cannot be stepped back, and must be of a whole mission");
  }
  auto assigned = runners.assign(program->mission());
  if (!assigned) return assigned.error();
  auto facts = options.part ? Result<World::Facts>(options.part->world.facts())
                            : initial_facts(program->mission(), options.facts);
  if (!facts) return facts.error();
  auto units = options.part ? Result<Units::Counts>(options.part->units)
                            : initial_units(program->mission(), options.resources);
  if (!units) return units.error();
  if (runners.observer() && !options.part) runners.observer()->begin(*facts);
  AttachedData data = options.part ? options.part->world.data() : options.world_data;
  if (!options.part) {
    if (auto attached = attach_declared(program->mission(), data); !attached) return attached.error();
  }
  const bool lists_changes = options.part && !data.empty();
  WorldValues values = options.part ? options.part->values : initial_values(program->mission());
  World world(std::move(*facts), options.backward || lists_changes, data, std::move(values));
  auto core = std::make_unique<detail::EngineCore>(std::move(program), std::move(*assigned), std::move(world),
                                                   Units(*units), std::move(options));
  core->observer = runners.observer();
  return std::unique_ptr<Engine>(new Engine(std::move(core)));
}

Result<void> Engine::set_input(std::string_view name, type::Value value) {
  const auto input = core_->program->input_for(name, value);
  if (!input) return input.error();
  core_->given_inputs.emplace_back(*input, std::move(value));
  return {};
}

Result<void> Engine::start_at(std::string_view path) {
  const auto states = core_->program->states_on(path);
  if (!states) return states.error();
  core_->start_path.assign(states->rbegin(), states->rend());
  return {};
}

Engine::Progress Engine::run() {
  return core_->run();
}
const MissionResult& Engine::result() const {
  return core_->result;
}
void Engine::pause() {
  core_->mailbox->request_pause();
}
void Engine::stop() {
  core_->mailbox->request_stop();
}

void Engine::resume() {
  core_->release(Mode::Run);
}
void Engine::step_into() {
  core_->release(Mode::Hold);
}
void Engine::step_over() {
  core_->mark_held(false);
  core_->release(Mode::Marked);
}
void Engine::step_out() {
  core_->mark_held(true);
  core_->release(Mode::Marked);
}
void Engine::run_to(std::string path) {
  const auto states = core_->program->states_on(path);
  if (states && !states->empty()) core_->breakpoints.set_once({std::move(path), states->back()});
  core_->release(Mode::Run);
}
Result<void> Engine::set_breakpoints(const std::vector<std::string>& paths) {
  std::vector<detail::Breakpoints::Place> places;
  for (const std::string& path : paths) {
    const auto states = core_->program->states_on(path);
    if (!states) return states.error();
    if (states->empty()) return fail(ErrorCode::InvalidArgument, "a breakpoint must be at a state");
    places.push_back({path, states->back()});
  }
  core_->breakpoints.set(std::move(places));
  return {};
}
Result<void> Engine::go_on_at(std::string_view path) {
  const auto states = core_->program->states_on(path);
  if (!states) return states.error();
  if (states->empty()) return fail(ErrorCode::InvalidArgument, "a mission goes on at a state in it");
  return core_->go_on_at(*states);
}
Result<type::Value> Engine::values_of(std::string_view path) {
  const auto states = core_->program->states_on(path);
  if (!states) return states.error();
  return core_->values_of(*states);
}
void Engine::post(std::function<void()> task) {
  core_->mailbox->request(std::move(task));
}
void Engine::wait_for_message() {
  core_->mailbox->wait(std::nullopt);
}
bool Engine::is_at_rest() const {
  return core_->at_rest;
}
Result<void> Engine::step_back() {
  return core_->step_back();
}
std::vector<std::string> Engine::held_at() const {
  return core_->held_at();
}

const Program& Engine::program() const {
  return *core_->program;
}
const History& Engine::history() const {
  return core_->history;
}
Globals& Engine::globals() {
  return core_->globals;
}
const World& Engine::world() const {
  return core_->world;
}
const Units& Engine::units() const {
  return core_->units;
}
std::uint64_t Engine::executions() const {
  return core_->executions;
}

}  // namespace segue::mission
