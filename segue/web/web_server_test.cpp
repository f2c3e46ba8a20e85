// SPDX-License-Identifier: Apache-2.0
#include <segue/base/descriptor.hpp>
#include <segue/web/authenticator.hpp>
#include <segue/web/test_support.hpp>
#include <segue/web/web_server.hpp>

#include <boost/asio/connect.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <random>

namespace segue::web {
namespace {

namespace beast = boost::beast;
using type::Value;
using Tcp = boost::asio::ip::tcp;

/// A client that speaks no protocol of its own.
class RawSocket {
 public:
  explicit RawSocket(std::uint16_t port) : descriptor_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in place{};
    place.sin_family = AF_INET;
    place.sin_port = htons(port);
    place.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(descriptor_.get(), reinterpret_cast<const sockaddr*>(&place), sizeof place), 0);
  }
  void send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const auto sent = ::send(descriptor_.get(), bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return;  // the server has closed
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
  }
  /// All until the server closes, or until `end` is in it.
  [[nodiscard]] std::string receive(const std::string& end = "\x01") const {
    std::string all;
    char buffer[4096];
    while (all.find(end) == std::string::npos) {
      pollfd entry{descriptor_.get(), POLLIN, 0};
      if (::poll(&entry, 1, 20'000) <= 0) return all + "\nTIMEOUT";
      const auto got = ::recv(descriptor_.get(), buffer, sizeof buffer, 0);
      if (got <= 0) break;
      all.append(buffer, static_cast<std::size_t>(got));
    }
    return all;
  }

 private:
  Descriptor descriptor_;
};

class ServerTest : public WebTest {
 protected:
  void start(Role role = Role::Operate) {
    std::filesystem::create_directories(folder_ / "page" / "assets");
    std::ofstream(folder_ / "page" / "index.html") << "<title>the page</title>";
    std::ofstream(folder_ / "page" / "assets" / "a.js") << "let a;";
    std::ofstream(folder_ / "secret.txt") << "a secret";
    std::ofstream(folder_ / "page" / "program.exe") << "a secret";
    std::filesystem::create_symlink(folder_ / "secret.txt", folder_ / "page" / "link.txt");
    auto page = PageFiles::read(folder_ / "page");
    ASSERT_TRUE(page) << to_string(page.error());
    auto server = Server::start(
        std::move(*page), connection(),
        {.role = role, .robot = "fake", .periods = {.snapshots = std::chrono::milliseconds(20)}});
    ASSERT_TRUE(server) << to_string(server.error());
    server_ = std::move(*server);
    host_ = "127.0.0.1:" + std::to_string(server_->port());
  }
  void TearDown() override {
    robot_.release.open();
    server_.reset();
    WebTest::TearDown();
  }

  [[nodiscard]] std::string ask(const std::string& request) const {
    const RawSocket raw(server_->port());
    raw.send(request);
    return raw.receive();
  }
  [[nodiscard]] std::string get(const std::string& target, const std::string& headers) const {
    return ask("GET " + target + " HTTP/1.1\r\nConnection: close\r\n" + headers + "\r\n");
  }
  [[nodiscard]] std::string host() const { return "Host: " + host_ + "\r\n"; }
  [[nodiscard]] std::string origin() const { return "Origin: http://" + host_ + "\r\n"; }
  [[nodiscard]] std::string cookie() const { return "Cookie: " + cookie_ + "\r\n"; }
  static std::string upgrade() {
    return "Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: "
           "dGhlIHNhbXBsZSBub25jZQ==\r\n";
  }
  [[nodiscard]] std::string key() const { return "Sec-WebSocket-Protocol: " + protocols_ + "\r\n"; }
  [[nodiscard]] std::string upgrade_with(const std::string& headers) const {
    const RawSocket raw(server_->port());
    raw.send("GET /socket HTTP/1.1\r\nConnection: Upgrade\r\n" + upgrade() + headers + "\r\n");
    return raw.receive("\r\n\r\n");
  }

  /// Brings the token, keeps the cookie.
  void enter() {
    const std::string address = server_->address();
    const std::string answer = get(address.substr(address.find("/?")), host());
    const std::string begin = "Set-Cookie: ";
    const auto at = answer.find(begin);
    ASSERT_NE(at, std::string::npos) << answer;
    cookie_ = answer.substr(at + begin.size(), answer.find(';', at) - at - begin.size());
    const std::string before_key = "url=/#key=";
    const auto key_at = answer.find(before_key);
    ASSERT_NE(key_at, std::string::npos) << answer;
    protocols_ = "segue.studio, key." + answer.substr(key_at + before_key.size(), 64);
  }

  std::unique_ptr<Server> server_;
  std::string host_;
  std::string cookie_;
  std::string protocols_;
};

/// A browser's WebSocket.
class Client {
 public:
  /// The system keeps about `buffer` bytes of what the client has not read, or as many as it likes.
  Client(std::uint16_t port, const std::string& cookie, const std::string& protocols, int buffer = 0) {
    boost::asio::ip::tcp::socket& socket = stream_.next_layer();
    socket.open(boost::asio::ip::tcp::v4());
    if (buffer > 0) socket.set_option(boost::asio::socket_base::receive_buffer_size(buffer));
    socket.connect({boost::asio::ip::address_v4::loopback(), port});
    const std::string host = "127.0.0.1:" + std::to_string(port);
    stream_.set_option(beast::websocket::stream_base::decorator([&](beast::websocket::request_type& request) {
      request.set("Origin", "http://" + host);
      request.set("Cookie", cookie);
      request.set("Sec-WebSocket-Protocol", protocols);
    }));
    stream_.handshake(host, "/socket", problem_);
  }
  [[nodiscard]] bool works() const { return !problem_; }
  void send(const std::string& text) { stream_.write(boost::asio::buffer(text), problem_); }
  /// Nothing where the connection has ended.
  std::optional<Value> receive() {
    beast::flat_buffer buffer;
    stream_.read(buffer, problem_);
    if (problem_) return std::nullopt;
    return type::parse_json(beast::buffers_to_string(buffer.data())).value();
  }
  /// The answer to a message; updates are dropped.
  Value ask(const std::string& text) {
    send(text);
    while (auto message = receive()) {
      if (message->find("id") != nullptr) return *message;
    }
    return {};
  }
  /// Whether the server ends it, though nothing more is asked; what it sends until then is dropped.
  bool is_ended() {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    const int socket = stream_.next_layer().native_handle();
    char dropped[4096];
    while (std::chrono::steady_clock::now() < deadline) {
      pollfd entry{socket, POLLIN, 0};
      if (::poll(&entry, 1, 1000) > 0 && ::recv(socket, dropped, sizeof dropped, 0) <= 0) return true;
    }
    return false;
  }
  beast::websocket::stream<Tcp::socket>& stream() { return stream_; }

 private:
  boost::asio::io_context context_;
  beast::websocket::stream<Tcp::socket> stream_{context_};
  boost::system::error_code problem_;
};

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST_F(ServerTest, ThePageIsServedWithStrictPolicies) {
  start();
  enter();
  const std::string answer = get("/", host() + cookie());
  EXPECT_TRUE(contains(answer, "200 OK")) << answer;
  EXPECT_TRUE(contains(answer, "<title>the page</title>"));
  EXPECT_TRUE(contains(answer, "default-src 'none'"));
  EXPECT_FALSE(contains(answer, "unsafe"));
  EXPECT_TRUE(contains(answer, "X-Content-Type-Options: nosniff"));
  EXPECT_TRUE(contains(answer, "Referrer-Policy: no-referrer"));
  EXPECT_TRUE(contains(get("/assets/a.js?v=1", host() + cookie()), "text/javascript"));
}

TEST_F(ServerTest, WithoutTokenOnlyARefusalIsServed) {
  start();
  EXPECT_TRUE(contains(get("/", host()), "403 Forbidden"));
  EXPECT_TRUE(contains(get("/assets/a.js", host()), "403 Forbidden"));
  EXPECT_TRUE(contains(get("/?token=<b>", host()), "403 Forbidden"));
  EXPECT_TRUE(contains(upgrade_with(host() + origin()), "403 Forbidden"));
}

TEST_F(ServerTest, ForeignHostsAndPagesAreRefused) {
  start();
  enter();
  EXPECT_TRUE(contains(get("/", "Host: evil.example\r\n" + cookie()), "403 Forbidden"));
  EXPECT_TRUE(contains(get("/", cookie()), "403 Forbidden"));
  EXPECT_TRUE(contains(upgrade_with(host() + cookie() + key()), "403 Forbidden"));
  EXPECT_TRUE(
      contains(upgrade_with(host() + cookie() + key() + "Origin: http://evil.example\r\n"), "403 Forbidden"));
  EXPECT_TRUE(
      contains(upgrade_with("Host: evil.example\r\nOrigin: http://evil.example\r\n" + cookie() + key()),
               "403 Forbidden"));
  EXPECT_TRUE(contains(upgrade_with(host() + cookie() + key() + origin()), "101 Switching"));
}

TEST_F(ServerTest, ACookieThatAnotherServerHasGotOpensNoSocket) {
  start();
  enter();
  EXPECT_TRUE(contains(upgrade_with(host() + cookie() + origin()), "403 Forbidden"));
  EXPECT_FALSE(contains(get("/", host() + cookie()), protocols_.substr(protocols_.rfind('.') + 1)));
}

TEST_F(ServerTest, ThePageHearsWhichProtocolWasChosen) {
  start();
  enter();
  EXPECT_TRUE(contains(upgrade_with(host() + cookie() + key() + origin()),
                       "Sec-WebSocket-Protocol: segue.studio\r\n"));
}

TEST_F(ServerTest, OnlyFilesOfThePageAreServed) {
  start();
  enter();
  for (const std::string target :
       {"/../secret.txt", "/assets/../../secret.txt", "/%2e%2e/secret.txt", "/..%2fsecret.txt", "/link.txt",
        "//etc/passwd", "/assets", "/assets/", "/program.exe", "/assets\\..\\..\\secret.txt",
        "/index.html%00.js", "http://127.0.0.1/secret.txt", "*"}) {
    const std::string answer = get(target, host() + cookie());
    EXPECT_FALSE(contains(answer, "a secret") || contains(answer, "root:") || contains(answer, "200 OK"))
        << target;
  }
  EXPECT_TRUE(contains(
      ask("POST / HTTP/1.1\r\nConnection: close\r\nContent-Length: 0\r\n" + host() + cookie() + "\r\n"),
      "405"));
}

TEST_F(ServerTest, GarbageAndHugeHeadersEndOnlyTheirConnection) {
  start();
  enter();
  Client good(server_->port(), cookie_, protocols_);
  ASSERT_TRUE(good.works());
  good.receive();
  std::mt19937 random(1);
  for (int round = 0; round < 50; ++round) {
    std::string bytes(1 + random() % 3000, '\0');
    for (char& byte : bytes)
      byte = static_cast<char>(random());
    bytes += "\r\n\r\n";
    const std::string answer = ask(bytes);
    EXPECT_FALSE(contains(answer, "TIMEOUT") || contains(answer, "200 OK"));
  }
  EXPECT_FALSE(contains(get("/", host() + cookie() + "X: " + std::string(100'000, 'x') + "\r\n"), "200 OK"));
  EXPECT_FALSE(contains(
      ask("POST / HTTP/1.1\r\nContent-Length: 99999999\r\n" + host() + cookie() + "\r\nbody"), "200 OK"));
  EXPECT_EQ(good.ask(R"({"id": 1, "verb": "status"})"),
            Value::map({{"id", 1}, {"result", Value::map({{"robot", "fake"}})}}));
}

TEST_F(ServerTest, OversizedAndBrokenFramesEndOnlyTheirConnection) {
  start();
  enter();
  Client good(server_->port(), cookie_, protocols_);
  good.receive();
  Client large(server_->port(), cookie_, protocols_);
  ASSERT_TRUE(large.works());
  large.receive();
  large.send(std::string((std::size_t{1} << 20) + 1, ' '));
  while (large.receive()) {
  }
  const RawSocket raw(server_->port());
  raw.send("GET /socket HTTP/1.1\r\nConnection: Upgrade\r\n" + upgrade() + host() + origin() + cookie() +
           key() + "\r\n");
  EXPECT_TRUE(contains(raw.receive("\r\n\r\n"), "101"));
  raw.send(std::string("\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff\xff", 16));
  EXPECT_FALSE(contains(raw.receive(), "TIMEOUT"));
  good.stream().binary(true);
  EXPECT_NE(good.ask("\x01\x02").find("error"), nullptr) << "binary messages are not commands";
  good.stream().binary(false);
  EXPECT_NE(good.ask(R"({"id": 1, "verb": "status"})").find("result"), nullptr);
}

TEST_F(ServerTest, SilentConnectionsKeepNobodyOut) {
  start();
  std::vector<std::unique_ptr<RawSocket>> crowd;
  while (crowd.size() < 200)
    crowd.push_back(std::make_unique<RawSocket>(server_->port()));
  EXPECT_NO_FATAL_FAILURE(enter());
  EXPECT_TRUE(contains(get("/", host() + cookie()), "200 OK"));
  EXPECT_EQ(crowd.front()->receive(), "") << "the oldest one was closed";
}

TEST_F(ServerTest, ASilentConnectionIsClosed) {
  start();
  const RawSocket silent(server_->port());
  EXPECT_EQ(silent.receive(), "");
}

TEST_F(ServerTest, OneBrowsersConnectionsKeepNoOtherOut) {
  start();
  enter();
  std::vector<std::unique_ptr<Client>> crowd;
  while (crowd.size() < 64) {
    crowd.push_back(std::make_unique<Client>(server_->port(), cookie_, protocols_));
    ASSERT_TRUE(crowd.back()->works());
  }
  EXPECT_TRUE(contains(get("/", host() + cookie()), "503 Service Unavailable")) << "it has all places";
  enter();
  Client other(server_->port(), cookie_, protocols_);
  EXPECT_NE(other.ask(R"({"id": 1, "verb": "status"})").find("result"), nullptr);
}

TEST_F(ServerTest, ABrowserThatIsForgottenIsPutOut) {
  start();
  enter();
  Client oldest(server_->port(), cookie_, protocols_);
  enter();
  Client second(server_->port(), cookie_, protocols_);
  for (std::size_t more = 2; more <= Authenticator::kMostBrowsers; ++more)
    enter();
  EXPECT_TRUE(oldest.is_ended());
  EXPECT_EQ(second.ask(R"({"id": 1, "verb": "status"})").find("error"), nullptr);
}

TEST_F(ServerTest, RefusedRequestsKeepNobodyOut) {
  start();
  std::vector<std::unique_ptr<RawSocket>> crowd;
  while (crowd.size() < 200) {
    crowd.push_back(std::make_unique<RawSocket>(server_->port()));
    crowd.back()->send("GET / HTTP/1.1\r\n" + host() + "\r\n");
  }
  EXPECT_NO_FATAL_FAILURE(enter());
  EXPECT_TRUE(contains(get("/", host() + cookie()), "200 OK"));
}

TEST_F(ServerTest, AThousandConnectionsDisturbNobodyWhoIsIn) {
  start();
  enter();
  Client good(server_->port(), cookie_, protocols_);
  good.receive();
  {
    std::vector<std::unique_ptr<RawSocket>> many;
    for (int count = 0; count < 1000; ++count) {
      // More descriptors than a process may have are not part of this test.
      if (count % 250 == 0) many.clear();
      many.push_back(std::make_unique<RawSocket>(server_->port()));
      many.back()->send("GET ");
    }
    EXPECT_NE(good.ask(R"({"id": 1, "verb": "status"})").find("result"), nullptr);
  }
  EXPECT_TRUE(eventually([&] { return contains(get("/", host() + cookie()), "200 OK"); }))
      << "there is room again";
}

TEST_F(ServerTest, AnObserverCannotOperate) {
  start(Role::Observe);
  enter();
  Client client(server_->port(), cookie_, protocols_);
  const auto greeting = client.receive();
  ASSERT_TRUE(greeting);
  EXPECT_EQ(*greeting, Value::map({{"role", "observe"}, {"robot", "fake"}}));
  const Value answer =
      client.ask(R"({"id": 1, "verb": "set", "arguments": {"task": "t", "property": "p", "value": 1}})");
  EXPECT_EQ(*answer.find("error")->find("code"), Value("permission-denied"));
  EXPECT_EQ(robot_.last_set(), Value());
}

TEST_F(ServerTest, AReaderThatDoesNotReadHoldsNobodyUp) {
  start();
  enter();
  Client slow(server_->port(), cookie_, protocols_, 65536);
  Client quick(server_->port(), cookie_, protocols_);
  slow.receive();
  quick.receive();
  for (Client* client : {&slow, &quick})
    client->send(R"({"id": 1, "verb": "subscribe", "arguments": {"document": "status"}})");
  // More than the system's buffer for sending holds (tcp_wmem: 4 MB), so that the slow one's connection is
  // stuck.
  std::uint64_t version = 0;
  for (int number = 0; number < 9; ++number) {
    robot_.show(
        Value::map({{"number", number}, {"text", std::string(1'000'000, static_cast<char>('a' + number))}}));
    for (bool seen = false; !seen;) {
      const auto update = quick.receive();
      ASSERT_TRUE(update);
      const Value* of =
          update->find("change") != nullptr ? update->find("change")->find("set") : update->find("value");
      const Value* shown = of == nullptr ? nullptr : of->find("number");
      seen = shown != nullptr && *shown == Value(number);
      if (seen) version = update->find("version")->as_uint();
    }
  }
  std::uint64_t skipped = 0;
  for (std::uint64_t reached = 0; reached < version;) {
    const auto update = slow.receive();
    ASSERT_TRUE(update);
    if (update->find("document") == nullptr) continue;
    reached = update->find("version")->as_uint();
    skipped += update->find("skipped")->as_uint();
  }
  EXPECT_GT(skipped, 0U) << "it was told what it has missed";
}

TEST_F(ServerTest, ItEndsWhileBrowsersAreIn) {
  start();
  enter();
  Client client(server_->port(), cookie_, protocols_);
  client.receive();
  client.send(R"({"id": 1, "verb": "subscribe", "arguments": {"document": "events"}})");
  server_.reset();
  while (client.receive()) {
  }
  EXPECT_FALSE(client.works());
}

}  // namespace
}  // namespace segue::web
