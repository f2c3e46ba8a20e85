// SPDX-License-Identifier: Apache-2.0
#include <segue/rpc_tls/tls_context.hpp>
#include <segue/rpc_tls/tls_server.hpp>

namespace segue::control {

std::shared_ptr<ssl_ctx_st> server_context(const Credentials& credentials) {
  auto& context = dynamic_cast<tls::Context&>(credentials.encryption());
  context.refresh();
  return context.current();
}

Result<Identity> identity_at(const ssl_st& connection) {
  const tls::Certificate certificate(SSL_get1_peer_certificate(&connection));
  if (!certificate || SSL_get_verify_result(&connection) != X509_V_OK)
    return fail(ErrorCode::PermissionDenied, "the other side has shown no certificate");
  return tls::identity_of(certificate.get());
}

}  // namespace segue::control
