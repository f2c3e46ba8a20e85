// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc/detail/encryption.hpp>
#include <segue/rpc_tls/openssl.hpp>

#include <kj/array.h>

#include <array>
#include <optional>
#include <string>

namespace segue::control::tls {

/// One TLS connection: OpenSSL works on memory, kj moves the bytes. One call of each direction at a time, as
/// kj has it.
class Stream final : public detail::SecureStream {
 public:
  enum class Side { Server, Client };

  /// `host` is the name that a client expects. Throws std::bad_alloc.
  Stream(SSL_CTX* context, kj::Own<kj::AsyncIoStream> inner, Side side, std::string host);

  kj::Promise<Result<Identity>> handshake() override;
  kj::Promise<void> drain() override;
  void break_off(Error why) override;
  [[nodiscard]] std::optional<Error> problem() const override { return problem_; }
  [[nodiscard]] const std::string& claimed_name() const override { return claimed_name_; }

  kj::Promise<size_t> tryRead(void* buffer, size_t minimum, size_t maximum) override;
  kj::Promise<void> write(const void* buffer, size_t size) override;
  kj::Promise<void> write(kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> pieces) override;
  kj::Promise<void> whenWriteDisconnected() override { return inner_->whenWriteDisconnected(); }
  void shutdownWrite() override;

  kj::Promise<ReadResult> tryReadWithFds(void* buffer, size_t minimum, size_t maximum, kj::AutoCloseFd* fds,
                                         size_t max_fds) override;
  kj::Promise<void> writeWithFds(kj::ArrayPtr<const kj::byte> data,
                                 kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> more,
                                 kj::ArrayPtr<const int> fds) override;
  kj::Promise<ReadResult> tryReadWithStreams(void* buffer, size_t minimum, size_t maximum,
                                             kj::Own<kj::AsyncCapabilityStream>* streams,
                                             size_t max_streams) override;
  kj::Promise<void> writeWithStreams(kj::ArrayPtr<const kj::byte> data,
                                     kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> more,
                                     kj::Array<kj::Own<kj::AsyncCapabilityStream>> streams) override;

 private:
  friend class Context;
  /// Decides on the other side's certificate, as a callback of OpenSSL; also of connections that are no
  /// Stream, which only servers have.
  static int verify(int good, X509_STORE_CTX* store);
  bool verify_owner(X509_STORE_CTX* store, X509* certificate);

  kj::Promise<Result<Identity>> fail_handshake();
  [[nodiscard]] Result<Identity> verified() const;
  kj::Promise<size_t> read_more(kj::byte* buffer, size_t minimum, size_t maximum, size_t done);
  kj::Promise<void> write_from(kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> pieces, size_t piece,
                               size_t offset);
  /// Takes bytes from the other side; false at their end.
  kj::Promise<bool> feed();
  /// Sends the bytes that OpenSSL has made.
  kj::Promise<void> flush();
  kj::Promise<void> send_alert();
  void note_problem();
  [[nodiscard]] Error problem_from(unsigned long code) const;
  [[nodiscard]] std::string other() const;

  kj::Own<kj::AsyncIoStream> inner_;
  const Side side_;
  const std::string host_;
  Owned<SSL, SSL_free> ssl_;
  BIO* received_ = nullptr;  ///< belongs to ssl_, like the next
  BIO* to_send_ = nullptr;
  std::string refusal_;  ///< why we do not take the other side's certificate
  std::string claimed_name_;
  std::optional<Error> problem_;
  bool writing_ = false;
  std::size_t drained_ = 0;
  std::array<kj::byte, 16384> buffer_;
  kj::Promise<void> closing_ = nullptr;
};

}  // namespace segue::control::tls
