// SPDX-License-Identifier: Apache-2.0
#include <segue/web/server.hpp>

#include <segue/base/printable.hpp>
#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/control/tls_server.hpp>
#include <segue/web/detail/browser_stream.hpp>
#include <segue/web/detail/refusals.hpp>
#include <segue/web/gate.hpp>
#include <segue/web/hub.hpp>
#include <segue/web/session.hpp>
#include <segue/web/verbs.hpp>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <unistd.h>

#include <optional>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace segue::web {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

using HttpRequest = http::request<http::empty_body>;
using HttpResponse = http::response<http::string_body>;

constexpr auto kRequestTime = std::chrono::seconds(10);
constexpr auto kIdleTime = std::chrono::seconds(30);
constexpr auto kAcceptPause = std::chrono::milliseconds(100);
constexpr std::uint32_t kLongestHeader = 16 * 1024;
constexpr int kSendBuffer = 256 * 1024;  ///< what a slow browser would get although it is old

std::string text_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// Nothing but the page's own files, no frames around it, nothing about it to others.
void add_policies(HttpResponse& response) {
  response.set(
      "Content-Security-Policy",
      "default-src 'none'; script-src 'self'; worker-src 'self'; style-src 'self'; img-src 'self' data:; "
      "font-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
  response.set("X-Content-Type-Options", "nosniff");
  response.set("X-Frame-Options", "DENY");
  response.set("Referrer-Policy", "no-referrer");
  response.set("Cross-Origin-Opener-Policy", "same-origin");
  response.set("Cross-Origin-Resource-Policy", "same-origin");
  response.set(http::field::cache_control, "no-store");
}

HttpResponse response_of(const HttpRequest& request, http::status status, beast::string_view type,
                         std::string body) {
  HttpResponse response(status, request.version());
  add_policies(response);
  response.set(http::field::content_type, type);
  response.keep_alive(request.keep_alive());
  response.body() = std::move(body);
  response.prepare_payload();
  if (request.method() == http::verb::head) response.body().clear();
  return response;
}

std::string message_page(const std::string& head, const std::string& text) {
  return "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Segue Studio</title>" + head +
         "</head><body><p>" + text + "</p></body></html>\n";
}

/// As in an address of a page.
std::string written(const asio::ip::address& address) {
  const asio::ip::address plain = address.is_v6() && address.to_v6().is_v4_mapped()
                                      ? asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6())
                                      : address;
  return plain.is_v6() ? "[" + plain.to_string() + "]" : plain.to_string();
}

/// A connection that is open, as long as it exists.
class Open {
 public:
  explicit Open(std::set<Open*>& all) : all_(all) { all_.insert(this); }
  virtual ~Open() { all_.erase(this); }
  Open(const Open&) = delete;
  Open& operator=(const Open&) = delete;
  /// It ends as soon as what it is doing has noticed.
  virtual void close() = 0;

 private:
  std::set<Open*>& all_;
};

/// What all connections share, in an order in which what is used ends after what uses it.
struct Shared {
  Shared(PageFiles files, const Connect& connect, ServerOptions chosen)
      : page(std::move(files)), options(std::move(chosen)), watching(connect), calling(connect) {}

  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer pause{context};
  PageFiles page;
  ServerOptions options;
  std::uint16_t port = 0;    ///< from start() on
  std::optional<Gate> gate;  ///< from listen() on
  RobotLink watching;        ///< apart, so that calls that take long cannot use up the connection's calls
  RobotLink calling;
  Hub hub{watching, options.periods};
  Verbs verbs{calling, options.models};
  detail::Refusals refusals;
  std::set<Open*> connections;
  std::uint64_t sockets = 0;  ///< WebSockets so far: their names in logs

  [[nodiscard]] std::string address() const {
    const std::string place = ":" + std::to_string(acceptor.local_endpoint().port());
    if (options.credentials) return "https://" + options.credentials->name() + place + "/";
    return "http://" + written(acceptor.local_endpoint().address()) + place + "/?token=" + gate->token();
  }
};

