// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/rpc_tls/authority.hpp>
#include <segue/rpc_tls/credential_files.hpp>
#include <segue/rpc_tls/openssl.hpp>
#include <support/hostile_client.hpp>
#include <support/logged_lines.hpp>

#include <fcntl.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <sys/socket.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

/// A server on TCP with an authority of its own, and clients that know TLS but obey nobody; for tests only.
namespace segue::control {

/// A client that speaks TLS 1.3, blocks, and verifies nothing.
class RawTls {
 public:
  /// With the certificate and key of that name in the folder, or without one.
  RawTls(std::uint16_t port, const std::filesystem::path& folder, const std::string& name)
      : socket_(detail::connect_tcp({"127.0.0.1", port}, soon()).value()),
        context_(SSL_CTX_new(TLS_client_method())) {
    if (!name.empty()) {
      const std::string base = (folder / name).string();
      EXPECT_EQ(SSL_CTX_use_certificate_file(context_.get(), (base + ".crt").c_str(), SSL_FILETYPE_PEM), 1);
      EXPECT_EQ(SSL_CTX_use_PrivateKey_file(context_.get(), (base + ".key").c_str(), SSL_FILETYPE_PEM), 1);
    }
    const int flags = ::fcntl(socket_.get(), F_GETFL);
    ::fcntl(socket_.get(), F_SETFL, flags & ~O_NONBLOCK);
    const timeval limit{20, 0};
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    ::setsockopt(socket_.get(), SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
    ssl_.reset(SSL_new(context_.get()));
    SSL_set_fd(ssl_.get(), socket_.get());
    EXPECT_EQ(SSL_connect(ssl_.get()), 1);
  }

  /// How much of it went before the server closed.
  std::size_t send(std::string_view bytes) {
    std::size_t sent = 0;
    while (sent < bytes.size()) {
      const int now = SSL_write(ssl_.get(), bytes.data() + sent, static_cast<int>(bytes.size() - sent));
      if (now <= 0) break;
      sent += static_cast<std::size_t>(now);
    }
    return sent;
  }
  /// Past TLS, onto the wire.
  void send_unencrypted(std::string_view bytes) const {
    EXPECT_EQ(::send(socket_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL),
              static_cast<ssize_t>(bytes.size()));
  }
  /// Whether the server closes in time; drops its data until then.
  bool is_closed() {
    char buffer[4096];
    ERR_clear_error();
    while (SSL_read(ssl_.get(), buffer, sizeof buffer) > 0) {
    }
    const unsigned long reason = ERR_peek_last_error();
    alert_ = reason == 0 ? "" : ERR_reason_error_string(reason);
    return errno != EAGAIN || reason != 0 || SSL_get_shutdown(ssl_.get()) != 0;
  }
  /// What the server said as it closed.
  [[nodiscard]] const std::string& alert() const { return alert_; }

 private:
  Descriptor socket_;
  tls::Owned<SSL_CTX, SSL_CTX_free> context_;
  tls::Owned<SSL, SSL_free> ssl_;
  std::string alert_;
};

/// A server named 'left' on TCP, and certificates in the folder `enrolled`.
class SecureTest : public ControlTest {
 protected:
  void SetUp() override {
    ControlTest::SetUp();
    authority_.emplace(Authority::create(folder_ / "ca").value());
    enrolled_ = folder_ / "enrolled";
    enrol({.name = "left", .role = Role::Administer, .host = true});
    enrol({.name = "ann", .role = Role::Operate});
  }
  void TearDown() override {
    ControlTest::TearDown();
    log_.reset();
  }

  Identity enrol(const Enrolment& enrolment) {
    auto identity = authority_->enrol(enrolment, enrolled_);
    EXPECT_TRUE(identity) << to_string(identity.error());
    return identity.value_or(Identity());
  }
  /// Also brings the new list to where the server reads it.
  void revoke(const std::string& name) {
    ASSERT_TRUE(authority_->revoke(name));
    std::filesystem::copy_file(folder_ / "ca" / "ca.crl", enrolled_ / "new.crl");
    std::filesystem::rename(enrolled_ / "new.crl", enrolled_ / "ca.crl");
  }
  Credentials credentials(const std::string& name, CertificateUse use = CertificateUse::Person) {
    auto loaded = load_credentials(enrolled_, use, name);
    EXPECT_TRUE(loaded) << to_string(loaded.error());
    return *loaded;
  }
  TcpPlace place(const std::string& address = "127.0.0.1") {
    return {{address, 0}, credentials("left", CertificateUse::Host)};
  }
  void serve_tcp(Served service) {
    auto server = Server::listen(Places{{}, place()}, service);
    ASSERT_TRUE(server) << to_string(server.error());
    server_ = std::move(*server);
  }
  void serve_tcp() { serve_tcp(&robot_); }

  TcpEndpoint endpoint(const std::string& name, const std::string& host = "left") {
    return {{"127.0.0.1", server_->port()}, host, credentials(name)};
  }
  std::unique_ptr<RobotService> client_of(const std::string& name) {
    auto connected = connect(endpoint(name), kLong);
    EXPECT_TRUE(connected) << to_string(connected.error());
    return connected ? std::move(*connected) : nullptr;
  }

  std::optional<testing::LoggedLines> log_{std::in_place};
  std::optional<Authority> authority_;
  std::filesystem::path enrolled_;
};

}  // namespace segue::control
