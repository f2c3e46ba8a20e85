// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/credentials.hpp>

#include <memory>

struct ssl_ctx_st;  // OpenSSL's SSL_CTX and SSL
struct ssl_st;

/// The certificates of hosts and people for servers that speak other protocols than Segue's, such as HTTP.
/// All functions may be called from any thread.
namespace segue::control {

/// The context with which such a server accepts connections: TLS 1.3, and the other side must show a
/// certificate of the authority that was not revoked. Re-reads the list of revoked certificates if its file
/// has changed, so ask for each connection.
std::shared_ptr<ssl_ctx_st> server_context(const Credentials& credentials);

/// The identity at the other end of a connection after its handshake; PermissionDenied: it has shown no
/// certificate. ConnectionTable knows whether its owner may stay.
Result<Identity> identity_at(const ssl_st& connection);

}  // namespace segue::control