/// The browser at the other end, as far as its certificate says; nothing without TLS.
using Person = std::optional<control::Identity>;

/// A WebSocket: carries the messages of a session.
class Socket final : public Open, public std::enable_shared_from_this<Socket> {
 public:
  Socket(Shared& shared, detail::BrowserStream stream, Role role, Person person)
      : Open(shared.connections),
        shared_(shared),
        stream_(std::move(stream)),
        role_(role),
        person_(std::move(person)) {}

  void start(const HttpRequest& request) {
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout{kRequestTime, kIdleTime, true});
    stream_.read_message_max(kLongestCommand);
    stream_.text(true);
    stream_.async_accept(request, [self = shared_from_this()](error_code problem) {
      if (!problem) self->begin();
    });
  }

  void close() override {
    session_.reset();
    error_code ignored;
    beast::get_lowest_layer(stream_).socket().close(ignored);
  }

 private:
  void begin() {
    const std::string who = "segue studio (pid " + std::to_string(::getpid()) + ", " +
                            (person_ ? person_->name : "uid " + std::to_string(::getuid())) + ", browser " +
                            std::to_string(++shared_.sockets) + ")";
    session_ = Session::create(shared_.hub, shared_.verbs, {role_, shared_.options.robot, who},
                               [weak = weak_from_this(), &context = shared_.context] {
                                 asio::post(context, [weak] {
                                   if (const auto self = weak.lock()) self->pump();
                                 });
                               });
    pump();
  }

  /// Sends and reads what is possible now.
  void pump() {
    if (!session_) return;
    if (!sending_) sending_ = session_->next();
    if (sending_ && !is_sending_) {
      is_sending_ = true;
      stream_.async_write(asio::buffer(*sending_),
                          [self = shared_from_this()](error_code problem, std::size_t) {
                            self->is_sending_ = false;
                            self->sending_.reset();
                            problem ? self->close() : self->pump();
                          });
    }
    if (!is_reading_ && !session_->is_full()) {
      is_reading_ = true;
      stream_.async_read(buffer_, [self = shared_from_this()](error_code problem, std::size_t) {
        self->is_reading_ = false;
        problem ? self->refuse(problem) : self->take();
      });
    }
  }

  void take() {
    if (!session_) return;
    if (const auto refusal =
            person_ ? control::refusal(*shared_.options.credentials, *person_) : std::nullopt) {
      shared_.refusals.add("a browser's message: " + refusal->message);
      return close();
    }
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    session_->receive(stream_.got_text() ? std::string_view(text) : "a binary message");
    pump();
  }

  void refuse(error_code problem) {
    const bool ended = problem == websocket::error::closed || problem == asio::error::eof ||
                       problem == asio::ssl::error::stream_truncated ||
                       problem == asio::error::connection_reset ||
                       problem == asio::error::operation_aborted || problem == beast::error::timeout;
    if (!ended) shared_.refusals.add("a browser's message: " + printable(problem.message()));
    close();
  }

  Shared& shared_;
  websocket::stream<detail::BrowserStream> stream_;
  const Role role_;
  const Person person_;
  beast::flat_buffer buffer_;
  std::shared_ptr<Session> session_;
  std::optional<std::string> sending_;
  bool is_sending_ = false;
  bool is_reading_ = false;
};

/// A connection until it asks for a WebSocket.
class Connection final : public Open, public std::enable_shared_from_this<Connection> {
 public:
  Connection(Shared& shared, tcp::socket socket)
      : Open(shared.connections), shared_(shared), stream_(std::move(socket)) {}

