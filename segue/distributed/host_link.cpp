// SPDX-License-Identifier: Apache-2.0
#include <segue/distributed/host_link.hpp>

#include <segue/base/text.hpp>
#include <segue/distributed/clock_reading.hpp>

namespace segue::distributed::detail {

namespace {

/// How much an older, shorter round trip counts less with each measurement, so that a clock that drifts or
/// jumps is noticed.
constexpr Duration kAging = std::chrono::microseconds(50);

/// Whether an error means that the other side is gone, hangs or obeys somebody else.
bool is_lost(ErrorCode code) {
  return code == ErrorCode::Unavailable || code == ErrorCode::DeadlineExceeded ||
         code == ErrorCode::Superseded;
}

}  // namespace

Result<void> HostLink::connect(const RobotRequest& request, TimePoint deadline) {
  const Lock one(connecting_);
  if (reachable()) {
    return {};
  }
  if (auto lost = loss_.why()) {
    return std::move(*lost);
  }
  const TimePoint asked = RealClock::instance().now();
  auto made = open(deadline);
  auto info = made ? acquire(**made, request, deadline) : Result<HostInfo>(made.error());
  if (!info) {
    loss_.note(place_.name, info.error());
    lose(std::nullopt, to_string(info.error()));
    const Lock lock(mutex_);
    refusal_.reset();
    if (info.error().code == ErrorCode::AlreadyExists) refusal_ = Refusal{info.error(), asked};
    return info.error();
  }
  return use(std::move(*made), std::move(*info));
}

Result<void> HostLink::use(std::shared_ptr<Connection> made, HostInfo info) {
  const auto robot = made->robot;
  std::optional<Error> lost;
  {
    const Lock lock(mutex_);
    lost = loss_.why();  // whoever notes it later gives this connection up
    if (!lost) {
      connection_.swap(made);  // a broken one ends without the lock
      ++number_;
      why_.clear();
      refusal_.reset();
      since_ = RealClock::instance().now();
      info_ = std::move(info);
    }
  }
  if (!lost) {
    return {};
  }
  (void)robot->release();
  return std::move(*lost);
}

Result<std::shared_ptr<HostLink::Connection>> HostLink::open(TimePoint deadline) {
  std::shared_ptr<Connection> made(new Connection, [&pool = pool_](Connection* ended) {
    if (!pool.submit([ended] { delete ended; })) {
      delete ended;
    }
  });
  const std::weak_ptr<Connection> weak = made;
  auto service = place_.connect(deadline, [this, weak] {
    const Lock lock(mutex_);
    if (const auto broken = weak.lock()) {
      broken->broken = true;  // whoever asks next loses it
    }
  });
  if (!service) {
    return service.error();
  }
  made->service = std::move(*service);
  return made;
}

Result<HostInfo> HostLink::acquire(Connection& connection, const RobotRequest& request, TimePoint deadline) {
  auto info = connection.service->info();
  if (info && info->name != place_.name) {
    return fail(ErrorCode::InvalidArgument,
                "calls itself " + quote(info->name.str()) + "; correct its address in the robot file",
                place_.name.str());
  }
  if (!info) {
    return info;
  }
  RobotRequest asked = request;
  {
    const Lock lock(mutex_);
    asked.again = number_ > 0;
  }
  auto robot = connection.service->acquire(asked, deadline);
  if (!robot) {
    return robot.error();
  }
  connection.robot = std::move(*robot);
  (void)measure(*connection.service);
  return info;
}

Result<void> HostLink::measure(HostService& service) {
  const auto clock = read_clock(service);
  if (!clock) {
    return clock.error();
  }
  const Lock lock(mutex_);
  if (!round_trip_ || clock->round_trip <= *round_trip_) {
    round_trip_ = clock->round_trip;
    offset_ = clock->offset;
  } else {
    *round_trip_ += kAging;
  }
  return {};
}

Result<std::uint64_t> HostLink::highest_term(const std::string& robot, TimePoint deadline) {
  const auto made = open(deadline);
  return made ? (*made)->service->highest_term(robot) : Result<std::uint64_t>(made.error());
}

Result<void> HostLink::keep_alive() {
  std::shared_ptr<Connection> connection;
  std::uint64_t number = 0;
  {
    const Lock lock(mutex_);
    if (connection_ == nullptr) {
      return fail(ErrorCode::Unavailable, why_, place_.name.str());
    }
    connection = connection_;
    number = number_;
  }
  auto alive = connection->robot->renew();
  if (alive) {
    alive = measure(*connection->service);
  }
  if (!alive) {
    loss_.note(place_.name, alive.error());
    lose(number, to_string(alive.error()));
  }
  return alive;
}

std::shared_ptr<HostLink::Connection> HostLink::take(std::optional<std::uint64_t> number,
                                                     const std::string& why) {
  const Lock lock(mutex_);
  if (number && *number != number_) {
    return nullptr;
  }
  if (connection_ != nullptr || why_.empty()) {
    since_ = RealClock::instance().now();
  }
  why_ = why;
  return std::exchange(connection_, nullptr);
}

void HostLink::lose(std::optional<std::uint64_t> number, const std::string& why) {
  const auto lost = take(number, why);
  if (lost != nullptr) {
    lost->robot->set_listener({});
  }
}

void HostLink::note(const Error& error, std::uint64_t number) {
  loss_.note(place_.name, error);
  if (is_lost(error.code)) {
    lose(number, to_string(error));
  }
}

void HostLink::release(const std::string& why) {
  const auto ended = take(std::nullopt, why);
  if (ended != nullptr) {
    ended->robot->set_listener({});
    (void)ended->robot->release();
  }
}

Result<HostLink::Reached> HostLink::reach() const {
  if (auto lost = loss_.why()) {
    return std::move(*lost);
  }
  const Lock lock(mutex_);
  if (connection_ == nullptr || connection_->broken) {
    return fail(ErrorCode::Unavailable, "host " + quote(place_.name.str()) +
                                            " cannot be reached, so what it runs is unknown: " +
                                            (why_.empty() ? "the connection broke" : why_));
  }
  return Reached{{connection_, connection_->robot.get()}, number_};
}

bool HostLink::reachable() const {
  const Lock lock(mutex_);
  return is_connected();
}

std::optional<HostLink::Refusal> HostLink::refusal() const {
  const Lock lock(mutex_);
  return refusal_;
}

HostInfo HostLink::info() const {
  const Lock lock(mutex_);
  return info_;
}

task_host::ComputerReport HostLink::report() const {
  const Lock lock(mutex_);
  task_host::ComputerReport report;
  report.name = place_.name;
  report.address = place_.address;
  report.optional = place_.optional;
  report.reachable = is_connected();
  const auto lost = loss_.why();
  report.state = report.reachable ? "connected"
                 : lost           ? to_string(*lost)
                 : why_.empty()   ? "the connection broke"
                                  : why_;
  report.since = RealClock::instance().now() - since_;
  report.connection = number_;
  report.software = info_.software;
  if (report.reachable) {
    report.round_trip = round_trip_;
    report.clock_offset = offset_;
  }
  return report;
}

void HostLink::note(const HostView& view) {
  const Lock lock(mutex_);
  seen_ = view;
}

HostView HostLink::last_seen() const {
  const Lock lock(mutex_);
  return seen_;
}

}  // namespace segue::distributed::detail
