// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>

#include <memory>
#include <utility>

namespace segue::web::detail {

/// A connection with a browser, with or without TLS: an AsyncStream as Boost.Beast has them.
class BrowserStream {
 public:
  using executor_type = boost::beast::tcp_stream::executor_type;
  using next_layer_type = boost::beast::tcp_stream;
  using Tls = boost::asio::ssl::stream<boost::beast::tcp_stream&>;

  explicit BrowserStream(boost::asio::ip::tcp::socket socket)
      : tcp_(std::make_unique<boost::beast::tcp_stream>(std::move(socket))) {}

  /// Uses TLS from now on; the handshake comes first. `context` must outlive this.
  void secure(boost::asio::ssl::context& context) { tls_ = std::make_unique<Tls>(*tcp_, context); }
  /// Null without TLS.
  [[nodiscard]] Tls* tls() { return tls_.get(); }

  executor_type get_executor() { return tcp_->get_executor(); }
  next_layer_type& next_layer() { return *tcp_; }
  [[nodiscard]] const next_layer_type& next_layer() const { return *tcp_; }

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    tls_ ? tls_->async_read_some(buffers, std::forward<Handler>(handler))
         : tcp_->async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    tls_ ? tls_->async_write_some(buffers, std::forward<Handler>(handler))
         : tcp_->async_write_some(buffers, std::forward<Handler>(handler));
  }

 private:
  std::unique_ptr<boost::beast::tcp_stream> tcp_;
  std::unique_ptr<Tls> tls_;
};

/// How a WebSocket ends, as Boost.Beast asks for it. A WebSocket says itself that it ends, so TLS need not.
inline void teardown(boost::beast::role_type role, BrowserStream& stream,
                     boost::system::error_code& problem) {
  boost::beast::websocket::teardown(role, stream.next_layer().socket(), problem);
}
template <class Handler>
void async_teardown(boost::beast::role_type role, BrowserStream& stream, Handler&& handler) {
  boost::beast::websocket::async_teardown(role, stream.next_layer().socket(), std::forward<Handler>(handler));
}

}  // namespace segue::web::detail
