// SPDX-License-Identifier: Apache-2.0
#include <segue/concurrent/thread.hpp>
#include <segue/mission_robot/controller_union.hpp>

#include <algorithm>
#include <utility>

namespace segue::mission {

ControllerUnion::ControllerUnion(std::shared_ptr<CommandedRobot> robot, Options options)
    : robot_(std::move(robot)),
      options_(options),
      thread_(concurrent::start_stoppable_thread("segue-union",
                                                 [this](const std::stop_token& end) { work(end); })) {}

ControllerUnion::~ControllerUnion() {
  const Lock lock(mutex_);
  thread_.request_stop();
  unwanted_.request_stop();
}

Result<void> ControllerUnion::begin(const std::string& controller, std::vector<MemberValue> properties,
                                    ControllerWish wish) {
  if (wish.stop.stop_requested()) return no_longer_wanted();
  const TimePoint now = RealClock::instance().now();
  if (use_what_runs(controller, properties, now - options_.fresh)) return {};
  if (may_run(controller, properties) && runs_well(controller, Wait(now + options_.deadline, wish.stop)) &&
      use_what_runs(controller, properties, now))
    return {};
  return carry_out({{controller, std::move(properties), 1}, false, std::move(wish)});
}

bool ControllerUnion::may_run(const std::string& controller, const std::vector<MemberValue>& properties) {
  const Lock lock(mutex_);
  return find_undisturbed(controller, properties) != members_.end();
}

/// The member that was requested with these properties, if no controller that is only kept changes what it
/// does; otherwise end().
ControllerUnion::Members::iterator ControllerUnion::find_undisturbed(
    const std::string& controller, const std::vector<MemberValue>& properties) {
  const auto known = find(controller);
  if (!has_lease_ || known == members_.end() || known->properties != properties) return members_.end();
  const bool is_disturbed = std::ranges::any_of(members_, [&](const Member& member) SEGUE_REQUIRES(mutex_) {
    return member.users == 0 && member.controller != controller && disturbs(member.controller, controller);
  });
  return is_disturbed ? members_.end() : known;
}

bool ControllerUnion::runs_well(const std::string& controller, const Wait& wait) {
  const TimePoint asked = RealClock::instance().now();
  const auto trouble = robot_->trouble(controller, wait);
  if (!trouble || !trouble->runs_well()) return false;
  note_runs(controller, asked, asked);
  return true;
}

/// Uses the controller without a request if it was seen to run with these properties, not before `earliest`,
/// and no other transition is about to begin.
bool ControllerUnion::use_what_runs(const std::string& controller, const std::vector<MemberValue>& properties,
                                    TimePoint earliest) {
  const Lock lock(mutex_);
  const auto known = find_undisturbed(controller, properties);
  const bool runs = known != members_.end() && known->seen >= earliest && known->seen > changed_at_ &&
                    waiting_.empty() && served_.empty();
  if (!runs) return false;
  ++known->users;
  members_.splice(members_.begin(), members_, known);
  return true;
}

void ControllerUnion::take_over(const std::string& controller, std::vector<MemberValue> properties) {
  const Lock lock(mutex_);
  const auto found = find(controller);
  if (found == members_.end())
    members_.push_back({controller, std::move(properties), 1});
  else
    ++found->users;
}

Result<void> ControllerUnion::end(const std::string& controller, bool keep,
                                  std::optional<ControllerUser> user) {
  {
    const Lock lock(mutex_);
    const auto found = find(controller);
    if (found == members_.end()) return {};
    if (found->users > 0) --found->users;
    if (keep || found->users > 0) return {};
  }
  return carry_out({{controller, {}, 0}, true, {.user = std::move(user)}});
}

void ControllerUnion::note_runs(const std::string& controller, TimePoint asked, TimePoint seen) {
  const Lock lock(mutex_);
  const auto found = find(controller);
  if (found != members_.end() && asked > changed_at_) found->seen = seen;
}

void ControllerUnion::note_changed() {
  const Lock lock(mutex_);
  changed_at_ = RealClock::instance().now();
}

ControllerUnion::Members::iterator ControllerUnion::find(const std::string& controller) {
  return std::ranges::find(members_, controller, &Member::controller);
}

std::size_t ControllerUnion::waiting() const {
  const Lock lock(mutex_);
  return waiting_.size();
}

Result<void> ControllerUnion::carry_out(Change change) {
  const auto mine = std::make_shared<Change>(std::move(change));
  const Lock lock(mutex_);
  if (mine->wish.stop.stop_requested()) return no_longer_wanted();
  waiting_.push_back(mine);
  changed_.notify_all();
  changed_.wait(mutex_, mine->wish.stop, [&]() SEGUE_REQUIRES(mutex_) { return mine->outcome.has_value(); });
  if (mine->outcome) return *mine->outcome;
  withdraw(mine);
  return no_longer_wanted();
}

void ControllerUnion::withdraw(const std::shared_ptr<Change>& change) {
  std::erase(waiting_, change);
  const bool is_served = std::ranges::find(served_, change) != served_.end();
  if (is_served && std::ranges::none_of(served_, [](const auto& one) { return one->is_wanted(); }))
    unwanted_.request_stop();
}

void ControllerUnion::work(const std::stop_token& end) {
  const Lock lock(mutex_);
  while (changed_.wait(mutex_, end, [this]() SEGUE_REQUIRES(mutex_) { return !waiting_.empty(); })) {
    // Others may join in a transition; what runs already must not wait for it.
    if (std::ranges::any_of(
            waiting_, [this](const auto& change) SEGUE_REQUIRES(mutex_) { return is_transition(*change); }))
      changed_.wait_for(mutex_, end, options_.gather, []() SEGUE_REQUIRES(mutex_) { return false; });
    if (end.stop_requested()) return;
    learn_conflicts(end);
    serve_waiting();
  }
}

/// Whether the robot does not run that yet, as far as is known here.
bool ControllerUnion::is_transition(const Change& change) const {
  const auto same = std::ranges::find(members_, change.member.controller, &Member::controller);
  if (change.stop) return same != members_.end() && same->users == 0;
  return same == members_.end() || same->properties != change.member.properties;
}

void ControllerUnion::serve_waiting() {
  Changes changes = std::exchange(waiting_, {});
  std::erase_if(changes, [](const auto& change) { return !change->is_wanted(); });
  if (changes.empty()) return;
  const auto together = serve(changes);
  for (const auto& change : changes) {
    // One that cannot be carried out must not keep the others from what they need.
    const bool again = !together && changes.size() > 1 && change->is_wanted();
    const auto outcome = again ? serve({change}) : together;
    change->outcome = change->given_up ? no_longer_wanted() : outcome;
    changed_.notify_all();
  }
}

Result<void> ControllerUnion::serve(const Changes& changes) {
  Members wanted = with(changes);
  auto outcome = request(wanted, changes);
  for (const auto& change : changes)
    change->given_up = !change->is_wanted();
  if (outcome) {
    // Actions may have ended while the robot was asked.
    for (Member& member : wanted) {
      const auto before = std::ranges::find(members_, member.controller, &Member::controller);
      if (before != members_.end()) member.users = before->users;
    }
    for (const auto& change : changes) {
      const auto found = std::ranges::find(wanted, change->member.controller, &Member::controller);
      if (!change->stop && !change->given_up && found != wanted.end()) ++found->users;
    }
    members_ = std::move(wanted);
  }
  if (outcome || outcome.error().code == ErrorCode::Cancelled) stop_unwanted(changes);
  return outcome;
}

/// The robot may run what was wanted no longer when it was asked for it already.
void ControllerUnion::stop_unwanted(const Changes& changes) {
  for (const auto& change : changes) {
    if (change->stop || !change->given_up || change->wish.keep) continue;
    waiting_.push_back(std::make_shared<Change>(
        Change{{change->member.controller, {}, 0}, true, {.user = change->wish.user}}));
  }
}

/// The members that are in use or requested by the changes, and of the kept ones all that fit, the latest
/// first.
ControllerUnion::Members ControllerUnion::with(const Changes& changes) const {
  Members wanted;
  const auto is_changed = [&](const Member& member) {
    return std::ranges::any_of(changes, [&](const auto& change) {
      return change->member.controller == member.controller && (!change->stop || member.users == 0);
    });
  };
  for (const auto& change : changes) {
    const auto same = std::ranges::find(wanted, change->member.controller, &Member::controller);
    if (!change->stop && same == wanted.end())
      wanted.push_back({change->member.controller, change->member.properties, 0});
  }
  for (const Member& member : members_) {
    if (member.users > 0 && !is_changed(member)) wanted.push_back(member);
  }
  for (const Member& member : members_) {
    if (member.users == 0 && !is_changed(member) && fits(member.controller, wanted)) wanted.push_back(member);
  }
  return wanted;
}

/// Whether what is kept can run on beside these without changing what they do.
bool ControllerUnion::fits(const std::string& controller, const Members& members) const {
  return std::ranges::none_of(members, [&](const Member& member) SEGUE_REQUIRES(mutex_) {
    return disturbs(controller, member.controller);
  });
}

/// Whether a kept controller changes what a used one does; assumed where it is not known which can run at
/// once.
bool ControllerUnion::disturbs(const std::string& kept, const std::string& used) const {
  return !conflicts_ || conflicts_->conflict(kept, used) || conflicts_->influence(kept, used);
}

Result<void> ControllerUnion::request(const Members& members, const Changes& changes) {
  ControllerRequest what;
  for (const Member& member : members) {
    what.controllers.push_back(member.controller);
    what.properties.insert(what.properties.end(), member.properties.begin(), member.properties.end());
  }
  for (const auto& change : changes) {
    if (const auto& user = change->wish.user)
      what.causes.push_back({user->action, user->iteration, change->stop ? "" : change->member.controller});
  }
  served_ = changes;
  changed_at_ = RealClock::instance().now();
  unwanted_ = {};
  if (thread_.get_stop_token().stop_requested()) unwanted_.request_stop();
  const Wait wait(RealClock::instance().now() + options_.deadline, unwanted_.get_token());
  auto outcome = [&]() SEGUE_REQUIRES(mutex_) {
    const Unlocked unlocked(mutex_);
    return robot_->request(what, wait);
  }();
  served_.clear();
  changed_at_ = RealClock::instance().now();  // what was seen meanwhile may be what ran before
  has_lease_ = has_lease_ || outcome;
  return outcome;
}

void ControllerUnion::learn_conflicts(const std::stop_token& end) {
  if (conflicts_) return;
  auto conflicts = [&]() SEGUE_REQUIRES(mutex_) {
    const Unlocked unlocked(mutex_);
    return robot_->conflicts(Wait(TimePoint::max(), end));
  }();
  if (conflicts) conflicts_ = std::move(*conflicts);
}

}  // namespace segue::mission
