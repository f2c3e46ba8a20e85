// SPDX-License-Identifier: Apache-2.0
#include <segue/hosts/lease.hpp>

#include <segue/base/file.hpp>
#include <segue/base/text.hpp>

#include <algorithm>
#include <charconv>

namespace segue::hosts {

namespace {

/// The epoch that a file keeps; 0 where there is none.
std::uint64_t read_epoch(const std::filesystem::path& file) {
  const auto text = read_file(file, 64);
  std::uint64_t epoch = 0;
  if (text) {
    std::from_chars(text->data(), text->data() + text->size(), epoch);
  }
  return epoch;
}

Error closed(const std::string& robot) {
  return fail(ErrorCode::Unavailable, "the daemon of this host has ended", robot);
}

}  // namespace

Lease::Lease(std::string robot, std::filesystem::path file, const Clock& clock)
    : robot_(std::move(robot)), file_(std::move(file)), clock_(clock), epoch_(read_epoch(file_)) {}

Duration Lease::left() const {
  return holder_.empty() ? Duration(0) : std::max(Duration(0), until_ - clock_.now());
}

Result<void> Lease::keep(std::uint64_t epoch) const {
  if (auto written = write_file(file_, std::to_string(epoch) + "\n"); !written) {
    return fail(ErrorCode::IoError, "cannot keep the epoch of its lease", robot_).because_of(written.error());
  }
  return {};
}

Result<std::uint64_t> Lease::acquire(const std::string& holder, bool take_over, TimePoint deadline) {
  std::unique_lock lock(mutex_);
  if (closed_) {
    return closed(robot_);
  }
  if (const Duration remaining = left(); holder != holder_ && remaining > Duration(0) && !take_over) {
    return fail(ErrorCode::AlreadyExists,
                "runtime " + quote(holder_) + " commands this robot, for another " +
                    format_duration(remaining) + " at least; wait until it has ended, or take it over",
                robot_);
  }
  // Whatever was begun under the former epoch ends before anything begins under the new one.
  if (auto kept = keep(epoch_ + 1); !kept) {
    return kept.error();
  }
  const std::uint64_t mine = ++epoch_;
  holder_.clear();
  const Duration limit = std::max(Duration(0), deadline - RealClock::instance().now());
  if (!idle_.wait_for(lock, limit, [&] { return working_ == 0; })) {
    return fail(ErrorCode::DeadlineExceeded, "actions that the former runtime had begun have not ended",
                robot_);
  }
  if (closed_) {
    return closed(robot_);
  }
  if (mine != epoch_) {
    return fail(ErrorCode::Superseded, "another runtime has got the robot meanwhile", robot_);
  }
  holder_ = holder;
  until_ = clock_.now() + kValidity;
  return mine;
}

Result<void> Lease::renew(std::uint64_t epoch) {
  const std::lock_guard lock(mutex_);
  if (closed_) {
    return closed(robot_);
  }
  if (epoch != epoch_ || holder_.empty()) {
    return fail(ErrorCode::Superseded, "another runtime commands this robot", robot_);
  }
  until_ = clock_.now() + kValidity;
  return {};
}

Result<void> Lease::release(std::uint64_t epoch) {
  const std::lock_guard lock(mutex_);
  if (closed_) {
    return closed(robot_);
  }
  if (epoch != epoch_) {
    return fail(ErrorCode::Superseded, "another runtime commands this robot", robot_);
  }
  holder_.clear();
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
  return {robot_, holder_, epoch_, left()};
}

Error Lease::refusal(std::uint64_t epoch) const {
  const std::lock_guard lock(mutex_);
  if (closed_) {
    return closed(robot_);
  }
  const std::string who =
      holder_.empty() ? "its lease was given up" : "runtime " + quote(holder_) + " commands it";
  return fail(ErrorCode::Superseded,
              "this runtime does not command the robot on this host any more: " + who + " (epoch " +
                  std::to_string(epoch_) + ", not " + std::to_string(epoch) + ")",
              robot_);
}

Lease::Work::Work(Lease& lease, std::uint64_t epoch) : lease_(nullptr) {
  const std::lock_guard lock(lease.mutex_);
  if (epoch == lease.epoch_ && !lease.holder_.empty()) {
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
