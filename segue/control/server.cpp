// SPDX-License-Identifier: Apache-2.0
#include <segue/control/detail/services.hpp>
#include <segue/control/server.hpp>
#include <segue/rpc/detail/rpc_server.hpp>

#include <optional>
#include <utility>
#include <variant>

namespace segue::control {

namespace {

std::unique_ptr<detail::OfferedService> offered(const Served& service) {
  return std::visit([](auto* one) { return detail::offer(*one); }, service);
}

}  // namespace

Server::Server(std::unique_ptr<detail::RpcServer> server) : server_(std::move(server)) {}
Server::~Server() = default;

std::uint16_t Server::port() const {
  return server_->port();
}

Result<std::unique_ptr<Server>> Server::listen(const std::filesystem::path& socket, Served service) {
  return listen(Places{socket, std::nullopt}, service);
}

Result<std::unique_ptr<Server>> Server::listen(const Places& places, Served service) {
  auto server = detail::RpcServer::listen(places, offered(service));
  if (!server) return server.error();
  return std::unique_ptr<Server>(new Server(std::move(*server)));
}

Result<std::unique_ptr<Server>> Server::serve(Descriptor listening, Served service) {
  auto server = detail::RpcServer::serve(std::move(listening), offered(service));
  if (!server) return server.error();
  return std::unique_ptr<Server>(new Server(std::move(*server)));
}

}  // namespace segue::control
