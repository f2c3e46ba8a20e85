// SPDX-License-Identifier: Apache-2.0
#include <segue/base/mutex.hpp>
#include <segue/mission/enclosing_scope.hpp>
#include <segue/mission_robot/observing_runner.hpp>

#include <segue/base/question.hpp>
#include <segue/base/text.hpp>
#include <segue/base/time_after.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

namespace {

using type::Value;

TimePoint clock_now() {
  return RealClock::instance().now();
}

std::string signed_text(const GroundFact& fact) {
  return (fact.holds ? "" : "!") + fact.text;
}

/// One execution, which is watched until it has ended and its effects have shown. Shared by the runner that
/// carries it out, the engine, and the observer; each calls it on a thread of its own. Uses the observer, but
/// for its bell, on that one's thread only, which ends before the observer does.
class ObservedRun {
 public:
  ObservedRun(FactObserver& observer, const ActionCall& call)
      : observer_(observer),
        bell_(observer.bell()),
        during_(call.observed()->during),
        effects_(call.observed()->effects),
        foreseen_(call.outcome(call.action().foreseen_outcome()).value_or(kAborted)) {}

  /// The inner runner goes on, and the engine waits for `complete`.
  void goes_on(std::function<void()> preempt, Completer complete) {
    const Lock lock(mutex_);
    preempt_ = std::move(preempt);
    complete_ = std::move(complete);
  }

  /// The execution ends by itself at that time.
  void ends_at(TimePoint when, Ending ending, std::vector<Value> outputs) {
    const Lock lock(mutex_);
    due_ = when;
    ending_ = std::move(ending);
    outputs_ = std::move(outputs);
  }

  /// The engine preempts it.
  void preempt() {
    Then then;
    {
      const Lock lock(mutex_);
      preempted_ = true;
      then = confirms_ || due_ ? end({kPreempted, {}}) : std::exchange(preempt_, nullptr);
    }
    if (then) then();
  }

  /// The inner runner has ended it.
  void ended(Ending ending, std::vector<Value> outputs) {
    Then then;
    {
      const Lock lock(mutex_);
      outputs_ = std::move(outputs);
      then = finish(std::move(ending));
    }
    if (then) then();
  }

  /// The time when it is to be called again at the latest; nothing once it has ended. On the observer's
  /// thread.
  std::optional<TimePoint> poll() {
    const TimePoint now = clock_now();
    Then then;
    bool is_guarded = false;
    bool confirms = false;
    {
      const Lock lock(mutex_);
      if (is_over_) return std::nullopt;
      if (due_ && now >= *due_) {
        due_.reset();
        then = finish(ending_);
      }
      is_guarded = lost_.empty() && !preempted_;
      confirms = confirms_;
    }
    if (then) {
      then();
      return std::nullopt;
    }
    if (confirms) {
      confirm(now);
    } else if (is_guarded) {
      guard();
    }
    const Lock lock(mutex_);
    return is_over_ ? std::nullopt : std::optional(next_poll(now));
  }

 private:
  /// A function to call once the mutex is free again: the inner runner, or the caller's completion. May be
  /// empty.
  using Then = std::function<void()>;

  /// Preempts the action when a fact of its `while` does not hold any more.
  void guard() {
    if (during_.empty()) return;
    const auto lacking = observer_.first_false(during_);
    if (!lacking) return;
    Then then;
    {
      const Lock lock(mutex_);
      if (is_over_ || confirms_ || preempted_) return;
      lost_ = "it was preempted, since " + signed_text(*lacking) + " does not hold any more";
      then = due_ ? end({kAborted, lost_}) : std::exchange(preempt_, nullptr);
    }
    if (then) then();
  }

  /// Ends it once all effects show, or one has not in time, which is `now`.
  void confirm(TimePoint now) {
    std::vector<GroundFact> unknown;
    std::optional<GroundFact> differs;
    for (const GroundFact& effect : effects_) {
      const auto seen = observer_.observed(effect.text);
      if (!seen) unknown.push_back(effect);
      if (seen && *seen != effect.holds && !differs) differs = effect;
    }
    Then then;
    {
      const Lock lock(mutex_);
      if (is_over_) return;
      const auto is_late = [&](const GroundFact& effect)
                               SEGUE_REQUIRES(mutex_) { return now >= settled_at(effect); };
      if (differs && !is_late(*differs)) return;
      if (!differs && !std::ranges::all_of(unknown, is_late)) return;
      if (differs) then = end({kAborted, difference(*differs)});
    }
    if (!then) {
      observer_.assume(unknown);
      const Lock lock(mutex_);
      if (!is_over_) then = end(ending_);
    }
    if (then) then();
  }

  /// When something happens after `now` although no fact changes.
  [[nodiscard]] TimePoint next_poll(TimePoint now) const SEGUE_REQUIRES(mutex_) {
    TimePoint next = due_.value_or(TimePoint::max());
    for (const GroundFact& effect : effects_) {
      const TimePoint settled = settled_at(effect);
      if (confirms_ && settled > now) next = std::min(next, settled);
    }
    return next;
  }
  [[nodiscard]] TimePoint settled_at(const GroundFact& effect) const SEGUE_REQUIRES(mutex_) {
    return time_after(confirms_since_, observer_.settle(effect.text)).value_or(TimePoint::max());
  }

