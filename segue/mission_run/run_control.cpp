// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_run/run_control.hpp>

#include <segue/mission_engine/engine.hpp>

#include <utility>

namespace segue::mission_run {

namespace {

std::function<void(Result<type::Value>)> without_value(RunControl::Done done) {
  return [done = std::move(done)](const Result<type::Value>& answer) {
    done(answer ? Result<void>() : Result<void>(answer.error()));
  };
}

Result<type::Value> as_value(Result<void> done) {
  return done ? Result<type::Value>(type::Value()) : Result<type::Value>(std::move(done.error()));
}

Result<void> carry_out_step(mission::Engine& engine, RunControl::Step step) {
  if (engine.held_at().empty()) {
    return fail(
        ErrorCode::InvalidState,
        "the mission is not held; pause it and wait until what is under way has ended, then it can be "
        "stepped");
  }
  switch (step) {
    case RunControl::Step::Into:
      engine.step_into();
      return {};
    case RunControl::Step::Over:
      engine.step_over();
      return {};
    case RunControl::Step::Out:
      engine.step_out();
      return {};
    case RunControl::Step::Back:
      break;
  }
  return engine.step_back();
}

}  // namespace

void RunControl::pause() {
  set_paused(true);
}

void RunControl::resume() {
  set_paused(false);
}

bool RunControl::paused() const {
  const Lock lock(mutex_);
  return pause_requested_ || position_.at.has_value();
}

void RunControl::set_paused(bool paused) {
  const Lock lock(mutex_);
  pause_requested_ = paused;
  if (!paused) position_.at.reset();  // it comes again where it is held after all
  if (run_) follow_request();
}

/// The engine looks at the wish when it comes to it, so that the last of several counts.
void RunControl::follow_request() {
  if (run_->engine == nullptr) return run_->set_paused(pause_requested_);
  const bool resumes = !pause_requested_;
  if (resumes) ++resuming_;
  run_->engine->post([this, engine = run_->engine, resumes] {
    const Lock lock(mutex_);
    if (resumes) --resuming_;
    if (pause_requested_) return engine->pause();
    engine->resume();
    position_.at.reset();
  });
}

void RunControl::step(Step step, Done done) {
  ask([step](mission::Engine& engine) { return as_value(carry_out_step(engine, step)); },
      without_value(std::move(done)), true);
}

void RunControl::set_breakpoints(std::vector<std::string> paths, Done done) {
  ask(
      [this, paths = std::move(paths)](mission::Engine& engine) -> Result<type::Value> {
        if (auto set = engine.set_breakpoints(paths); !set) return std::move(set.error());
        const Lock lock(mutex_);
        position_.breakpoints = paths;
        return type::Value();
      },
      without_value(std::move(done)), false);
}

void RunControl::go_on_at(std::string path, Done done) {
  ask([path = std::move(path)](mission::Engine& engine) { return as_value(engine.go_on_at(path)); },
      without_value(std::move(done)), true);
}

void RunControl::values_of(std::string path, std::function<void(Result<type::Value>)> done) {
  ask([path = std::move(path)](mission::Engine& engine) { return engine.values_of(path); }, std::move(done),
      false);
}

RunControl::Position RunControl::position() const {
  const Lock lock(mutex_);
  return position_;
}

std::optional<Error> RunControl::refusal() const {
  if (!run_) return fail(ErrorCode::InvalidState, "the mission does not run");
  if (run_->engine != nullptr) return std::nullopt;
  return fail(ErrorCode::Unsupported,
              "a concurrent run can be paused, resumed and stopped only; run the mission with --mode "
              "sequential to step it");
}

/// `moves`: what is carried out changes where the mission is.
void RunControl::ask(Task task, Answer answer, bool moves) {
  Lock lock(mutex_);
  if (auto refused = refusal()) {
    lock.unlock();
    return answer(std::move(*refused));
  }
  const std::uint64_t number = ++asked_;
  waiting_.emplace(number, std::move(answer));
  run_->engine->post([this, number, engine = run_->engine, task = std::move(task), moves] {
    carry_out(number, *engine, task, moves);
  });
}

/// On the engine's thread. Whoever has the answer sees no position of before.
void RunControl::carry_out(std::uint64_t number, mission::Engine& engine, const Task& task, bool moves) {
  Result<type::Value> answer = task(engine);
  Answer whom;
  {
    const Lock lock(mutex_);
    if (moves && answer) position_.at.reset();
    if (auto found = waiting_.extract(number)) whom = std::move(found.mapped());
  }
  if (whom) whom(std::move(answer));
}

RunControl::Attachment::Attachment(RunControl* control, Run run) : control_(control) {
  if (control_ == nullptr) return;
  const Lock lock(control_->mutex_);
  control_->position_ = {run.engine != nullptr, run.back, std::nullopt, run.breakpoints};
  control_->run_ = std::move(run);
  control_->resuming_ = 0;
  if (control_->pause_requested_) control_->follow_request();
}

RunControl::Attachment::~Attachment() {
  if (control_ == nullptr) return;
  std::map<std::uint64_t, Answer> unanswered;
  {
    const Lock lock(control_->mutex_);
    control_->run_.reset();
    control_->position_ = {};
    unanswered = std::exchange(control_->waiting_, {});
  }
  for (const auto& [number, answer] : unanswered)
    answer(fail(ErrorCode::InvalidState, "the mission has ended"));
}

bool RunControl::Attachment::held_at(std::vector<std::string> paths) {
  if (control_ == nullptr) return true;
  const Lock lock(control_->mutex_);
  if (control_->resuming_ > 0) return false;  // it is about to leave that place
  if (control_->position_.at == paths) return false;
  control_->position_.at = std::move(paths);
  return true;
}

}  // namespace segue::mission_run
