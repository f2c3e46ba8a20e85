// SPDX-License-Identifier: Apache-2.0
#include <segue/base/log.hpp>
#include <segue/base/text.hpp>
#include <segue/rpc_tls/tls_context.hpp>
#include <segue/rpc_tls/tls_stream.hpp>

#include <openssl/err.h>
#include <openssl/x509_vfy.h>

#include <utility>

namespace segue::control::tls {

namespace {

/// Larger chains of certificates are refused: ours have one of half a kilobyte.
constexpr long kLargestChain = 8192;

bool set_up(SSL_CTX* context, const Material& material) {
  // Each connection is verified in full, and the other side's list of revoked certificates may change.
  SSL_CTX_set_session_cache_mode(context, SSL_SESS_CACHE_OFF);
  SSL_CTX_set_options(context, SSL_OP_NO_TICKET | SSL_OP_NO_RENEGOTIATION);
  SSL_CTX_set_mode(context, SSL_MODE_RELEASE_BUFFERS | SSL_MODE_ENABLE_PARTIAL_WRITE |
                                SSL_MODE_ACCEPT_MOVING_WRITE_BUFFER);
  SSL_CTX_set_max_cert_list(context, kLargestChain);
  SSL_CTX_set_verify_depth(context, 1);
  X509_STORE* store = SSL_CTX_get_cert_store(context);
  return SSL_CTX_set_min_proto_version(context, TLS1_3_VERSION) == 1 &&
         SSL_CTX_set_max_proto_version(context, 0) == 1 &&  // whatever the system's configuration says
         SSL_CTX_set_num_tickets(context, 0) == 1 &&
         SSL_CTX_use_certificate(context, material.certificate.get()) == 1 &&
         SSL_CTX_use_PrivateKey(context, material.key.get()) == 1 &&
         SSL_CTX_check_private_key(context) == 1 &&
         X509_STORE_add_cert(store, material.authority.get()) == 1 &&
         X509_STORE_add_crl(store, material.revoked.get()) == 1 &&
         X509_STORE_set_flags(store, X509_V_FLAG_CRL_CHECK) == 1;
}

}  // namespace

Result<std::shared_ptr<Context>> Context::create(Material material) {
  std::shared_ptr<Context> context(new Context(std::move(material)));
  const Lock lock(context->mutex_);
  if (auto stamp = stamp_of(context->material_.revoked_file)) context->stamp_ = *stamp;
  if (auto done = context->renew(); !done) return done.error();
  return context;
}

Result<void> Context::renew() {
  Shared made(SSL_CTX_new(TLS_method()), SSL_CTX_free);
  if (!made || !set_up(made.get(), material_)) {
    return openssl_error(ErrorCode::Internal, "cannot use the credentials");
  }
  SSL_CTX_set_verify(made.get(), SSL_VERIFY_PEER | SSL_VERIFY_FAIL_IF_NO_PEER_CERT, Stream::verify);
  std::set<std::string> serials;
  for (auto& one : revocations(material_.revoked.get()))
    serials.insert(std::move(one.serial));
  current_ = std::move(made);
  revoked_ = std::move(serials);
  return {};
}

Context::Shared Context::current() const {
  const Lock lock(mutex_);
  return current_;
}

kj::Own<detail::SecureStream> Context::accept(kj::Own<kj::AsyncIoStream> stream) {
  refresh();
  return kj::heap<Stream>(current().get(), kj::mv(stream), Stream::Side::Server, std::string());
}

kj::Own<detail::SecureStream> Context::connect(kj::Own<kj::AsyncIoStream> stream, const std::string& host) {
  refresh();
  return kj::heap<Stream>(current().get(), kj::mv(stream), Stream::Side::Client, host);
}

void Context::refresh() {
  const Lock lock(mutex_);
  const auto stamp = stamp_of(material_.revoked_file);
  if (!stamp || stamp_ == *stamp) return;
  stamp_ = *stamp;  // a list that cannot be used is reported once
  auto list = read_revoked_list(material_.revoked_file, material_.authority.get());
  Result<void> done;
  if (list) {
    std::swap(material_.revoked, *list);
    done = renew();
    if (!done) std::swap(material_.revoked, *list);
  } else {
    done = list.error();
  }
  log(done ? LogLevel::Info : LogLevel::Error, "control",
      done ? "the list of revoked certificates has changed: " + std::to_string(revoked_.size()) + " are"
           : "the former list of revoked certificates stays in force: " + to_string(done.error()));
}

std::optional<Error> Context::refusal(const Identity& identity) const {
  const Lock lock(mutex_);
  const std::string whose = "the certificate of " + quote(identity.name);
  if (revoked_.contains(identity.serial)) {
    return fail(ErrorCode::PermissionDenied, whose + " has been revoked");
  }
  if (std::chrono::system_clock::now() >= identity.valid_until) {
    return fail(ErrorCode::PermissionDenied, whose + " has expired at " + text_of(identity.valid_until));
  }
  return std::nullopt;
}

}  // namespace segue::control::tls
