// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/descriptor.hpp>
#include <segue/base/result.hpp>
#include <segue/rpc/detail/offered_service.hpp>
#include <segue/rpc/endpoint.hpp>

#include <cstdint>
#include <memory>

namespace segue::control::detail {

/// Serves one service from a thread of its own; control::Server is an RpcServer for one of the existing
/// services.
class RpcServer {
 public:
  /// Listens at several places. The errors of control::Server::listen().
  static Result<std::unique_ptr<RpcServer>> listen(const Places& places,
                                                   std::unique_ptr<OfferedService> service);
  /// Serves on a socket that is bound and listens already. The errors of control::Server::serve().
  static Result<std::unique_ptr<RpcServer>> serve(Descriptor listening,
                                                  std::unique_ptr<OfferedService> service);
  /// Refuses new calls, waits for those in progress (until their deadlines at most) and sends their answers,
  /// then closes all clients and removes the socket that listen() made.
  ~RpcServer();

  /// The port of TCP; 0 where it does not listen there.
  [[nodiscard]] std::uint16_t port() const;

 private:
  struct Implementation;
  explicit RpcServer(std::unique_ptr<Implementation> implementation);
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace segue::control::detail
