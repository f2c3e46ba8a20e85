// SPDX-License-Identifier: Apache-2.0
#include <segue/mission/controller_union.hpp>

#include <algorithm>
#include <thread>
#include <utility>

namespace segue::mission {

Result<void> ControllerUnion::begin(const std::string& controller, std::vector<MemberValue> properties,
                                    std::optional<ControllerUser> user) {
  return carry_out({{controller, std::move(properties), 1}, false, std::move(user)});
}

void ControllerUnion::take_over(const std::string& controller, std::vector<MemberValue> properties) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find(members_, controller, &Member::controller);
  if (found == members_.end())
    members_.push_back({controller, std::move(properties), 1});
  else
    ++found->users;
}

Result<void> ControllerUnion::end(const std::string& controller, bool keep,
                                  std::optional<ControllerUser> user) {
  {
    const std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(members_, controller, &Member::controller);
    if (found == members_.end()) return {};
    if (found->users > 0) --found->users;
    if (keep || found->users > 0) return {};
  }
  return carry_out({{controller, {}, 0}, true, std::move(user)});
}

/// One of the threads that wait asks for all.
Result<void> ControllerUnion::carry_out(Change change) {
  std::unique_lock lock(mutex_);
  waiting_.push_back(&change);
  while (!change.outcome) {
    if (busy_) {
      changed_.wait(lock);
      continue;
    }
    busy_ = true;
    serve_waiting(lock);
    busy_ = false;
    changed_.notify_all();
  }
  return std::move(*change.outcome);
}

void ControllerUnion::serve_waiting(std::unique_lock<std::mutex>& lock) {
  lock.unlock();
  std::this_thread::sleep_for(options_.gather);
  lock.lock();
  learn_conflicts(lock);
  const std::vector<Change*> changes = std::exchange(waiting_, {});
  serve(changes, lock);
  const bool failed = !*changes.front()->outcome;
  if (!failed || changes.size() == 1) return;
  // One that cannot be carried out must not keep the others from what they need.
  for (Change* change : changes)
    serve({change}, lock);
}

void ControllerUnion::serve(const std::vector<Change*>& changes, std::unique_lock<std::mutex>& lock) {
  Members wanted = with(changes);
  const auto outcome = request(wanted, changes, lock);
  for (Change* change : changes)
    change->outcome = outcome;
  if (!outcome) return;
  // Actions may have ended while the robot was asked.
  for (Member& member : wanted) {
    const auto before = std::ranges::find(members_, member.controller, &Member::controller);
    if (before != members_.end()) member.users = before->users;
  }
  for (const Change* change : changes) {
    const auto found = std::ranges::find(wanted, change->member.controller, &Member::controller);
    if (!change->stop && found != wanted.end()) ++found->users;
  }
  members_ = std::move(wanted);
}

/// What is in use and what the changes want, and of what is kept all that fits, the latest first.
ControllerUnion::Members ControllerUnion::with(const std::vector<Change*>& changes) const {
  Members wanted;
  const auto is_changed = [&](const Member& member) {
    return std::ranges::any_of(changes, [&](const Change* change) {
      return change->member.controller == member.controller && (!change->stop || member.users == 0);
    });
  };
  for (const Change* change : changes) {
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

/// Whether what is kept can run on beside these without changing what they do. Where it is not known what can
/// run at once, nothing does.
bool ControllerUnion::fits(const std::string& controller, const Members& members) const {
  return std::ranges::none_of(members, [&](const Member& member) {
    return !conflicts_ || conflicts_->conflict(controller, member.controller) ||
           conflicts_->influence(controller, member.controller);
  });
}

Result<void> ControllerUnion::request(const Members& members, const std::vector<Change*>& changes,
                                      std::unique_lock<std::mutex>& lock) {
  ControllerRequest what;
  for (const Member& member : members) {
    what.controllers.push_back(member.controller);
    what.properties.insert(what.properties.end(), member.properties.begin(), member.properties.end());
  }
  for (const Change* change : changes) {
    if (const auto& user = change->user)
      what.causes.push_back({user->action, user->iteration, change->stop ? "" : change->member.controller});
  }
  lock.unlock();
  auto outcome = robot_->request(what, RealClock::instance().now() + options_.deadline);
  lock.lock();
  return outcome;
}

void ControllerUnion::learn_conflicts(std::unique_lock<std::mutex>& lock) {
  if (conflicts_) return;
  lock.unlock();
  auto conflicts = robot_->conflicts();
  lock.lock();
  if (conflicts) conflicts_ = std::move(*conflicts);
}

}  // namespace segue::mission
