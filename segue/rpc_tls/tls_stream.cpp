// SPDX-License-Identifier: Apache-2.0
#include <segue/base/text.hpp>
#include <segue/rpc_tls/reasons.hpp>
#include <segue/rpc_tls/tls_stream.hpp>

#include <kj/debug.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>

#include <algorithm>
#include <new>
#include <utility>

namespace segue::control::tls {

namespace {

/// How much is encrypted before it is sent.
constexpr std::size_t kBatch = std::size_t{64} << 10;
/// How much OpenSSL may have to say of its own accord before we send again. Only who asks for new keys again
/// and again makes it say so much.
constexpr std::size_t kMostUnasked = std::size_t{64} << 10;
/// The most bytes that are read from a client that was refused.
constexpr std::size_t kMostDrained = std::size_t{64} << 10;

kj::Exception no_descriptors() {
  return KJ_EXCEPTION(UNIMPLEMENTED, "descriptors cannot be sent to another computer");
}

}  // namespace

Stream::Stream(SSL_CTX* context, kj::Own<kj::AsyncIoStream> inner, Side side, std::string host)
    : inner_(kj::mv(inner)), side_(side), host_(std::move(host)), ssl_(SSL_new(context)) {
  received_ = BIO_new(BIO_s_mem());
  to_send_ = BIO_new(BIO_s_mem());
  if (!ssl_ || received_ == nullptr || to_send_ == nullptr) {
    BIO_free(received_);
    BIO_free(to_send_);
    throw std::bad_alloc();
  }
  SSL_set_bio(ssl_.get(), received_, to_send_);
  SSL_set_app_data(ssl_.get(), this);
  side == Side::Server ? SSL_set_accept_state(ssl_.get()) : SSL_set_connect_state(ssl_.get());
}

int Stream::verify(int good, X509_STORE_CTX* store) {
  auto* ssl = static_cast<SSL*>(X509_STORE_CTX_get_ex_data(store, SSL_get_ex_data_X509_STORE_CTX_idx()));
  auto* stream = static_cast<Stream*>(SSL_get_app_data(ssl));
  X509* certificate = X509_STORE_CTX_get_current_cert(store);
  const bool owner = X509_STORE_CTX_get_error_depth(store) == 0;
  if (stream == nullptr) return good == 1 && (!owner || identity_of(certificate)) ? 1 : 0;
  if (good == 1) {
    return !owner || stream->verify_owner(store, certificate) ? 1 : 0;
  }
  X509* shown = X509_STORE_CTX_get0_cert(store);
  if (shown != nullptr) stream->claimed_name_ = common_name(shown);
  stream->refusal_ = reason_of(X509_STORE_CTX_get_error(store), certificate);
  return 0;
}

bool Stream::verify_owner(X509_STORE_CTX* store, X509* certificate) {
  claimed_name_ = common_name(certificate);
  const auto identity = identity_of(certificate);
  if (!identity) {
    refusal_ = identity.error().message;
  } else if (side_ == Side::Client && identity->name != host_) {
    refusal_ = "it is that of " + quote(identity->name) + ", not of " + quote(host_);
  } else {
    return true;
  }
  X509_STORE_CTX_set_error(store,
                           identity ? X509_V_ERR_HOSTNAME_MISMATCH : X509_V_ERR_APPLICATION_VERIFICATION);
  return false;
}

kj::Promise<Result<Identity>> Stream::handshake() {
  ERR_clear_error();
  const int done = SSL_do_handshake(ssl_.get());
  if (done != 1 && SSL_get_error(ssl_.get(), done) != SSL_ERROR_WANT_READ) return fail_handshake();
  auto next = [this, done](bool more) -> kj::Promise<Result<Identity>> {
    if (done == 1) return verified();
    if (!more) {
      problem_ = fail(ErrorCode::Unavailable, other() + " has closed the connection in the TLS handshake");
      return Result<Identity>(*problem_);
    }
    return handshake();
  };
  return flush()
      .then([this, done]() -> kj::Promise<bool> {
        if (done == 1) return true;
        return feed();
      })
      .then(std::move(next), [this](kj::Exception&& exception) -> kj::Promise<Result<Identity>> {
        problem_ =
            fail(ErrorCode::Unavailable, other() + " has broken the connection in the TLS handshake: " +
                                             std::string(exception.getDescription().cStr()));
        return Result<Identity>(*problem_);
      });
}

kj::Promise<Result<Identity>> Stream::fail_handshake() {
  note_problem();
  return send_alert().then([this] { return Result<Identity>(*problem_); });
}

Result<Identity> Stream::verified() const {
  const Certificate certificate(SSL_get1_peer_certificate(ssl_.get()));
  if (!certificate || SSL_get_verify_result(ssl_.get()) != X509_V_OK) {
    return fail(ErrorCode::PermissionDenied, other() + " has shown no certificate");
  }
  return identity_of(certificate.get());
}

kj::Promise<void> Stream::drain() {
  return inner_->tryRead(buffer_.data(), 1, buffer_.size()).then([this](size_t got) -> kj::Promise<void> {
    drained_ += got;
    if (got == 0 || drained_ > kMostDrained) return kj::READY_NOW;
    return drain();
  });
}

void Stream::break_off(Error why) {
  problem_ = std::move(why);
  inner_->abortRead();
  inner_->shutdownWrite();
}

kj::Promise<size_t> Stream::tryRead(void* buffer, size_t minimum, size_t maximum) {
  return read_more(static_cast<kj::byte*>(buffer), minimum, maximum, 0);
}

kj::Promise<size_t> Stream::read_more(kj::byte* buffer, size_t minimum, size_t maximum, size_t done) {
  if (problem_) return KJ_EXCEPTION(DISCONNECTED, problem_->message);
  while (done < minimum) {
    size_t got = 0;
    ERR_clear_error();
    const int good = SSL_read_ex(ssl_.get(), buffer + done, maximum - done, &got);
    done += got;
    if (good == 1) continue;
    switch (SSL_get_error(ssl_.get(), good)) {
      case SSL_ERROR_WANT_READ:
        if (BIO_ctrl_pending(to_send_) > kMostUnasked) {
          problem_ = fail(ErrorCode::ResourceExhausted, other() + " asks for new keys too often");
          return KJ_EXCEPTION(DISCONNECTED, problem_->message);
        }
        return feed().then([=, this](bool more) -> kj::Promise<size_t> {
          if (!more) return done;
          return read_more(buffer, minimum, maximum, done);
        });
      case SSL_ERROR_ZERO_RETURN:
        return done;
      default:
        note_problem();
        return send_alert().then(
            [this]() -> size_t { kj::throwFatalException(KJ_EXCEPTION(DISCONNECTED, problem_->message)); });
    }
  }
  return done;
}

kj::Promise<bool> Stream::feed() {
  return inner_->tryRead(buffer_.data(), 1, buffer_.size()).then([this](size_t got) {
    if (got > 0) BIO_write(received_, buffer_.data(), static_cast<int>(got));
    return got > 0;
  });
}

kj::Promise<void> Stream::write(const void* buffer, size_t size) {
  auto piece = kj::heapArray<kj::ArrayPtr<const kj::byte>>(1);
  piece[0] = kj::arrayPtr(static_cast<const kj::byte*>(buffer), size);
  auto sent = write_from(piece, 0, 0);
  return sent.attach(kj::mv(piece));
}

kj::Promise<void> Stream::write(kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> pieces) {
  return write_from(pieces, 0, 0);
}

kj::Promise<void> Stream::write_from(kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> pieces, size_t piece,
                                     size_t offset) {
  for (std::size_t batch = 0; piece < pieces.size() && batch < kBatch;) {
    const auto rest = pieces[piece].slice(offset, pieces[piece].size());
    if (rest.size() == 0) {
      ++piece;
      offset = 0;
      continue;
    }
    size_t taken = 0;
    ERR_clear_error();
    if (SSL_write_ex(ssl_.get(), rest.begin(), std::min(rest.size(), kBatch), &taken) != 1) {
      note_problem();
      return KJ_EXCEPTION(DISCONNECTED, problem_->message);
    }
    offset += taken;
    batch += taken;
  }
  writing_ = true;
  return flush().then([=, this]() -> kj::Promise<void> {
    writing_ = false;
    if (piece >= pieces.size()) return kj::READY_NOW;
    return write_from(pieces, piece, offset);
  });
}

kj::Promise<void> Stream::flush() {
  const std::size_t size = BIO_ctrl_pending(to_send_);
  if (size == 0) return kj::READY_NOW;
  auto bytes = kj::heapArray<kj::byte>(size);
  const int got = BIO_read(to_send_, bytes.begin(), static_cast<int>(size));
  auto sent = inner_->write(bytes.begin(), static_cast<std::size_t>(std::max(got, 0)));
  return sent.attach(kj::mv(bytes));
}

/// The last that is sent. Not in the midst of other data, and whether it arrives does not matter.
kj::Promise<void> Stream::send_alert() {
  if (writing_) return kj::READY_NOW;
  return flush().then([this] { inner_->shutdownWrite(); }).catch_([](kj::Exception&&) {});
}

void Stream::shutdownWrite() {
  ERR_clear_error();
  SSL_shutdown(ssl_.get());
  closing_ = send_alert().eagerlyEvaluate(nullptr);
}

void Stream::note_problem() {
  if (problem_) return;
  problem_ = problem_from(ERR_peek_error());
  ERR_clear_error();
}

Error Stream::problem_from(unsigned long code) const {
  if (!refusal_.empty()) {
    return fail(ErrorCode::PermissionDenied, "the certificate of " +
                                                 (claimed_name_.empty() ? other() : quote(claimed_name_)) +
                                                 " is refused: " + refusal_);
  }
  return explain(code, other());
}

std::string Stream::other() const {
  return side_ == Side::Client ? "host " + quote(host_) : "the client";
}

kj::Promise<Stream::ReadResult> Stream::tryReadWithFds(void* buffer, size_t minimum, size_t maximum,
                                                       kj::AutoCloseFd*, size_t) {
  return tryRead(buffer, minimum, maximum).then([](size_t got) { return ReadResult{got, 0}; });
}

kj::Promise<void> Stream::writeWithFds(kj::ArrayPtr<const kj::byte> data,
                                       kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>> more,
                                       kj::ArrayPtr<const int> fds) {
  if (fds.size() > 0) return no_descriptors();
  auto pieces = kj::heapArrayBuilder<kj::ArrayPtr<const kj::byte>>(more.size() + 1);
  pieces.add(data);
  pieces.addAll(more);
  auto all = pieces.finish();
  auto sent = write_from(all, 0, 0);
  return sent.attach(kj::mv(all));
}

kj::Promise<Stream::ReadResult> Stream::tryReadWithStreams(void*, size_t, size_t,
                                                           kj::Own<kj::AsyncCapabilityStream>*, size_t) {
  return no_descriptors();
}

kj::Promise<void> Stream::writeWithStreams(kj::ArrayPtr<const kj::byte>,
                                           kj::ArrayPtr<const kj::ArrayPtr<const kj::byte>>,
                                           kj::Array<kj::Own<kj::AsyncCapabilityStream>>) {
  return no_descriptors();
}

}  // namespace segue::control::tls
