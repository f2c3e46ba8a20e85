// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/base/result.hpp>
#include <segue/rpc/credentials.hpp>

#include <kj/async-io.h>

#include <optional>
#include <string>

/// The interfaces of TLS for server and client. Its implementation (the folder rpc_tls) is reached through
/// these only, so that deployment processes, which use Unix sockets alone, need not contain it: loading
/// OpenSSL would take them a millisecond.
namespace segue::control::detail {

/// A stream over TLS. Used in the thread of its event loop only. It carries no descriptors.
class SecureStream : public kj::AsyncCapabilityStream {
 public:
  /// Resolves when the other side has proven who it is, or with the reason why not; never rejects. Comes
  /// first and once. A client's may succeed though the server will refuse it, as TLS 1.3 has it: then
  /// problem() knows once reading has failed.
  virtual kj::Promise<Result<Identity>> handshake() = 0;
  /// After a handshake that failed: resolves when the other side has had the time to read why, that is, has
  /// closed. Reads a little and drops it.
  virtual kj::Promise<void> drain() = 0;
  /// Ends the connection, which is broken from now on, since the other side may not stay.
  virtual void break_off(Error why) = 0;
  /// Why the connection broke, where TLS, the other side or break_off() says so.
  [[nodiscard]] virtual std::optional<Error> problem() const = 0;
  /// The name in the certificate that the other side has shown, even if it was refused; else empty.
  [[nodiscard]] virtual const std::string& claimed_name() const = 0;
};

/// Makes streams with one set of credentials. Thread safe.
class Encryption {
 public:
  virtual ~Encryption() = default;
  /// For a connection that was accepted.
  virtual kj::Own<SecureStream> accept(kj::Own<kj::AsyncIoStream> stream) = 0;
  /// For one to the host of that name.
  virtual kj::Own<SecureStream> connect(kj::Own<kj::AsyncIoStream> stream, const std::string& host) = 0;
  /// Re-reads the list of revoked certificates if its file has changed. Where the new one cannot be used,
  /// that is logged, and the former one stays in force.
  virtual void refresh() = 0;
  /// Why someone whose certificate was good may not stay: it was revoked, or has expired since.
  [[nodiscard]] virtual std::optional<Error> refusal(const Identity& identity) const = 0;
};

}  // namespace segue::control::detail