  void start() {
    if (!shared_.options.credentials) return read();
    const auto own = control::server_context(*shared_.options.credentials);
    SSL_CTX_up_ref(own.get());
    asio::ssl::context context(own.get());  // gives it back; the connection holds it, too
    stream_.secure(context);
    tcp_stream().expires_after(kRequestTime);
    stream_.tls()->async_handshake(asio::ssl::stream_base::server,
                                   [self = shared_from_this()](error_code problem) {
                                     problem ? self->refuse(problem) : self->identify();
                                   });
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(kLongestHeader);
    parser_->body_limit(0);
    tcp_stream().expires_after(kRequestTime);
    http::async_read(
        stream_, buffer_, *parser_, [self = shared_from_this()](error_code problem, std::size_t) {
          if (!problem) return self->handle();
          const bool ended = problem == http::error::end_of_stream || problem == beast::error::timeout ||
                             problem == asio::ssl::error::stream_truncated ||
                             problem == asio::error::operation_aborted;
          if (!ended) self->shared_.refusals.add("a request: " + printable(problem.message()));
        });
  }

  void close() override {
    error_code ignored;
    tcp_stream().socket().close(ignored);
  }

 private:
  beast::tcp_stream& tcp_stream() { return stream_.next_layer(); }

  void refuse(error_code problem) {
    error_code unknown;
    const auto from = tcp_stream().socket().remote_endpoint(unknown).address();
    shared_.refusals.add("a TLS handshake from " + written(from) + ": " + printable(problem.message()));
  }

  void identify() {
    auto person = control::identity_at(*stream_.tls()->native_handle());
    if (!person) return shared_.refusals.add(person.error().message);
    person_ = std::move(*person);
    read();
  }

  void handle() {
    request_ = parser_->release();
    const bool is_socket = websocket::is_upgrade(request_);
    const auto admission = shared_.gate->admit({.target = text_of(request_.target()),
                                                .host = text_of(request_[http::field::host]),
                                                .origin = text_of(request_[http::field::origin]),
                                                .cookies = text_of(request_[http::field::cookie]),
                                                .is_socket = is_socket,
                                                .address = own_address(),
                                                .certified = certified()});
    if (!admission) return refuse(admission.error());
    if (!admission->new_cookie.empty()) return welcome(*admission);
    if (is_socket && request_.target() == "/socket") {
      std::make_shared<Socket>(shared_, std::move(stream_), admission->role, person_)->start(request_);
      return;
    }
    serve();
  }

  [[nodiscard]] std::string own_address() {
    error_code unknown;
    return written(tcp_stream().socket().local_endpoint(unknown).address());
  }
  [[nodiscard]] std::optional<Role> certified() const {
    if (!person_) return std::nullopt;
    return person_->role;
  }

  void refuse(const Error& error) {
    shared_.refusals.add(error.message);
    send(response_of(
        request_, http::status::forbidden, "text/html; charset=utf-8",
        message_page("", "You cannot enter: " + escape_markup(error.message) +
                             ". Open the address that <code>segue studio</code> has printed last.")));
  }

  /// A page of its own instead of a redirection: a browser that came from another page sends no strict cookie
  /// with the request to which it is redirected.
  void welcome(const Gate::Admission& admission) {
    auto response =
        response_of(request_, http::status::ok, "text/html; charset=utf-8",
                    message_page("<meta http-equiv=\"refresh\" content=\"0;url=/\">", "Welcome."));
    response.set(http::field::set_cookie, admission.new_cookie);
    if (shared_.options.entered) shared_.options.entered(shared_.address());
    send(std::move(response));
  }

  void serve() {
    if (request_.method() != http::verb::get && request_.method() != http::verb::head)
      return send(
          response_of(request_, http::status::method_not_allowed, "text/plain", "only GET and HEAD\n"));
    const std::string target = text_of(request_.target());
    const auto* file = shared_.page.find(std::string_view(target).substr(0, target.find('?')));
    if (file == nullptr)
      return send(response_of(request_, http::status::not_found, "text/plain", "not found\n"));
    send(response_of(request_, http::status::ok, {file->type.data(), file->type.size()}, file->content));
  }

