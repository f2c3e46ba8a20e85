// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/control/detail/link.hpp>
#include <segue/control/detail/wire.hpp>
#include <segue/control/server.hpp>

#include <algorithm>
#include <exception>
#include <string>
#include <utility>

namespace segue::control {

namespace {

using detail::as_text;
using detail::Link;
using type::Value;

/// For calls that only look; the robot answers in milliseconds.
constexpr Duration kLookTimeout = std::chrono::seconds(10);
/// The robot tells of a passed deadline itself, with more to say; only when it does not, we do.
constexpr Duration kGrace = std::chrono::seconds(2);

Duration time_left(TimePoint deadline) {
  const TimePoint now = RealClock::instance().now();
  return deadline > now ? deadline - now : Duration(0);
}

Result<void> without_value(const Result<Value>& answer) {
  if (!answer) return answer.error();
  return {};
}

/// A port's samples, read through the link.
class ClientStream final : public SampleStream {
 public:
  ClientStream(std::shared_ptr<Link> link, Link::StreamId id, std::string type)
      : link_(std::move(link)), id_(id), type_(std::move(type)) {}
  ~ClientStream() override { link_->close_stream(id_); }

  Result<std::vector<Value>> read(std::size_t limit) override {
    auto answer = link_->ask(kLookTimeout, [id = id_, limit](Link::Connection& connection) {
      auto request = connection.stream(id).readRequest();
      request.setLimit(static_cast<std::uint32_t>(std::min<std::size_t>(limit, UINT32_MAX)));
      return Link::send(request);
    });
    if (!answer) return answer.error();
    if (!answer->is_list()) return fail(ErrorCode::Internal, "the robot sent samples that are no list");
    return std::move(answer->as_list());
  }

  [[nodiscard]] std::string type_name() const override { return type_; }

 private:
  std::shared_ptr<Link> link_;
  Link::StreamId id_;
  std::string type_;
};

class Client final : public RobotService {
 public:
  explicit Client(std::shared_ptr<Link> link) : link_(std::move(link)) {}

  Result<Value> status() override {
    return link_->ask(kLookTimeout, [](Link::Connection& connection) {
      auto request = connection.robot().statusRequest();
      return Link::send(request);
    });
  }

  Result<Value> task(std::string_view id) override {
    return link_->ask(kLookTimeout, [id = std::string(id)](Link::Connection& connection) {
      auto request = connection.robot().taskRequest();
      request.setId(as_text(id));
      return Link::send(request);
    });
  }

  Result<Value> switch_to(std::string_view controller, bool dry_run, std::string_view order,
                          TimePoint deadline) override {
    const Duration left = time_left(deadline);
    return link_->ask(left + kGrace, [=, controller = std::string(controller),
                                      order = std::string(order)](Link::Connection& connection) {
      auto request = connection.robot().switchToRequest();
      request.setController(as_text(controller));
      request.setDryRun(dry_run);
      request.setOrder(as_text(order));
      request.setTimeout(left.count());
      return Link::send(request);
    });
  }

  Result<Value> apply_transition(std::string_view transition, std::string_view file,
                                 TimePoint deadline) override {
    const Value sized(transition);
    if (auto fits = detail::check_size(sized, detail::kServerMessageWords); !fits) return fits.error();
    const Duration left = time_left(deadline);
    return link_->ask(left + kGrace, [&, file = std::string(file)](Link::Connection& connection) {
      auto request = connection.robot().applyTransitionRequest();
      request.setText(detail::as_data(transition));
      request.setFile(as_text(file));
      request.setTimeout(left.count());
      return Link::send(request);
    });
  }

  Result<void> reset_belief() override {
    return without_value(link_->ask(kLookTimeout, [](Link::Connection& connection) {
      auto request = connection.robot().resetBeliefRequest();
      return Link::send(request);
    }));
  }

  Result<void> set_property(std::string_view task, std::string_view property, const Value& value,
                            TimePoint deadline) override {
    if (auto fits = detail::check_size(value, detail::kServerMessageWords); !fits) return fits;
    const Duration left = time_left(deadline);
    return without_value(link_->ask(left + kGrace, [&](Link::Connection& connection) -> Link::Answer {
      auto request = connection.robot().setPropertyRequest();
      request.setTask(as_text(std::string(task)));
      request.setProperty(as_text(std::string(property)));
      request.setTimeout(left.count());
      if (auto done = detail::encode(value, request.initValue()); !done) return Result<Value>(done.error());
      return Link::send(request);
    }));
  }

  Result<Value> call(std::string_view task, std::string_view operation, const Value& arguments,
                     TimePoint deadline) override {
    if (auto fits = detail::check_size(arguments, detail::kServerMessageWords); !fits) return fits.error();
    const Duration left = time_left(deadline);
    return link_->ask(left + kGrace, [&](Link::Connection& connection) -> Link::Answer {
      auto request = connection.robot().callRequest();
      request.setTask(as_text(std::string(task)));
      request.setOperation(as_text(std::string(operation)));
      request.setTimeout(left.count());
      if (auto done = detail::encode(arguments, request.initArguments()); !done) {
        return Result<Value>(done.error());
      }
      return Link::send(request);
    });
  }

  Result<std::unique_ptr<SampleStream>> open_port(std::string_view task, std::string_view port,
                                                  std::size_t buffer) override {
    const Link::StreamId id = link_->new_stream_id();
    auto type = link_->ask(kLookTimeout, [&, id](Link::Connection& connection) {
      auto request = connection.robot().openPortRequest();
      request.setTask(as_text(std::string(task)));
      request.setPort(as_text(std::string(port)));
      request.setBuffer(static_cast<std::uint32_t>(std::min<std::size_t>(buffer, UINT32_MAX)));
      return connection.open(id, request);
    });
    if (!type) return type.error();
    return std::make_unique<ClientStream>(link_, id, type->is_string() ? type->as_string() : std::string());
  }

  Result<Value> events(std::uint64_t after, Duration wait) override {
    const Duration patience = std::max(wait, Duration(0));
    return link_->ask(patience + kLookTimeout, [after, patience](Link::Connection& connection) {
      auto request = connection.robot().eventsRequest();
      request.setAfter(after);
      request.setWait(patience.count());
      return Link::send(request);
    });
  }

  Result<Value> history() override {
    return link_->ask(kLookTimeout, [](Link::Connection& connection) {
      auto request = connection.robot().historyRequest();
      return Link::send(request);
    });
  }

  Result<void> shut_down() override {
    return without_value(link_->ask(kLookTimeout, [](Link::Connection& connection) {
      auto request = connection.robot().shutDownRequest();
      return Link::send(request);
    }));
  }

 private:
  std::shared_ptr<Link> link_;
};

}  // namespace

Result<std::unique_ptr<RobotService>> connect(const std::filesystem::path& socket, Duration timeout) {
  auto link = Link::open(socket, timeout);
  if (!link) return link.error();
  return std::make_unique<Client>(std::move(*link));
}

}  // namespace segue::control
