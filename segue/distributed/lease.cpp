// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/lease.hpp>

#include <segue/base/file.hpp>
#include <segue/base/printable.hpp>
#include <segue/base/rounded_text.hpp>
#include <segue/base/secret.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <tuple>
#include <utility>

namespace segue::distributed {

namespace {

Error closed(const std::string& robot) {
  return fail(ErrorCode::Unavailable, "the daemon of this host has ended", robot);
}

}  // namespace

Lease::Lease(std::string robot, std::filesystem::path file, const Clock& clock)
    : robot_(std::move(robot)),
      file_(std::move(file)),
      clock_(clock),
      last_(read(file_)),
      first_of_last_(last_.epoch) {
  if (last_.is_held) {
    until_ = clock_.now() + kValidity;
  }
}

Duration Lease::left() const {
  return holder_.empty() ? Duration(0) : std::max(Duration(0), until_ - clock_.now());
}

/// Lines: the epoch, who had it last ("held" or "released"), the key, the name, the term, the highest term.
Lease::Kept Lease::read(const std::filesystem::path& file) {
  Kept kept;
  const auto text = read_file(file, 4096);
  if (!text) {
    return kept;
  }
  std::istringstream lines(*text);
  const auto next_line = [&] {
    std::string line;
    std::getline(lines, line);
    return line;
  };
  const auto next_number = [&](std::uint64_t& number) {
    const std::string line = next_line();
    std::from_chars(line.data(), line.data() + line.size(), number);
  };
  next_number(kept.epoch);
  kept.is_held = next_line() == "held";
  kept.key = next_line();
  kept.holder = next_line();
  next_number(kept.term);
  next_number(kept.highest_term);
  return kept;
}

Result<void> Lease::keep(const Kept& kept) const {
  const std::string text = std::to_string(kept.epoch) + (kept.is_held ? "\nheld\n" : "\nreleased\n") +
                           kept.key + "\n" + printable(kept.holder.substr(0, 256)) + "\n" +
                           std::to_string(kept.term) + "\n" + std::to_string(kept.highest_term) + "\n";
  if (auto written = write_private_file(file_, text); !written) {
    return fail(ErrorCode::IoError, "cannot keep the epoch of its lease", robot_).because_of(written.error());
  }
  return {};
}

bool Lease::is_of_last(const Claim& claim) const {
  return !claim.key.empty() && equal_secrets(claim.key, last_.key);
}

std::optional<Error> Lease::refusal_of_take_over(const Claim& claim) const {
  const auto rank = [](const auto& of) { return std::tie(of.term, of.holder, of.key); };
  if (!is_wanted() || rank(claim) > rank(last_)) {
    return std::nullopt;
  }
  return fail(ErrorCode::Superseded,
              "runtime " + quote(last_.holder) + " has taken this robot over at the same moment", robot_);
}

std::optional<Error> Lease::refusal_of(const Claim& claim) const {
  if (is_of_last(claim)) {
    return std::nullopt;
  }
  if (claim.take_over) {
    return refusal_of_take_over(claim);
  }
  if (claim.again && last_.epoch > 0) {
    return fail(ErrorCode::Superseded, "runtime " + quote(last_.holder) + " has got this robot since",
                robot_);
  }
  const Duration remaining = until_ - clock_.now();
  if (remaining <= Duration(0)) {
    return std::nullopt;
  }
  return fail(ErrorCode::AlreadyExists,
              "runtime " + quote(last_.holder) + " commands this robot, for another " +
                  format_seconds(remaining) + " at least; wait until it has ended, or take it over",
              robot_);
}

Result<std::uint64_t> Lease::acquire(const Claim& claim, TimePoint deadline) {
  Lock lock(mutex_);
  if (closed_) {
    return closed(robot_);
  }
  if (auto refusal = refusal_of(claim)) {
    return std::move(*refusal);
  }
  // Whatever was begun under the former epoch ends before anything begins under the new one.
  const std::uint64_t mine = last_.epoch + 1;
  const Kept kept{mine, claim.key, claim.holder, true, claim.term, std::max(last_.highest_term, claim.term)};
  if (auto written = keep(kept); !written) {
    return written.error();
  }
  first_of_last_ = is_of_last(claim) ? first_of_last_ : mine;
  last_ = kept;
  holder_.clear();
  until_ = {};
  const Duration limit = std::max(Duration(0), deadline - RealClock::instance().now());
  ++waiting_;
  const bool is_idle = idle_.wait_for(mutex_, limit, [&]() SEGUE_REQUIRES(mutex_) { return working_ == 0; });
  --waiting_;
  if (!is_idle) {
    return fail(ErrorCode::DeadlineExceeded, "actions that the former runtime had begun have not ended",
                robot_);
  }
  if (closed_) {
    return closed(robot_);
  }
  if (mine != last_.epoch) {
    return refusal_of_epoch(mine);
  }
  holder_ = claim.holder;
  until_ = clock_.now() + kValidity;
  return mine;
}

Result<void> Lease::renew(std::uint64_t epoch) {
  const Lock lock(mutex_);
  if (closed_ || epoch != last_.epoch || holder_.empty()) {
    return refusal_of_epoch(epoch);
  }
  until_ = clock_.now() + kValidity;
  return {};
}

Result<void> Lease::release(std::uint64_t epoch) {
  const Lock lock(mutex_);
  if (closed_ || epoch != last_.epoch) {
    return refusal_of_epoch(epoch);
  }
  if (!std::exchange(holder_, {}).empty()) {
    until_ = {};
    last_.is_held = false;
    (void)keep(last_);  // otherwise others wait a little after a restart
  }
  return {};
}

void Lease::close() {
  Lock lock(mutex_);
  closed_ = true;
  holder_.clear();
  idle_.wait(mutex_, [&]() SEGUE_REQUIRES(mutex_) { return working_ == 0; });
}

LeaseInfo Lease::info() const {
  const Lock lock(mutex_);
  return {robot_, holder_, last_.epoch, left()};
}

std::uint64_t Lease::highest_term() const {
  const Lock lock(mutex_);
  return last_.highest_term;
}

Error Lease::refusal(std::uint64_t epoch) const {
  const Lock lock(mutex_);
  return refusal_of_epoch(epoch);
}

Error Lease::refusal_of_epoch(std::uint64_t epoch) const {
  if (closed_) {
    return closed(robot_);
  }
  if (epoch < first_of_last_) {
    return fail(ErrorCode::Superseded,
                "runtime " + quote(last_.holder) + " has got this robot (epoch " +
                    std::to_string(last_.epoch) + ", not " + std::to_string(epoch) + ")",
                robot_);
  }
  return fail(ErrorCode::Unavailable,
              epoch < last_.epoch ? "the runtime has got the robot anew meanwhile" : "the lease was given up",
              robot_);
}

Lease::Work::Work(Lease& lease, std::uint64_t epoch) : lease_(nullptr) {
  const Lock lock(lease.mutex_);
  if (epoch == lease.last_.epoch && !lease.holder_.empty()) {
    ++lease.working_;
    lease_ = &lease;
  }
}

Lease::Work::~Work() {
  if (lease_ == nullptr) {
    return;
  }
  const Lock lock(lease_->mutex_);
  if (--lease_->working_ == 0) {
    lease_->idle_.notify_all();
  }
}

}  // namespace segue::distributed