  [[nodiscard]] std::string difference(const GroundFact& effect) const {
    return "expected " + signed_text(effect) + ", which did not become true within " +
           format_duration(observer_.settle(effect.text));
  }

  Then finish(Ending ending) SEGUE_REQUIRES(mutex_) {
    if (!lost_.empty()) return end({kAborted, lost_});
    if (preempted_ || effects_.empty() || ending.outcome != foreseen_) return end(std::move(ending));
    ending_ = std::move(ending);
    confirms_ = true;
    confirms_since_ = clock_now();
    bell_->ring();
    return {};
  }

  /// The function to call once the mutex is free again; never empty.
  Then end(Ending ending) SEGUE_REQUIRES(mutex_) {
    is_over_ = true;
    return [complete = std::exchange(complete_, nullptr), ending = std::move(ending),
            outputs = std::move(outputs_)] {
      if (complete) complete(ending, outputs);
    };
  }

  FactObserver& observer_;
  const std::shared_ptr<Bell> bell_;
  const std::vector<GroundFact> during_;
  const std::vector<GroundFact> effects_;
  const Outcome foreseen_;
  Mutex mutex_;  ///< protects all below
  std::function<void()> preempt_ SEGUE_GUARDED_BY(mutex_);
  Completer complete_ SEGUE_GUARDED_BY(mutex_);
  std::optional<TimePoint> due_ SEGUE_GUARDED_BY(mutex_);
  Ending ending_ SEGUE_GUARDED_BY(mutex_);
  std::vector<Value> outputs_ SEGUE_GUARDED_BY(mutex_);
  std::string lost_ SEGUE_GUARDED_BY(mutex_);  ///< why it has been preempted
  bool preempted_ SEGUE_GUARDED_BY(mutex_) = false;
  bool confirms_ SEGUE_GUARDED_BY(mutex_) = false;  ///< it has ended as foreseen, and its effects are awaited
  TimePoint confirms_since_ SEGUE_GUARDED_BY(mutex_){};
  bool is_over_ SEGUE_GUARDED_BY(mutex_) = false;
};

/// The call as the inner runner sees it: its end is that of an ObservedRun.
class ObservedCall final : public ActionCall {
 public:
  ObservedCall(ActionCall& call, std::shared_ptr<ObservedRun> run) : call_(call), run_(std::move(run)) {}

  [[nodiscard]] StateIndex state() const override { return call_.state(); }
  [[nodiscard]] const Program& program() const override { return call_.program(); }
  [[nodiscard]] std::string path() const override { return call_.path(); }
  [[nodiscard]] std::span<const Value> inputs() const override { return call_.inputs(); }
  [[nodiscard]] std::span<Value> outputs() override { return call_.outputs(); }
  [[nodiscard]] Globals& globals() const override { return call_.globals(); }
  [[nodiscard]] bool may_be_discarded() const override { return call_.may_be_discarded(); }
  [[nodiscard]] const std::string& error_before() const override { return call_.error_before(); }
  [[nodiscard]] std::span<const BranchResult> branches() const override { return call_.branches(); }
  [[nodiscard]] std::uint64_t iteration() const override { return call_.iteration(); }
  [[nodiscard]] bool backward() const override { return call_.backward(); }
  [[nodiscard]] const Value& progress() const override { return call_.progress(); }
  [[nodiscard]] std::function<void(const Value&)> recorder() const override { return call_.recorder(); }

  Completer defer(std::function<void()> preempt) override {
    run_->goes_on(std::move(preempt), call_.defer([run = run_] { run->preempt(); }));
    return [run = run_](Ending ending, std::vector<Value> outputs) {
      run->ended(std::move(ending), std::move(outputs));
    };
  }
  void end_after(Duration duration, Ending ending) override {
    const auto when = time_after(clock_now(), duration);
    if (!when) ending = {kAborted, when.error().message};
    run_->ends_at(when.value_or(clock_now()), std::move(ending), {outputs().begin(), outputs().end()});
    defer(nullptr);
  }

 private:
  /// Asked only for actions that declare to read the world, which have it.
  [[nodiscard]] WorldView look_at_world() const override { return *call_.world(); }

  ActionCall& call_;
  const std::shared_ptr<ObservedRun> run_;
};

}  // namespace

std::optional<Ending> ObservingRunner::start(ActionCall& call) {
  const ObservedNeeds* observed = call.observed();
  if (observed == nullptr || call.backward()) return inner_->start(call);
  const bool begins = call.progress().is_null();
  const auto lacking = begins ? observer_->first_false(observed->preconditions) : std::nullopt;
  if (lacking) return Ending{kAborted, precondition_error(*lacking)};
  if (observed->during.empty() && observed->effects.empty()) return inner_->start(call);
  const auto run = std::make_shared<ObservedRun>(*observer_, call);
  ObservedCall watched(call, run);
  if (auto ending = inner_->start(watched)) {
    if (observed->effects.empty()) return ending;
    const auto completer = watched.defer(nullptr);
    completer(std::move(*ending), {call.outputs().begin(), call.outputs().end()});
  }
  observer_->watch([run] { return run->poll(); });
  return std::nullopt;
}

}  // namespace segue::mission
