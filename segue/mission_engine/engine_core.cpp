// SPDX-License-Identifier: Apache-2.0
#include <segue/mission_engine/engine_core.hpp>

#include <algorithm>

namespace segue::mission::detail {

namespace {

/// Steps after which the next activation that is ready gets its turn.
constexpr int kTurn = 64;

}  // namespace

EngineCore::EngineCore(std::shared_ptr<const Program> program_,
                       std::vector<std::shared_ptr<ActionRunner>> runners_, World world_, Units units_,
                       EngineOptions options_)
    : program(std::move(program_)),
      runners(std::move(runners_)),
      options(std::move(options_)),
      globals(options.part ? options.part->globals : Globals(program->mission().globals)),
      world(std::move(world_)),
      units(std::move(units_)),
      iterations_(options.part ? options.part->iterations
                               : std::make_shared<Iterations>(program->nodes().size())),
      shared_(*program),
      around_root_(options.part ? options.part->around : nullptr),
      virtual_clock_(dynamic_cast<VirtualClock*>(options.clock)) {
  for (const Action& action : program->mission().actions) {
    touches_.push_back(!action.preconditions.empty() || !action.during.empty() || !action.effects.empty() ||
                       !action.resources.empty());
    changes_values_.push_back(!action.changes.empty());
  }
}

void EngineCore::begin() {
  watch_units();
  if (options.part) {
    root_ = make(options.part->state, nullptr);
    root_->shown_as = options.part->shown_as;
    root_->inputs = options.part->inputs;
    root_->error_before = options.part->error_before;
  } else {
    root_ = make(0, nullptr);
    for (const PortSource& supply : program->node(0).inputs)
      root_->inputs.push_back(fallback(supply));
  }
  for (auto& [position, value] : given_inputs)
    root_->inputs[position] = std::move(value);
  ready_.push_back(root_);
}

Engine::Progress EngineCore::run() {
  if (root_ == nullptr) begin();
  while (!ended) {
    if (mailbox->has_messages()) read_messages();
    if (!ready_.empty()) {
      Activation* next = ready_.front();
      ready_.pop_front();
      go_on(next);
    } else if (!ask_again() && !wait() && (!held_.empty() || !give_up_waiting())) {
      at_rest = true;
      return Engine::Progress::Held;
    }
  }
  robot_units_.watched.reset();
  return Engine::Progress::Ended;
}

void EngineCore::go_on(Activation* activation) {
  at_rest = false;
  for (int i = 0; activation != nullptr; ++i) {
    if (i > 0 && mailbox->has_messages()) return ready_.push_front(activation);
    if (i == kTurn) return ready_.push_back(activation);
    activation = step(*activation);
  }
}

Activation* EngineCore::step(Activation& activation) {
  switch (activation.phase) {
    case Activation::Phase::Begin:
      return enter(activation);
    case Activation::Phase::Proceed:
      return proceed(activation);
    case Activation::Phase::Finish:
      return finish(activation);
    case Activation::Phase::Wait:
    case Activation::Phase::Done:
      break;
  }
  return nullptr;
}

/// False if everything that could continue is held, so that only a release can go on.
bool EngineCore::wait() {
  if (replay_next() || begin_postponed() || fire_timers()) return true;
  const bool timed = !timers_.empty();
  if (!timed && open_calls_ == 0 && !awaits_robot()) return mailbox->has_messages();
  if (timed && virtual_clock_ != nullptr && open_calls_ == 0) {
    virtual_clock_->advance(timers_.top().when - now());
    return true;
  }
  std::optional<TimePoint> deadline;
  if (timed && virtual_clock_ == nullptr) deadline = timers_.top().when;
  for (const auto& [when, late] : late_)
    deadline = std::min(deadline.value_or(when), when);
  tell_held();
  mailbox->wait(deadline);
  abandon_late();
  return true;
}

void EngineCore::read_messages() {
  Mailbox::Messages messages = mailbox->take();
  for (CompletionMessage& completion : messages.completions) {
    Activation& activation = *completion.activation;
    if (!activation.deferred || activation.generation != completion.generation) continue;
    if (completion.outputs.size() == activation.outputs.size())
      activation.outputs = std::move(completion.outputs);
    complete(activation, completion.ending);
  }
  if (messages.pause && mode_ == Mode::Run) mode_ = Mode::Hold;
  for (auto& task : messages.tasks) {
    undoing_ ? postponed_tasks_.push_back(std::move(task)) : task();
  }
  if (!messages.stop) return;
  mode_ = Mode::Run;
  breakpoints.clear();
  jump_.reset();
  if (options.journal != nullptr) options.journal->close();
  if (root_ != nullptr) preempt(*root_);
}

bool EngineCore::fire_timers() {
  bool fired = false;
  while (!timers_.empty()) {
    const Timer timer = timers_.top();
    const bool stale = timer.activation->generation != timer.generation;
    if (!stale && timer.when > now()) break;
    timers_.pop();
    if (stale) continue;
    complete(*timer.activation, timer.activation->timed);
    fired = true;
  }
  return fired;
}

void EngineCore::abandon_late() {
  if (late_.empty()) return;
  const TimePoint real = RealClock::instance().now();
  std::erase_if(late_, [&](const auto& late) {
    Activation& activation = *late.second.activation;
    if (activation.generation != late.second.generation) return true;
    if (late.first > real) return false;
    activation.preempted = false;  // it ignored its preemption, which is a failure
    complete(activation, {kAborted, "it was preempted, but went on; given up"});
    return true;
  });
}

void EngineCore::complete(Activation& activation, const Ending& ending) {
  ++activation.generation;
  if (activation.deferred) --open_calls_;
  activation.deferred = false;
  activation.preempt = nullptr;
  check(activation, ending);
  activation.phase = Activation::Phase::Finish;
  ready_.push_back(&activation);
}

void EngineCore::preempt(Activation& root) {
  std::vector<Activation*> open = {&root};
  while (!open.empty()) {
    Activation& activation = *open.back();
    open.pop_back();
    activation.preempted = true;
    open.insert(open.end(), activation.children.begin(), activation.children.end());
    if (activation.held) let_go(activation);
    if (activation.asks) {
      activation.asks = false;
      activation.refused = true;
      end_unit_wait(activation);
      ready_.push_back(leave(activation, kPreempted));
      continue;
    }
    if (is_container(program->node(activation.state).kind) || activation.phase != Activation::Phase::Wait)
      continue;
    if (activation.deferred) {
      late_.emplace_back(RealClock::instance().now() + options.preemption_grace,
                         Timer{{}, 0, &activation, activation.generation});
      if (const auto notify = std::exchange(activation.preempt, nullptr)) notify();
    } else if (program->node(activation.state).kind != StateKind::Library) {
      complete(activation, {kPreempted, {}});
    }
  }
}

}  // namespace segue::mission::detail
