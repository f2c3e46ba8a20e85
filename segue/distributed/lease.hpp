// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/clock.hpp>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/base/result.hpp>
#include <segue/distributed/host_service.hpp>

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

namespace segue::distributed {

/// A request for a lease.
struct Claim {
  std::string holder;      ///< for people
  std::string key{};       ///< nobody else can know it; empty: never the same as who has it
  bool take_over = false;  ///< although somebody else has it
  bool again = false;      ///< it has had it before, and does not want it if somebody else has had it since
  std::uint64_t term = 0;  ///< see RobotRequest::term
};

/// The right of one runtime to command a robot on this host. Every runtime that gets the lease has a higher
/// epoch than the ones before, also those before a restart of the daemon (the last epoch and its holder are
/// kept in a file), and requests with a lower epoch than the present one are refused. So a runtime that was
/// cut off, and whose messages arrive late, does no harm (fencing). After a restart, the last holder gets it
/// before all others. A former holder that asks for it again after somebody else has had it is superseded,
/// however it asks. Of runtimes that take a robot over at the same moment, the same one wins on all hosts, in
/// whichever order they reach these: the one with the higher term, as leaders are elected in Raft (Ongaro and
/// Ousterhout 2014, section 5.1). Thread safe.
class Lease {
 public:
  /// How long a lease lasts that is not renewed. Runtimes renew it once a second.
  static constexpr Duration kValidity = std::chrono::seconds(5);

  /// `file` keeps the epoch; its folder exists. `clock` must outlive this.
  Lease(std::string robot, std::filesystem::path file, const Clock& clock);

  /// Returns the new epoch. AlreadyExists while somebody else has it, unless it takes the lease over;
  /// Superseded where it asks again although somebody else has had it since, or where it takes over from
  /// somebody whose term is higher (the greater name and key win a tie). IoError where the epoch cannot be
  /// kept: then nobody gets it. DeadlineExceeded where work under the former epoch has not ended; nobody has
  /// the lease then.
  Result<std::uint64_t> acquire(const Claim& claim, TimePoint deadline);
  /// Renews or releases the lease; the error of refusal() where the epoch is not the present one, or was
  /// released.
  Result<void> renew(std::uint64_t epoch);
  Result<void> release(std::uint64_t epoch);
  /// The daemon ends: nobody has the lease any more, nor gets it. Blocks until all work has ended.
  void close();
  [[nodiscard]] LeaseInfo info() const;
  /// The highest term of all who have had it, also before a restart.
  [[nodiscard]] std::uint64_t highest_term() const;

  /// Work under an epoch: acquire() waits for its end. Empty where the epoch is not the present one.
  class Work {
   public:
    Work(Lease& lease, std::uint64_t epoch);
    ~Work();
    Work(Work&& other) noexcept : lease_(std::exchange(other.lease_, nullptr)) {}
    Work(const Work&) = delete;
    Work& operator=(const Work&) = delete;
    Work& operator=(Work&&) = delete;
    explicit operator bool() const { return lease_ != nullptr; }

   private:
    Lease* lease_;
  };
  /// Why work under `epoch` is refused: Superseded where somebody else has got the lease since; otherwise
  /// Unavailable: it was released, or its holder has got it anew.
  [[nodiscard]] Error refusal(std::uint64_t epoch) const;

 private:
  [[nodiscard]] Duration left() const SEGUE_REQUIRES(mutex_);
  /// The content of the lease's file.
  struct Kept {
    std::uint64_t epoch = 0;
    std::string key{};  ///< of who had it last
    std::string holder{};
    bool is_held = false;
    std::uint64_t term = 0;          ///< of who had it last
    std::uint64_t highest_term = 0;  ///< of all
  };
  static Kept read(const std::filesystem::path& file);
  Result<void> keep(const Kept& kept) const;
  [[nodiscard]] std::optional<Error> refusal_of(const Claim& claim) const SEGUE_REQUIRES(mutex_);
  [[nodiscard]] bool is_of_last(const Claim& claim) const SEGUE_REQUIRES(mutex_);
  /// Whether a runtime has the lease, or is waiting for the end of earlier work.
  [[nodiscard]] bool is_wanted() const SEGUE_REQUIRES(mutex_) {
    return waiting_ > 0 || until_ > clock_.now();
  }
  [[nodiscard]] std::optional<Error> refusal_of_take_over(const Claim& claim) const SEGUE_REQUIRES(mutex_);
  /// The reason why work under `epoch` is refused.
  [[nodiscard]] Error refusal_of_epoch(std::uint64_t epoch) const SEGUE_REQUIRES(mutex_);

  const std::string robot_;
  const std::filesystem::path file_;
  const Clock& clock_;
  mutable Mutex mutex_;  ///< protects everything below
  ConditionVariable idle_;
  std::string holder_ SEGUE_GUARDED_BY(mutex_);  ///< empty: nobody commands the robot
  Kept last_ SEGUE_GUARDED_BY(mutex_);           ///< who has it, or had it last, and the present epoch
  /// All epochs from this one on are those of the present or last holder.
  std::uint64_t first_of_last_ SEGUE_GUARDED_BY(mutex_) = 0;
  TimePoint until_ SEGUE_GUARDED_BY(mutex_){};  ///< nobody but that one gets it before
  std::size_t working_ SEGUE_GUARDED_BY(mutex_) = 0;
  std::size_t waiting_ SEGUE_GUARDED_BY(mutex_) = 0;  ///< calls of acquire() that wait for the end of work
  bool closed_ SEGUE_GUARDED_BY(mutex_) = false;
};

}  // namespace segue::distributed
