// SPDX-License-Identifier: Apache-2.0
#include <segue/web/web_server.hpp>

#include <segue/base/printable.hpp>
#include <segue/base/refusal_log.hpp>
#include <segue/base/text.hpp>
#include <segue/concurrent/thread.hpp>
#include <segue/rpc/connection_table.hpp>
#include <segue/rpc_tls/tls_server.hpp>
#include <segue/web/authenticator.hpp>
#include <segue/web/browser_session.hpp>
#include <segue/web/detail/answer.hpp>
#include <segue/web/detail/browser_stream.hpp>
#include <segue/web/hub.hpp>
#include <segue/web/page_verbs.hpp>

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
using control::ConnectionTable;

using detail::HttpRequest;
using detail::HttpResponse;
using detail::message_page;
using detail::response_of;

constexpr auto kRequestTime = std::chrono::seconds(10);
constexpr auto kIdleTime = std::chrono::seconds(30);
constexpr auto kAcceptPause = std::chrono::milliseconds(100);
constexpr std::uint32_t kLongestHeader = 16 * 1024;
constexpr int kSendBuffer = 256 * 1024;  ///< what a slow browser would get although it is old

std::string text_of(beast::string_view text) {
  return {text.data(), text.size()};
}

/// The IP address in the form that URLs have.
std::string written(const asio::ip::address& address) {
  const asio::ip::address plain = address.is_v6() && address.to_v6().is_v4_mapped()
                                      ? asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6())
                                      : address;
  return plain.is_v6() ? "[" + plain.to_string() + "]" : plain.to_string();
}

class Open;

/// The state that all connections share. Members are destroyed after those that use them.
struct Shared {
  Shared(PageFiles files, const Connect& connect, ServerOptions chosen)
      : page(std::move(files)), options(std::move(chosen)), watching(connect), calling(connect) {}

  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer pause{context};
  asio::steady_timer watch{context};
  PageFiles page;
  ServerOptions options;
  std::uint16_t port = 0;                      ///< from start() on
  std::optional<Authenticator> authenticator;  ///< from listen() on
  RobotLink watching;  ///< apart, so that calls that take long cannot use up the connection's calls
  RobotLink calling;
  Hub hub{watching, options.periods};
  Verbs verbs{calling, options.models, options.run_mission, options.look_at_ros2};
  RefusalLog refusals{"studio"};
  ConnectionTable table;
  std::set<Open*> connections;
  std::uint64_t sockets = 0;  ///< WebSockets so far: their names in logs

  [[nodiscard]] std::string address() const {
    const std::string place = ":" + std::to_string(acceptor.local_endpoint().port());
    if (options.credentials) return "https://" + options.credentials->name() + place + "/";
    return "http://" + written(acceptor.local_endpoint().address()) + place +
           "/?token=" + authenticator->token();
  }
  /// Puts out whose certificate was revoked or has expired.
  void check_certificates() {
    if (options.credentials) table.check(*options.credentials);
  }
};

std::string address_of(const tcp::socket& socket) {
  error_code unknown;
  return written(socket.remote_endpoint(unknown).address());
}

/// A connection that is open, as long as it exists.
class Open {
 public:
  Open(Shared& shared, const std::string& from)
      : shared_(shared), place_(shared.table.add(from, ender())), from_(from) {
    shared_.connections.insert(this);
  }
  /// Goes on with the connection of `before`.
  explicit Open(Open& before)
      : shared_(before.shared_), place_(std::move(before.place_)), from_(before.from_) {
    place_.hand_on(ender());
    shared_.connections.insert(this);
  }
  virtual ~Open() { shared_.connections.erase(this); }
  Open(const Open&) = delete;
  Open& operator=(const Open&) = delete;
  /// Ends the connection as soon as its present operation has noticed.
  virtual void close() = 0;

 protected:
  Shared& shared_;
  ConnectionTable::Place place_;
  const std::string from_;  ///< the address of the other computer

 private:
  ConnectionTable::CutOff ender() {
    return [this](const std::string& why) {
      shared_.refusals.tell("a connection from " + from_, why);
      close();
    };
  }
};

/// The browser at the other end, as far as its certificate says; nothing without TLS.
using Person = std::optional<control::Identity>;

/// A WebSocket: carries the messages of a session.
class Socket final : public Open, public std::enable_shared_from_this<Socket> {
 public:
  Socket(Open& before, detail::BrowserStream stream, Role role, Person person)
      : Open(before), stream_(std::move(stream)), role_(role), person_(std::move(person)) {}

