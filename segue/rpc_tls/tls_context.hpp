// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/file_stamp.hpp>
#include <segue/base/mutex.hpp>
#include <segue/rpc/detail/encryption.hpp>
#include <segue/rpc_tls/openssl.hpp>

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>

namespace segue::control::tls {

/// The parts of a set of credentials.
struct Material {
  Certificate certificate;
  Key key;
  Certificate authority;
  RevokedList revoked;
  std::filesystem::path revoked_file;
};

/// The Encryption that OpenSSL does: TLS 1.3 only, since both sides are always of Segue; no resumption, so
/// each connection proves itself anew.
class Context final : public detail::Encryption {
 public:
  /// Internal where OpenSSL does not take the material.
  static Result<std::shared_ptr<Context>> create(Material material);

  kj::Own<detail::SecureStream> accept(kj::Own<kj::AsyncIoStream> stream) override;
  kj::Own<detail::SecureStream> connect(kj::Own<kj::AsyncIoStream> stream, const std::string& host) override;
  void refresh() override;
  [[nodiscard]] std::optional<Error> refusal(const Identity& identity) const override;

  using Shared = std::shared_ptr<SSL_CTX>;
  /// The context from which connections are made, also those of servers that have no Stream.
  [[nodiscard]] Shared current() const;

 private:
  explicit Context(Material material) : material_(std::move(material)) {}
  /// Makes the object from which connections are made anew, with the present list of revoked certificates.
  Result<void> renew() SEGUE_REQUIRES(mutex_);

  mutable Mutex mutex_;  ///< protects all that follows
  Material material_ SEGUE_GUARDED_BY(mutex_);
  Shared current_ SEGUE_GUARDED_BY(mutex_);
  std::set<std::string> revoked_ SEGUE_GUARDED_BY(mutex_);  ///< serial numbers
  std::optional<FileStamp> stamp_ SEGUE_GUARDED_BY(mutex_);
};

}  // namespace segue::control::tls
