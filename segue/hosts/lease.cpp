// SPDX-License-Identifier: Apache-2.0
#include <segue/hosts/lease.hpp>

#include <segue/base/file.hpp>
#include <segue/base/printable.hpp>
#include <segue/base/rounded_text.hpp>
#include <segue/base/secret.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <charconv>
#include <sstream>
#include <utility>

namespace segue::hosts {

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

/// Lines: the epoch, who had it last ("held" or "released"), the key, the name.
Lease::Kept Lease::read(const std::filesystem::path& file) {
  Kept kept;
  const auto text = read_file(file, 4096);
  if (!text) {
    return kept;
  }
  std::istringstream lines(*text);
  std::string epoch;
  std::string state;
  std::getline(lines, epoch);
  std::getline(lines, state);
  std::getline(lines, kept.key);
  std::getline(lines, kept.holder);
  std::from_chars(epoch.data(), epoch.data() + epoch.size(), kept.epoch);
  kept.is_held = state == "held";
  return kept;
}

Result<void> Lease::keep(const Kept& kept) const {
  const std::string text = std::to_string(kept.epoch) + (kept.is_held ? "\nheld\n" : "\nreleased\n") +
                           kept.key + "\n" + printable(kept.holder.substr(0, 256)) + "\n";
  if (auto written = write_private_file(file_, text); !written) {
    return fail(ErrorCode::IoError, "cannot keep the epoch of its lease", robot_).because_of(written.error());
  }
  return {};
}

bool Lease::is_of_last(const Claim& claim) const {
  return !claim.key.empty() && equal_secrets(claim.key, last_.key);
}

std::optional<Error> Lease::refusal_of(const Claim& claim) const {
  if (is_of_last(claim) || claim.take_over) {
    return std::nullopt;
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
  std::unique_lock lock(mutex_);
  if (closed_) {
    return closed(robot_);
  }
  if (auto refusal = refusal_of(claim)) {
    return std::move(*refusal);
  }
  // Whatever was begun under the former epoch ends before anything begins under the new one.
  const std::uint64_t mine = last_.epoch + 1;
  const Kept kept{mine, claim.key, claim.holder, true};
  if (auto written = keep(kept); !written) {
    return written.error();
  }
  first_of_last_ = is_of_last(claim) ? first_of_last_ : mine;
  last_ = kept;
  holder_.clear();
  until_ = {};
  const Duration limit = std::max(Duration(0), deadline - RealClock::instance().now());
  if (!idle_.wait_for(lock, limit, [&] { return working_ == 0; })) {
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
  const std::lock_guard lock(mutex_);
  if (closed_ || epoch != last_.epoch || holder_.empty()) {
    return refusal_of_epoch(epoch);
  }
  until_ = clock_.now() + kValidity;
  return {};
}

Result<void> Lease::release(std::uint64_t epoch) {
  const std::lock_guard lock(mutex_);
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
  std::unique_lock lock(mutex_);
  closed_ = true;
  holder_.clear();
  idle_.wait(lock, [&] { return working_ == 0; });
}

LeaseInfo Lease::info() const {
  const std::lock_guard lock(mutex_);
  return {robot_, holder_, last_.epoch, left()};
}

Error Lease::refusal(std::uint64_t epoch) const {
  const std::lock_guard lock(mutex_);
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
  const std::lock_guard lock(lease.mutex_);
  if (epoch == lease.last_.epoch && !lease.holder_.empty()) {
    ++lease.working_;
    lease_ = &lease;
  }
}

Lease::Work::~Work() {
  if (lease_ == nullptr) {
    return;
  }
  const std::lock_guard lock(lease_->mutex_);
  if (--lease_->working_ == 0) {
    lease_->idle_.notify_all();
  }
}

}  // namespace segue::hosts
