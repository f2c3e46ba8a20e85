// SPDX-License-Identifier: Apache-2.0
#include <segue/runtime/leases.hpp>

#include <segue/base/secret.hpp>

#include <utility>

namespace segue::runtime::detail {

Result<std::uint64_t> Leases::take(std::string holder) {
  const Lock lock(mutex_);
  if (held_) {
    return fail(ErrorCode::InvalidState, "the robot is commanded by " + held_->holder);
  }
  held_ = Lease{.number = random_number(), .holder = std::move(holder)};
  missions_.begin(held_->holder);
  log_.add(EventKind::Lease, "", held_->holder + " commands the robot");
  return held_->number;
}

std::optional<Leases::Holder> Leases::holder_of(std::uint64_t number) const {
  const Lock lock(mutex_);
  return is_holder(number) ? present_holder() : std::nullopt;
}

std::optional<Leases::Holder> Leases::holder() const {
  const Lock lock(mutex_);
  return present_holder();
}

std::optional<Leases::Holder> Leases::present_holder() const {
  if (!held_) {
    return std::nullopt;
  }
  const auto says = [this](std::string_view key, std::string_view what) SEGUE_REQUIRES(mutex_) {
    const type::Value* said = held_->doing.find(key);
    return said != nullptr && *said == type::Value(what);
  };
  return Holder{held_->holder, held_->number, says("at_end", "keep"), says("at_stop", "halt"),
                held_->is_stopped};
}

void Leases::stop(std::uint64_t number) {
  const Lock lock(mutex_);
  if (is_holder(number) && !std::exchange(held_->is_stopped, true)) {
    log_.add(EventKind::Lease, "", held_->holder + " is stopped, and commands nothing any more");
    changes_.add();
  }
}

void Leases::end(std::uint64_t number) {
  const Lock lock(mutex_);
  if (is_holder(number)) {
    log_.add(EventKind::Lease, "", held_->holder + " no longer commands the robot");
    missions_.end("whoever ran it gave the robot back without saying how it ended");
    held_.reset();
    changes_.add();
  }
}

void Leases::take_away(const std::string& by) {
  const Lock lock(mutex_);
  if (!held_) {
    return;
  }
  log_.add(EventKind::Lease, "", by + ", took the robot from " + held_->holder);
  lose(by, "the robot was taken from it by " + by);
}

void Leases::lose(const std::string& to, const std::string& how) {
  missions_.end(how);
  lost_ = Lease{.number = held_->number, .holder = to};
  held_.reset();
  changes_.add();
}

control::LeaseStanding Leases::standing_of(std::uint64_t number) const {
  const Lock lock(mutex_);
  if (is_holder(number)) {
    return {std::nullopt, held_->is_stopped};
  }
  return {who_took(number).value_or(""), false};
}

std::optional<std::string> Leases::who_took(std::uint64_t number) const {
  return lost_ && lost_->number == number ? std::optional(lost_->holder) : std::nullopt;
}

std::optional<Error> Leases::refusal_of(std::uint64_t lease) const {
  const Lock lock(mutex_);
  return why_refused(lease);
}

Result<void> Leases::report(std::uint64_t number, type::Value doing) {
  const Lock lock(mutex_);
  if (!is_holder(number)) {
    return fail(ErrorCode::InvalidState, "the robot is not commanded with that lease any more");
  }
  missions_.take(doing);
  held_->doing = std::move(doing);
  return {};
}

type::Value Leases::doing() const {
  const Lock lock(mutex_);
  return held_ ? held_->doing : type::Value();
}

type::Value Leases::mission(std::uint64_t after, bool with_plan, bool halts, bool halts_after) {
  const Lock lock(mutex_);
  if (held_ && with_plan && !missions_.recent().has_whole_plan()) held_->shall_show_plan = true;
  return missions_.recent().to_value(after, with_plan, held_ ? held_->doing : type::Value(),
                                     halts || (halts_after && held_));
}

Result<std::uint64_t> Leases::ask(std::string_view what, const type::Value& arguments) {
  const Lock lock(mutex_);
  if (!held_) {
    return fail(ErrorCode::NotFound, "nobody commands the robot");
  }
  return held_->inbox.put(what, arguments);
}

std::vector<control::HolderRequest> Leases::take_commands(std::uint64_t number) {
  const Lock lock(mutex_);
  if (!is_holder(number)) return {};
  auto asked = held_->inbox.take();
  if (std::exchange(held_->shall_show_plan, false)) asked.push_back({0, "plan", {}});
  return asked;
}

std::optional<Error> Leases::refusal_of(const RequestOptions& options) const {
  const Lock lock(mutex_);
  if (auto refused = why_refused(options.lease)) {
    return refused;
  }
  if (!held_ || is_holder(options.lease) || options.take_over) {
    return std::nullopt;
  }
  return fail(ErrorCode::InvalidState, "the robot is commanded by " + held_->holder +
                                           "; wait until that has ended, or take the robot over "
                                           "(--take-over), which ends what it is doing");
}

std::optional<Error> Leases::why_refused(std::uint64_t lease) const {
  if (lease == 0) {
    return std::nullopt;
  }
  if (is_holder(lease)) {
    return held_->is_stopped ? std::optional(fail(ErrorCode::Cancelled, "the mission is being stopped"))
                             : std::nullopt;
  }
  const std::string who = who_took(lease).value_or("");
  return fail(ErrorCode::InvalidState, "the robot was taken over" + (who.empty() ? who : " by " + who));
}

Result<void> Leases::allow(const Sender& sender, const std::string& what) {
  const Lock lock(mutex_);
  if (auto refused = why_refused(sender.lease)) {
    return std::move(*refused);
  }
  if (!held_ || is_holder(sender.lease)) {
    return {};
  }
  if (!sender.beside_mission) {
    return fail(ErrorCode::InvalidState, "the robot is commanded by " + held_->holder +
                                             "; wait until that has ended, or do it beside that "
                                             "(--beside-mission)");
  }
  const std::string who = sender.who.empty() ? "somebody" : sender.who;
  log_.add(EventKind::Lease, "", who + " " + what + ", beside what " + held_->holder + " does");
  return {};
}

bool Leases::would_take_over(const RequestOptions& options) const {
  const Lock lock(mutex_);
  return takes_over(options);
}

void Leases::take_over(const RequestOptions& options) {
  const Lock lock(mutex_);
  if (!takes_over(options)) {
    return;
  }
  const std::string who = options.who.empty() ? "a request" : options.who;
  log_.add(EventKind::Lease, "", who + " took the robot over from " + held_->holder);
  lose(options.who, "the robot was taken over by " + who);
}

}  // namespace segue::runtime::detail
