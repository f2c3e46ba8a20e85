// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <segue/type/json.hpp>
#include <segue/type/value.hpp>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/ssl.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>
#include <boost/beast/websocket/ssl.hpp>

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>

/// For tests of the studio's server.
namespace segue::testing {

namespace asio = boost::asio;
namespace beast = boost::beast;

/// A browser that speaks TLS with a certificate, or without. What has not been answered within kTimeToAnswer
/// ends its connection.
class Browser {
 public:
  static constexpr std::chrono::seconds kTimeToAnswer{20};

  /// `name`: of the certificate in that folder; empty: it has none.
  Browser(std::uint16_t port, const std::filesystem::path& folder, const std::string& name)
      : port_(port), tls_(asio::ssl::context::tls_client) {
    tls_.load_verify_file((folder / "ca.crt").string());
    tls_.set_verify_mode(asio::ssl::verify_peer);
    if (!name.empty()) {
      tls_.use_certificate_file((folder / (name + ".crt")).string(), asio::ssl::context::pem);
      tls_.use_private_key_file((folder / (name + ".key")).string(), asio::ssl::context::pem);
    }
    stream_.emplace(context_, tls_);
    auto& layer = stream_->next_layer();
    layer.set_verify_callback(asio::ssl::host_name_verification("left"));
    layer.next_layer().connect({asio::ip::address_v4::loopback(), port}, problem_);
    in_time([&](auto done) { layer.async_handshake(asio::ssl::stream_base::client, done); });
  }

  /// Whether the server ends a WebSocket of which nothing more is asked; what it sends until then is dropped.
  bool is_ended() {
    while (receive()) {
    }
    return problem_ && !is_late_;
  }
  /// The answer to bytes that are sent as they are, until the server closes; a request for a page should say
  /// that this is its last.
  std::string exchange(const std::string& bytes) {
    in_time([&](auto done) { asio::async_write(stream_->next_layer(), asio::buffer(bytes), done); });
    std::string answer;
    in_time([&](auto done) { asio::async_read(stream_->next_layer(), asio::dynamic_buffer(answer), done); });
    return answer;
  }
  /// No answer has come in time.
  [[nodiscard]] bool is_late() const { return is_late_; }
  /// The status of the answer, 0 where the connection has ended.
  unsigned get(const std::string& host) {
    beast::http::request<beast::http::empty_body> request(beast::http::verb::get, "/", 11);
    request.set(beast::http::field::host, host);
    in_time([&](auto done) { beast::http::async_write(stream_->next_layer(), request, done); });
    beast::http::response<beast::http::string_body> response;
    beast::flat_buffer buffer;
    in_time([&](auto done) { beast::http::async_read(stream_->next_layer(), buffer, response, done); });
    return problem_ ? 0 : response.result_int();
  }
  /// Asks for a WebSocket; whether it got one.
  bool enter(const std::string& origin = "") {
    const std::string host = "left:" + std::to_string(port_);
    stream_->set_option(
        beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
          request.set("Origin", origin.empty() ? "https://" + host : origin);
        }));
    in_time([&](auto done) { stream_->async_handshake(host, "/socket", done); });
    return !problem_;
  }
  /// Nothing where the connection has ended.
  std::optional<type::Value> receive() {
    beast::flat_buffer buffer;
    in_time([&](auto done) { stream_->async_read(buffer, done); });
    if (problem_) return std::nullopt;
    return type::parse_json(beast::buffers_to_string(buffer.data())).value();
  }
  void send(const std::string& text) {
    in_time([&](auto done) { stream_->async_write(asio::buffer(text), done); });
  }
  /// The answer to a message; updates are dropped.
  std::optional<type::Value> ask(const std::string& text) {
    send(text);
    while (auto message = receive()) {
      if (message->find("id") != nullptr) return message;
    }
    return std::nullopt;
  }

 private:
  /// Begins something unless there is a problem already, and waits for it.
  template <class Begin>
  void in_time(Begin begin) {
    if (problem_) return;
    bool is_done = false;
    begin([&](boost::system::error_code problem, auto...) {
      problem_ = problem;
      is_done = true;
    });
    context_.restart();
    context_.run_for(kTimeToAnswer);
    if (is_done) return;
    is_late_ = true;
    boost::system::error_code ignored;
    beast::get_lowest_layer(*stream_).close(ignored);
    context_.run();
  }

  const std::uint16_t port_;
  asio::io_context context_;
  asio::ssl::context tls_;
  std::optional<beast::websocket::stream<asio::ssl::stream<asio::ip::tcp::socket>>> stream_;
  boost::system::error_code problem_;
  bool is_late_ = false;
};

}  // namespace segue::testing