  void start(const HttpRequest& request) {
    beast::get_lowest_layer(stream_).expires_never();
    stream_.set_option(websocket::stream_base::timeout{kRequestTime, kIdleTime, true});
    stream_.read_message_max(kLongestCommand);
    stream_.text(true);
    if (!request[http::field::sec_websocket_protocol].empty()) {
      stream_.set_option(websocket::stream_base::decorator([](websocket::response_type& response) {
        response.set(http::field::sec_websocket_protocol,
                     {Authenticator::kProtocol.data(), Authenticator::kProtocol.size()});
      }));
    }
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
    session_ = Session::create(shared_.hub, shared_.verbs,
                               {role_, shared_.options.robot, who, shared_.options.has_ros2},
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
    shared_.check_certificates();  // which may close this
    if (!session_) return;
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
    if (!ended) shared_.refusals.tell("a browser's message", printable(problem.message()));
    close();
  }

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
      : Open(shared, address_of(socket)), stream_(std::move(socket)) {}

  void start() {
    if (!shared_.options.credentials) return read();
    const auto own = control::server_context(*shared_.options.credentials);
    SSL_CTX_up_ref(own.get());
    asio::ssl::context context(own.get());  // gives it back; the connection holds it, too
    stream_.secure(context);
    tcp_stream().expires_after(ConnectionTable::kTimeToEnter);
    stream_.tls()->async_handshake(asio::ssl::stream_base::server,
                                   [self = shared_from_this()](error_code problem) {
                                     problem ? self->refuse(problem) : self->identify();
                                   });
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(kLongestHeader);
    parser_->body_limit(0);
    tcp_stream().expires_after(place_.has_entered() ? kRequestTime : ConnectionTable::kTimeToEnter);
    http::async_read(
        stream_, buffer_, *parser_, [self = shared_from_this()](error_code problem, std::size_t) {
          if (!problem) return self->handle();
          const bool ended = problem == http::error::end_of_stream || problem == beast::error::timeout ||
                             problem == asio::ssl::error::stream_truncated ||
                             problem == asio::error::operation_aborted;
          if (!ended) self->shared_.refusals.tell("a request", printable(problem.message()));
        });
  }

  void close() override {
    error_code ignored;
    tcp_stream().socket().close(ignored);
  }

 private:
  beast::tcp_stream& tcp_stream() { return stream_.next_layer(); }

  void refuse(error_code problem) {
    if (place_.is_cut_off()) return;
    shared_.refusals.tell("a TLS handshake from " + from_, printable(problem.message()));
  }

  void identify() {
    auto person = control::identity_at(*stream_.tls()->native_handle());
    if (!person) return shared_.refusals.tell("a browser at " + from_, person.error().message);
    person_ = std::move(*person);
    place_.identify(*person_);
    read();
  }

  void handle() {
    request_ = parser_->release();
    shared_.check_certificates();
    if (place_.is_cut_off()) return;
    const bool is_socket = websocket::is_upgrade(request_);
    const auto admission =
        shared_.authenticator->admit({.target = text_of(request_.target()),
                                      .host = text_of(request_[http::field::host]),
                                      .origin = text_of(request_[http::field::origin]),
                                      .cookies = text_of(request_[http::field::cookie]),
                                      .protocols = text_of(request_[http::field::sec_websocket_protocol]),
                                      .is_socket = is_socket,
                                      .address = own_address(),
                                      .certified = certified()});
    if (!admission) return refuse(admission.error());
    if (admission->forgotten != 0)
      place_.cut_off_others(std::to_string(admission->forgotten), "its browser is not known any more");
    if (!admission->new_cookie.empty() && shared_.options.entered) shared_.options.entered(shared_.address());
    if (!place_.enter(person_ ? person_->name : std::to_string(admission->browser))) return have_no_place();
    if (!admission->new_cookie.empty()) return welcome(*admission);
    if (is_socket && request_.target() == "/socket") {
      std::make_shared<Socket>(*this, std::move(stream_), admission->role, person_)->start(request_);
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
    shared_.refusals.tell("a browser at " + from_, error.message);
    send_last(http::status::forbidden,
              "Access denied: " + escape_markup(error.message) +
                  ". Open the address that <code>segue studio</code> has printed last.");
  }

  void have_no_place() {
    shared_.refusals.tell("a connection from " + from_, "all places are taken");
    send_last(http::status::service_unavailable,
              "There are too many connections already. Close some pages of the studio and try again.");
  }

  /// Sends the last response on the connection, to a browser without access.
  void send_last(http::status status, const std::string& text) {
    auto response = response_of(request_, status, "text/html; charset=utf-8", message_page("", text));
    response.keep_alive(false);
    send(std::move(response));
  }

  /// A page of its own instead of a redirection: a browser that came from another page sends no strict cookie
  /// with the request to which it is redirected. The page that follows finds its key behind '#'.
  void welcome(const Authenticator::Admission& admission) {
    auto response = response_of(
        request_, http::status::ok, "text/html; charset=utf-8",
        message_page("<meta http-equiv=\"refresh\" content=\"0;url=/#key=" + admission.new_key + "\">",
                     "Welcome."));
    response.set(http::field::set_cookie, admission.new_cookie);
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
  void watch_certificates();
  void end();
};

Result<void> Server::Implementation::listen() {
  error_code problem;
  const auto own = asio::ip::make_address(options.listen, problem);
  if (problem)
    return fail(ErrorCode::InvalidArgument, quote(options.listen) + " is not an IP address of this computer");
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
  Authenticator::Place entrance{.port = acceptor.local_endpoint().port()};
  if (options.credentials) {
    entrance.scheme = "https";
    entrance.names = options.credentials->identity().addresses;
    entrance.names.push_back(options.credentials->name());
  } else {
    entrance.names.push_back("localhost");
  }
  authenticator.emplace(std::move(entrance), options.role);
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
    std::make_shared<Connection>(*this, std::move(socket))->start();
    accept();
  });
}

void Server::Implementation::watch_certificates() {
  watch.expires_after(ConnectionTable::kWatchPeriod);
  watch.async_wait([this](error_code stopped) {
    if (stopped || !acceptor.is_open()) return;
    check_certificates();
    watch_certificates();
  });
}

void Server::Implementation::end() {
  error_code ignored;
  acceptor.close(ignored);
  pause.cancel();
  watch.cancel();
  const std::vector<Open*> open(connections.begin(), connections.end());
  for (Open* one : open)
    one->close();
}

Server::Server(std::unique_ptr<Implementation> implementation) : implementation_(std::move(implementation)) {}

Result<std::unique_ptr<Server>> Server::start(PageFiles page, const Connect& connect, ServerOptions options) {
  auto all = std::make_unique<Implementation>(std::move(page), connect, std::move(options));
  if (auto listening = all->listen(); !listening) return listening.error();
  all->accept();
  if (all->options.credentials) all->watch_certificates();
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
