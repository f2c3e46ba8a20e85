// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/endpoint.hpp>

#include <doors/hostile_values.hpp>

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace segue::control::detail {
class RpcChannel;
}

namespace segue::doors {

/// How long an answer may take where nothing in the call says that it waits.
inline constexpr auto kAnswerTime = std::chrono::seconds(20);

struct Answer {
  std::string code{};  ///< of the error that is the answer; empty: none
  std::string text{};  ///< all texts that it has, one after the other
};

/// A server of the control protocol as whoever speaks it sees it: its functions are those of the schema, so
/// that one which is added is called, too.
class RpcDoor {
 public:
  /// `kind`: "robot", "host" or "processes".
  static Result<RpcDoor> open(const control::TcpEndpoint& endpoint, std::string_view kind);

  [[nodiscard]] std::vector<std::string> functions() const;
  /// With arguments of every type that the schema has there. A capability in the answer is used likewise. An
  /// error where no answer has come in time, or the connection has broken.
  Result<Answer> call(const std::string& function, HostileValues& values);

 private:
  RpcDoor(std::shared_ptr<control::detail::RpcChannel> channel, std::string kind)
      : channel_(std::move(channel)), kind_(std::move(kind)) {}

  std::shared_ptr<control::detail::RpcChannel> channel_;
  std::string kind_;
};

}  // namespace segue::doors
