// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_codecs/robot.capnp.h>
#include <segue/base/condition_variable.hpp>
#include <segue/base/mutex.hpp>
#include <segue/control/detail/lease_client.hpp>
#include <segue/control/detail/stream_client.hpp>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace segue::control::detail {

namespace {

using type::Value;

constexpr std::uint32_t kMostNews = 100;

std::uint64_t request_number(const Value* value) {
  if (value == nullptr || !value->is_integer()) return 0;
  if (value->kind() == Value::Kind::UInt) return value->as_uint();
  return static_cast<std::uint64_t>(std::max<std::int64_t>(value->as_int(), 0));
}

/// The client's knowledge of a lease. News are told once, so a question for them is never dropped: a caller
/// that waits no longer leaves the answer to later ones.
class LeaseNews {
 public:
  /// Calls `ask` where no question is under way, and waits for the answer.
  template <class Ask>
  Result<void> wait_for(const Wait& wait, const Ask& ask) {
    Lock lock(mutex_);
    if (wait.is_stopped()) return no_longer_wanted();
    const std::uint64_t next = answers_ + 1;
    if (!std::exchange(is_asked_, true)) {
      lock.unlock();
      ask();
      lock.lock();
    }
    const auto has_come = [&]() SEGUE_REQUIRES(mutex_) { return answers_ >= next; };
    const bool came = wait.deadline == TimePoint::max()
                          ? answered_.wait(mutex_, wait.stop, has_come)
                          : answered_.wait_until(mutex_, wait.stop, wait.deadline, has_come);
    if (came) return last_;
    if (wait.is_stopped()) return no_longer_wanted();
    return fail(ErrorCode::DeadlineExceeded, "the robot has not said in time what became of the lease");
  }
  void answer(const Result<Value>& news) {
    const Lock lock(mutex_);
    last_ = news ? Result<void>() : news.error();
    if (news && news->is_list()) {
      for (const Value& one : news->as_list())
        take_in(one);
    }
    is_asked_ = false;
    ++answers_;
    answered_.notify_all();
  }
  [[nodiscard]] LeaseStanding standing() {
    const Lock lock(mutex_);
    return standing_;
  }
  std::vector<HolderRequest> take_commands() {
    const Lock lock(mutex_);
    return std::exchange(asked_, {});
  }

 private:
  void take_in(const Value& one) SEGUE_REQUIRES(mutex_) {
    const Value* who = one.find("lost_to");
    const Value* what = one.find("asked");
    const Value* arguments = one.find("arguments");
    const Value* stopped = one.find("stopped");
    if (who != nullptr && who->is_string()) standing_.lost_to = who->as_string();
    if (stopped != nullptr && *stopped == Value(true)) standing_.is_stopped = true;
    if (what == nullptr || !what->is_string()) return;
    asked_.push_back(
        {request_number(one.find("number")), what->as_string(), arguments == nullptr ? Value() : *arguments});
  }

  Mutex mutex_;  ///< protects all below; not held while the robot is asked
  StoppableConditionVariable answered_;
  bool is_asked_ SEGUE_GUARDED_BY(mutex_) = false;
  std::uint64_t answers_ SEGUE_GUARDED_BY(mutex_) = 0;
  Result<void> last_ SEGUE_GUARDED_BY(mutex_);
  LeaseStanding standing_ SEGUE_GUARDED_BY(mutex_);
  std::vector<HolderRequest> asked_ SEGUE_GUARDED_BY(mutex_);
};

class ClientLease final : public RobotLease {
 public:
  ClientLease(std::shared_ptr<RpcChannel> channel, RpcChannel::StreamId id,
              std::unique_ptr<SampleStream> stream, std::uint64_t number)
      : channel_(std::move(channel)), id_(id), stream_(std::move(stream)), number_(number) {}
  ~ClientLease() override {
    static_cast<void>(channel_->ask(kGrace, [id = id_](RpcChannel::Connection& connection) {
      auto request = connection.held<wire::SampleStream>(id).closeRequest();
      return RpcChannel::send(request);
    }));
  }
  ClientLease(const ClientLease&) = delete;
  ClientLease& operator=(const ClientLease&) = delete;

  [[nodiscard]] std::uint64_t number() const override { return number_; }
  Result<LeaseStanding> standing(const Wait& wait) override {
    if (auto read = read_news(wait); !read) return read.error();
    return news_->standing();
  }
  Result<std::vector<HolderRequest>> asked() override {
    if (auto read = read_news(Wait(TimePoint::max())); !read) return read.error();
    return news_->take_commands();
  }

 private:
  Result<void> read_news(const Wait& wait) {
    return news_->wait_for(wait, [this] {
      const auto read = [news = news_, id = id_](RpcChannel::Connection& connection) {
        auto request = connection.held<wire::SampleStream>(id).readRequest();
        request.setLimit(kMostNews);
        return RpcChannel::send(request).then([news](Result<Value>&& answer) { news->answer(answer); });
      };
      const auto failed = [news = news_](const Error& error) { news->answer(error); };
      if (!channel_->start(kQueryTimeout, read, failed))
        failed(fail(ErrorCode::Unavailable, "the connection is closed"));
    });
  }

  const std::shared_ptr<RpcChannel> channel_;
  const RpcChannel::StreamId id_;
  const std::unique_ptr<SampleStream> stream_;  ///< of that id
  const std::uint64_t number_;
  const std::shared_ptr<LeaseNews> news_ = std::make_shared<LeaseNews>();
};

}  // namespace

Result<std::unique_ptr<RobotLease>> opened_lease(std::shared_ptr<RpcChannel> channel, RpcChannel::StreamId id,
                                                 const Result<Value>& number) {
  auto stream = opened_stream(channel, id, number);
  if (!stream) return stream.error();
  const std::string text = (*stream)->type_name();
  std::uint64_t value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  if (value == 0) return fail(ErrorCode::Internal, channel->who() + " sent a lease without a number");
  return std::make_unique<ClientLease>(std::move(channel), id, std::move(*stream), value);
}

}  // namespace segue::control::detail