  void send(HttpResponse response) {
    response_ = std::move(response);
    tcp_stream().expires_after(kRequestTime);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code problem, std::size_t) {
      if (problem) return;
      if (self->response_.keep_alive()) return self->read();
      error_code ignored;
      self->tcp_stream().socket().shutdown(tcp::socket::shutdown_send, ignored);
    });
  }

  Shared& shared_;
  detail::BrowserStream stream_;
  Person person_;
  beast::flat_buffer buffer_{kLongestHeader + 1024};
  std::optional<http::request_parser<http::empty_body>> parser_;
  HttpRequest request_;
  HttpResponse response_;
};

}  // namespace

struct Server::Implementation : Shared {
  using Shared::Shared;
  std::thread thread;

  Result<void> listen();
  void accept();
  void end();
};

Result<void> Server::Implementation::listen() {
  error_code problem;
  const auto own = asio::ip::make_address(options.listen, problem);
  if (problem)
    return fail(ErrorCode::InvalidArgument, quote(options.listen) + " is no IP address of this computer");
  if (!options.credentials && !own.is_loopback())
    return fail(ErrorCode::InvalidArgument,
                "other computers reach the studio only with certificates: give it those of a host");
  const tcp::endpoint place(own, options.port);
  acceptor.open(place.protocol(), problem);
  if (!problem) acceptor.set_option(tcp::acceptor::reuse_address(true), problem);
  if (!problem) acceptor.bind(place, problem);
  if (!problem) acceptor.listen(asio::socket_base::max_listen_connections, problem);
  if (problem == asio::error::address_in_use)
    return fail(ErrorCode::AlreadyExists, "port " + std::to_string(options.port) +
                                              " is taken by another program; choose another with --port");
  if (problem)
    return system_error("cannot listen at " + written(own) + ":" + std::to_string(options.port),
                        problem.value());
  Gate::Place entrance{.port = acceptor.local_endpoint().port()};
  if (options.credentials) {
    entrance.scheme = "https";
    entrance.names.push_back(options.credentials->name());
  } else {
    entrance.names.push_back("localhost");
  }
  gate.emplace(std::move(entrance), options.role, KnownBrowsers(options.browsers));
  return {};
}

void Server::Implementation::accept() {
  acceptor.async_accept([this](error_code problem, tcp::socket socket) {
    if (!acceptor.is_open()) return;
    if (problem) {  // no descriptors left: later there may be some
      pause.expires_after(kAcceptPause);
      return pause.async_wait([this](error_code stopped) {
        if (!stopped && acceptor.is_open()) accept();
      });
    }
    error_code as_it_is;
    socket.set_option(asio::socket_base::send_buffer_size(kSendBuffer), as_it_is);
    if (connections.size() < kMostConnections) {
      std::make_shared<Connection>(*this, std::move(socket))->start();
    } else {
      refusals.add("a connection, since there are " + std::to_string(connections.size()) + " already");
    }
    accept();
  });
}

void Server::Implementation::end() {
  error_code ignored;
  acceptor.close(ignored);
  pause.cancel();
  const std::vector<Open*> open(connections.begin(), connections.end());
  for (Open* one : open)
    one->close();
}

Server::Server(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}

Result<std::unique_ptr<Server>> Server::start(PageFiles page, const Connect& connect, ServerOptions options) {
  auto all = std::make_unique<Implementation>(std::move(page), connect, std::move(options));
  if (auto listening = all->listen(); !listening) return listening.error();
  all->accept();
  all->port = all->acceptor.local_endpoint().port();
  all->thread = concurrent::start_thread("segue-studio", [shared = all.get()] { shared->context.run(); });
  return std::unique_ptr<Server>(new Server(std::move(all)));
}

Server::~Server() {
  asio::post(implementation_->context, [all = implementation_.get()] { all->end(); });
  implementation_->thread.join();  // when nothing is in progress any more
}

std::uint16_t Server::port() const {
  return implementation_->port;
}

std::string Server::address() const {
  return implementation_->address();
}

}  // namespace segue::web
